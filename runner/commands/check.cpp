// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/error_output.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/graph/streaming.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

std::string sources_text(const Plan& plan, const PlannedInput& input) {
    std::string text;
    for (const ValueSource& source : input.sources) text += (text.empty() ? "" : ", ") + describe(plan, source);
    return text;
}

/// Whether the step reads its scan piece by piece, if the file's format allows it.
bool streams(const Plan& plan, const PlannedInput& input) {
    return std::ranges::any_of(
        input.sources, [&](const ValueSource& source) { return !source.step && is_streamed(plan, source.input); });
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + "\"";
}

std::string source_node(const ValueSource& source) {
    return source.step ? fmt::format("step{}", *source.step) : fmt::format("input{}", source.input);
}

std::string plan_text(const Plan& plan) {
    std::string text = fmt::format("{}: {}, {}\n", plan.workflow.name.empty() ? plan.workflow.file : plan.workflow.name,
                                   count_text(plan.steps.size(), "step", "steps"),
                                   count_text(plan.variants.size(), "variant", "variants"));
    for (const WorkflowInput& input : plan.workflow.inputs)
        text += fmt::format("input {}: {}{}\n", input.name, name_of(input.kind), input.list ? " (a list)" : "");
    for (const PlannedVariant& variant : plan.variants) {
        text += fmt::format("variant {}\n", variant.name);
        for (const std::size_t index : variant.steps) {
            const PlannedStep& step = plan.steps[index];
            text += fmt::format("  {:>2}. {}{}\n", index + 1, step.label,
                                step.label == step.spec.name ? "" : " (" + step.spec.name + ")");
            for (const PlannedInput& input : step.inputs)
                text += fmt::format("        {} <- {}{}\n", input.port, sources_text(plan, input),
                                    streams(plan, input) ? ", as a stream" : "");
            for (const auto& [name, value] : step.parameters.values)
                if (const std::string shown = scanmill::text(value); !shown.empty())
                    text += fmt::format("        {}: {}\n", name, shown);
            for (const PlannedExpectation& expectation : step.expectations)
                text += fmt::format("        expect {}\n", expectation.text);
        }
        for (const PlannedOutput& output : variant.outputs)
            text += fmt::format("  {} <- {}\n", output.file, describe(plan, output.source));
    }
    return text;
}

std::string plan_dot(const Plan& plan) {
    std::string dot = "digraph " + quoted(plan.workflow.name) + " {\n  rankdir=LR;\n";
    for (std::size_t i = 0; i < plan.workflow.inputs.size(); ++i)
        dot += fmt::format("  input{} [shape=box, label={}];\n", i, quoted(plan.workflow.inputs[i].name));
    for (std::size_t i = 0; i < plan.steps.size(); ++i) {
        dot += fmt::format("  step{} [label={}];\n", i, quoted(plan.steps[i].label));
        for (const PlannedInput& input : plan.steps[i].inputs)
            for (const ValueSource& source : input.sources)
                dot += fmt::format("  {} -> step{} [label={}];\n", source_node(source), i,
                                   quoted(input.port + (streams(plan, input) ? " (stream)" : "")));
    }
    std::set<std::pair<std::string, std::string>> drawn;
    for (const PlannedVariant& variant : plan.variants)
        for (const PlannedOutput& output : variant.outputs) {
            const std::string from = source_node(output.source);
            if (!drawn.emplace(from, output.file).second) continue;
            dot += fmt::format("  {} [shape=note];\n  {} -> {};\n", quoted(output.file), from, quoted(output.file));
        }
    return dot + "}\n";
}

Json plan_json(const Plan& plan) {
    Json json{
        {"name", plan.workflow.name}, {"inputs", Json::array()}, {"steps", Json::array()}, {"variants", Json::array()}};
    for (const WorkflowInput& input : plan.workflow.inputs)
        json["inputs"].push_back({{"name", input.name}, {"kind", name_of(input.kind)}, {"list", input.list}});
    for (const PlannedStep& step : plan.steps) {
        Json entry{{"label", step.label},       {"filter", step.spec.name},   {"version", step.spec.version},
                   {"key", step.structure_key}, {"line", step.position.line}, {"column", step.position.column},
                   {"in", Json::object()},      {"streams", Json::array()},   {"parameters", Json::object()}};
        for (const PlannedInput& input : step.inputs) {
            for (const ValueSource& source : input.sources) entry["in"][input.port].push_back(describe(plan, source));
            if (streams(plan, input)) entry["streams"].push_back(input.port);
        }
        for (const auto& [name, value] : step.parameters.values)
            if (const std::string shown = text(value); !shown.empty()) entry["parameters"][name] = shown;
        for (const PlannedExpectation& expectation : step.expectations) entry["expect"].push_back(expectation.text);
        json["steps"].push_back(std::move(entry));
    }
    for (const PlannedVariant& variant : plan.variants) {
        Json entry{{"name", variant.name}, {"steps", variant.steps}, {"outputs", Json::object()}};
        for (const PlannedOutput& output : variant.outputs)
            entry["outputs"][output.file] = describe(plan, output.source);
        json["variants"].push_back(std::move(entry));
    }
    return json;
}

struct CheckOptions {
    std::vector<std::string> files, settings;
    bool plan = false, json = false;
    std::string format = "text";
};

/// Checks one file after the other and prints errors at once, or all results as JSON at the end.
class Checker {
public:
    explicit Checker(const CheckOptions& options)
        : options_(options),
          as_json_(options.json || options.format == "json"),
          library_(open_library()),
          settings_(parse_settings(options.settings)) {}

    int check() {
        for (const std::string& file : options_.files) {
            try {
                const std::string text = read_workflow_file(file);
                if (is_batch(text))
                    check_one_batch(file, text);
                else
                    check_one_workflow(file, text);
            } catch (const Error& error) {
                code_ = bad_request;
                if (as_json_)
                    entries_.push_back(unreadable_json(file, error));
                else
                    print(error, false);
            }
        }
        if (as_json_) print_files_json(std::move(entries_));
        return code_;
    }

private:
    void check_one_workflow(const std::string& file, const std::string& text) {
        const CheckedWorkflow checked = check_workflow(file, text, library_, settings_);
        const bool sound = report(checked.diagnostics);
        if (!sound) return;
        if (options_.plan)
            show(checked.plan);
        else
            print_line("{}: ok, {}, {}\n", file, count_text(checked.plan.steps.size(), "step", "steps"),
                       count_text(checked.plan.variants.size(), "variant", "variants"));
    }

    void check_one_batch(const std::string& file, const std::string& text) {
        if (!settings_.empty())
            throw Error("--set does not apply to the batch '{}'; write the values under its `set:`", file);
        const CheckedBatch checked = check_batch(text, file, library_);
        for (const Diagnostics& diagnostics : checked.diagnostics) report(diagnostics);
        if (checked.has_errors()) return;
        if (options_.plan)
            for (const BatchPart& part : checked.parts) show(*part.plan);
        else
            print_line("{}: ok, {}, {}, {}, {}\n", file, count_text(checked.batch.scans.size(), "scan", "scans"),
                       count_text(checked.batch.workflows.size(), "workflow", "workflows"),
                       count_text(checked.variants(), "variant", "variants"),
                       count_text(checked.cells(), "cell", "cells"));
    }

    /// Whether there are no errors.
    bool report(const Diagnostics& diagnostics) {
        if (diagnostics.has_errors()) code_ = bad_request;
        if (as_json_)
            entries_.push_back(to_json(diagnostics));
        else
            print(diagnostics);
        return !diagnostics.has_errors();
    }

    /// As JSON, adds the plan to the entry of its workflow's file.
    void show(const Plan& plan) {
        if (!as_json_) {
            fmt::print("{}", options_.format == "dot" ? plan_dot(plan) : plan_text(plan));
            return;
        }
        for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry)
            if ((*entry)["file"] == plan.workflow.file) {
                Json json = plan_json(plan);
                if (entry->contains("plan"))
                    (*entry)["further-plans"].push_back(std::move(json));
                else
                    (*entry)["plan"] = std::move(json);
                return;
            }
    }

    template <class... Arguments>
    void print_line(fmt::format_string<Arguments...> line, Arguments&&... arguments) {
        if (!as_json_) fmt::print(line, std::forward<Arguments>(arguments)...);
    }

    const CheckOptions& options_;
    bool as_json_;
    FilterLibrary library_;
    Settings settings_;
    Json entries_ = Json::array();
    int code_ = done;
};

int check(const CheckOptions& options) { return Checker(options).check(); }

}  // namespace

void add_check(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<CheckOptions>(
        app, chosen, "check", "Checks workflow and batch files without opening any scan", check);
    command.add_option("FILE", options.files, "Workflow or batch files")->required();
    command.add_option("--set", options.settings, "A workflow parameter's value, NAME=VALUE")->take_all();
    CLI::Option* plan = command.add_flag("--plan", options.plan, "Print the steps of every variant and their inputs");
    command.add_option("--format", options.format, "Of the plan: text, dot (for Graphviz) or json")
        ->needs(plan)
        ->check(CLI::IsMember({"text", "dot", "json"}));
    command.add_flag("--json", options.json, "Print the result as JSON");
}

}  // namespace scanmill::runner
