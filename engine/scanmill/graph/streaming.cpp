// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/streaming.hpp"

#include <algorithm>

#include "scanmill/formats/files.hpp"

namespace scanmill {

namespace {

bool is_in_spacings(const ParameterScalar& value) {
    const Length* length = std::get_if<Length>(&value);
    return length && length->in() == Length::In::spacing;
}

bool is_in_spacings(const ParameterValue& value) {
    if (const auto* items = std::get_if<std::vector<ParameterScalar>>(&value))
        return std::ranges::any_of(*items, [](const ParameterScalar& item) { return is_in_spacings(item); });
    const auto* one = std::get_if<ParameterScalar>(&value);
    return one && is_in_spacings(*one);
}

bool has_value(const ParameterValue* value) {
    if (!value || std::holds_alternative<std::monostate>(*value)) return false;
    const auto* one = std::get_if<ParameterScalar>(value);
    return !one || !std::holds_alternative<Word>(*one);
}

/// What reads a scan, as far as it was looked at.
struct Readers {
    bool is_read = false, all_stream = true;

    void add(bool streams) {
        is_read = true;
        all_stream = all_stream && streams;
    }
    bool are_streamed() const { return is_read && all_stream; }
};

}  // namespace

bool can_stream(const PlannedStep& step) {
    if (!step.spec.streams) return false;
    const auto is_given = [&](const std::string& name) { return has_value(step.parameters.find(name)); };
    const auto needs_spacing = [](const auto& parameter) { return is_in_spacings(parameter.second); };
    return std::ranges::all_of(step.spec.streams->given, is_given) &&
           std::ranges::none_of(step.parameters.values, needs_spacing);
}

bool is_streamed(const Plan& plan, std::size_t input) {
    const ValueSource scan{std::nullopt, input, ""};
    Readers readers;
    for (const PlannedStep& step : plan.steps)
        for (const PlannedInput& port : step.inputs)
            if (std::ranges::find(port.sources, scan) != port.sources.end()) readers.add(can_stream(step));
    for (const PlannedVariant& variant : plan.variants)
        for (const PlannedOutput& output : variant.outputs)
            if (output.source == scan) readers.add(false);
    return plan.workflow.inputs[input].kind == kind_of<PointCloud>() && readers.are_streamed();
}

void mark_streams(RunGraph& graph) {
    std::vector<Readers> readers(graph.nodes.size());
    for (const RunNode& node : graph.nodes)
        for (const NodeInput& input : node.inputs) readers[input.node].add(can_stream(*graph.step(node)));
    for (const RunCell& cell : graph.cells)
        for (const RunOutput& output : cell.outputs) readers[output.node].add(false);
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        RunNode& node = graph.nodes[index];
        node.leaf.is_streamed = !node.step && readers[index].are_streamed() &&
                                node.leaf.kind == kind_of<PointCloud>() && !node.leaf.pose && node.unreadable.empty() &&
                                may_be_point_stream(node.leaf.file);
    }
}

}  // namespace scanmill
