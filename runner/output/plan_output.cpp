// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/plan_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scanmill/base/text.hpp"
#include "scanmill/graph/graph.hpp"

namespace scanmill::runner {

namespace {

std::string sources_text(const Plan& plan, const PlannedInput& input) {
    std::string text;
    for (const ValueSource& source : input.sources) text += (text.empty() ? "" : ", ") + describe(plan, source);
    return text;
}

/// Whether the step gets its scan piece by piece, as far as the file allows it.
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

}  // namespace

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
    std::map<std::pair<std::string, std::string>, bool> drawn;
    for (const PlannedVariant& variant : plan.variants)
        for (const PlannedOutput& output : variant.outputs) {
            const std::string from = source_node(output.source);
            if (!drawn.emplace(std::pair(from, output.file), true).second) continue;
            dot += fmt::format("  {} [shape=note];\n  {} -> {};\n", quoted(output.file), from, quoted(output.file));
        }
    return dot + "}\n";
}

std::string plan_json(const Plan& plan) {
    using Json = nlohmann::ordered_json;
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
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace scanmill::runner
