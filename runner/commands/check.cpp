// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/error_output.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/batch/objects.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/workflow/ready.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

std::string sources_text(const Plan& plan, const PlannedInput& input) {
    std::string text;
    for (const ValueSource& source : input.sources) text += (text.empty() ? "" : ", ") + describe(plan, source);
    return text;
}

/// Whether the step reads this input in chunks, provided that the file's format allows it.
bool streams(const Plan& plan, const PlannedInput& input) {
    return std::ranges::any_of(
        input.sources, [&](const ValueSource& source) { return !source.step && is_streamed(plan, source.input); });
}

std::string quoted(const std::string& text) { return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string source_node(const ValueSource& source) {
    return source.step ? fmt::format("step{}", *source.step) : fmt::format("input{}", source.input);
}

/// The kinds that the input accepts: "points", "mesh or points".
std::string kinds_text(const WorkflowInput& input) {
    std::string text(name_of(input.kind));
    for (const Kind kind : input.also) text += " or " + std::string(name_of(kind));
    return text;
}

std::string plan_text(const Plan& plan) {
    std::string text = fmt::format("{}: {}, {}\n", plan.workflow.name.empty() ? plan.workflow.file : plan.workflow.name,
                                   count_text(plan.steps.size(), "step", "steps"),
                                   count_text(plan.variants.size(), "variant", "variants"));
    for (const WorkflowInput& input : plan.workflow.inputs)
        text += fmt::format("input {}: {}{}\n", input.name, kinds_text(input), input.list ? " (a list)" : "");
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
        json["inputs"].push_back({{"name", input.name}, {"kind", kinds_text(input)}, {"list", input.list}});
    for (const PlannedStep& step : plan.steps) {
        Json entry{{"label", step.label},       {"filter", step.spec.name},   {"version", step.spec.version},
                   {"key", step.structure_key}, {"line", step.position.line}, {"column", step.position.column},
                   {"in", Json::object()},      {"streams", Json::array()},   {"parameters", Json::object()}};
        for (const PlannedInput& input : step.inputs) {
            for (const ValueSource& source : input.sources) entry["in"][input.port].push_back(describe(plan, source));
            if (streams(plan, input)) entry["streams"].push_back(input.port);
        }
        if (!step.file.empty()) entry["file"] = step.file;  // the file of `line` and `column`
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

/// A checked file. Plans may be printed only if there are no errors.
struct CheckedFile {
    std::vector<Diagnostics> diagnostics;
    std::vector<std::shared_ptr<const Plan>> plans;
    std::string summary;
    std::string objects{};  ///< of a batch: a line for each object, its views and their poses
};

/// "3 scans", "12 objects of 72 view files", or both.
std::string scans_text(const std::vector<BatchScan>& scans) {
    std::size_t objects = 0, views = 0;
    for (const BatchScan& scan : scans) {
        objects += scan.is_object();
        views += scan.views.size();
    }
    const std::string single = count_text(scans.size() - objects, "scan", "scans");
    if (objects == 0) return single;
    const std::string folders =
        fmt::format("{} of {}", count_text(objects, "object", "objects"), count_text(views, "view file", "view files"));
    return objects == scans.size() ? folders : single + ", " + folders;
}

/// A line for each object, its views, and the poses that the plans of `checked` use.
std::string objects_text(const CheckedBatch& checked) {
    std::map<std::size_t, std::string> poses;
    for (const BatchPart& part : checked.parts)
        for (const std::size_t scan : part.scans)
            if (takes_poses(part.plan->workflow)) poses[scan] = checked.batch.scans[scan].poses_file.string();
    std::string text;
    for (std::size_t scan = 0; scan < checked.batch.scans.size(); ++scan) {
        const BatchScan& object = checked.batch.scans[scan];
        if (!object.is_object()) continue;
        text += fmt::format("object {}: {} in {}", object.name(),
                            count_text(object.views.size(), "view file", "view files"), object.file.string());
        if (const std::string& file = poses[scan]; !file.empty()) text += fmt::format(", poses in {}", file);
        text += "\n";
    }
    return text;
}

CheckedFile check_file(const std::string& file_or_name, const FilterLibrary& library, const Settings& settings,
                       const Warn& warn) {
    const std::string file = workflow_file(file_or_name, warn);
    const std::string text = read_workflow_file(file);
    if (!is_batch(text)) {
        CheckedWorkflow checked = check_workflow(file, text, library, settings);
        std::string summary = fmt::format("{}, {}", count_text(checked.plan.steps.size(), "step", "steps"),
                                          count_text(checked.plan.variants.size(), "variant", "variants"));
        return {{std::move(checked.diagnostics)}, {std::make_shared<const Plan>(std::move(checked.plan))}, summary};
    }
    if (!settings.empty())
        throw Error("--set does not apply to the batch '{}'; write the values under its `set:`", file);
    const CheckedBatch checked = check_batch(text, file, library);
    CheckedFile result{checked.diagnostics,
                       {},
                       fmt::format("{}, {}, {}, {}", scans_text(checked.batch.scans),
                                   count_text(checked.batch.workflows.size(), "workflow", "workflows"),
                                   count_text(checked.variants(), "variant", "variants"),
                                   count_text(checked.cells(), "cell", "cells")),
                       objects_text(checked)};
    std::set<std::string> shapes;  // objects with poses of their own have one plan
    for (const BatchPart& part : checked.parts)
        if (part.shape.empty() || shapes.insert(part.shape).second) result.plans.push_back(part.plan);
    return result;
}

/// Adds the plan to the last entry with its workflow's file.
void add_plan(Json& entries, const Plan& plan) {
    const auto entry = std::find_if(entries.rbegin(), entries.rend(),
                                    [&](const Json& each) { return each["file"] == plan.workflow.file; });
    if (entry->contains("plan"))
        (*entry)["further-plans"].push_back(plan_json(plan));
    else
        (*entry)["plan"] = plan_json(plan);
}

/// Prints the errors and plans of each file immediately. With --json, prints all results at the end.
int check(const CheckOptions& options) {
    const FilterLibrary library = open_library();
    const Settings settings = parse_settings(options.settings);
    const Warn warn = warning_printer();
    Json entries = Json::array();
    int code = done;
    for (const std::string& file : options.files) try {
            const CheckedFile checked = check_file(file, library, settings, warn);
            for (const Diagnostics& diagnostics : checked.diagnostics)
                if (options.json)
                    entries.push_back(to_json(diagnostics));
                else
                    print(diagnostics);
            if (std::ranges::any_of(checked.diagnostics, &Diagnostics::has_errors)) {
                code = bad_request;
                continue;
            }
            if (!options.plan && !options.json) fmt::print("{}: ok, {}\n", file, checked.summary);
            if (options.plan && !options.json && options.format == "text") fmt::print("{}", checked.objects);
            for (std::size_t i = 0; options.plan && i < checked.plans.size(); ++i) {
                const Plan& plan = *checked.plans[i];
                if (options.json)
                    add_plan(entries, plan);
                else
                    fmt::print("{}", options.format == "dot" ? plan_dot(plan) : plan_text(plan));
            }
        } catch (const Error& error) {
            code = bad_request;
            if (options.json)
                entries.push_back(unreadable_json(file, error));
            else
                print(error, false);
        }
    if (options.json) print_files_json(std::move(entries));
    return code;
}

}  // namespace

void add_check(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<CheckOptions>(
        app, chosen, "check", "Checks workflow and batch files without opening any scan", check);
    command.add_option("FILE", options.files, "Workflow or batch files, or names of ready ones")->required();
    command.add_option("--set", options.settings, "A workflow parameter's value, NAME=VALUE")->take_all();
    CLI::Option* plan = command.add_flag("--plan", options.plan, "Print the steps of every variant and their inputs");
    CLI::Option* format = command.add_option("--format", options.format, "Plan format: text or dot (for Graphviz)")
                              ->needs(plan)
                              ->check(CLI::IsMember({"text", "dot"}));
    command.add_flag("--json", options.json, "Print the result as JSON")->excludes(format);
}

}  // namespace scanmill::runner
