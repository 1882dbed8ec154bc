// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/formats/files.hpp"
#include "scanmill/graph/graph.hpp"

namespace scanmill {

namespace {

/// Counts the steps and outputs that read one scan.
struct Readers {
    std::size_t all = 0, streaming = 0;

    void add(bool streams) {
        ++all;
        streaming += streams;
    }
    bool all_stream() const { return all > 0 && streaming == all; }
};

}  // namespace

bool can_stream(const PlannedStep& step, std::size_t inputs) {
    if (!step.spec.streams || inputs != 1) return false;
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
            if (std::ranges::find(port.sources, scan) != port.sources.end())
                readers.add(can_stream(step, step.inputs.size()));
    for (const PlannedVariant& variant : plan.variants)
        for (const PlannedOutput& output : variant.outputs)
            if (output.source == scan) readers.add(false);
    return plan.workflow.inputs[input].kind == kind_of<PointCloud>() && readers.all_stream();
}

void mark_streams(RunGraph& graph) {
    std::vector<Readers> readers(graph.nodes.size());
    for (const RunNode& node : graph.nodes)
        for (const NodeInput& input : node.inputs)
            readers[input.node].add(can_stream(*graph.step(node), node.inputs.size()));
    for (const RunCell& cell : graph.cells)
        for (const RunOutput& output : cell.outputs) readers[output.node].add(false);
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        RunNode& node = graph.nodes[index];
        node.leaf.is_streamed = !node.step && readers[index].all_stream() && node.leaf.kind == kind_of<PointCloud>() &&
                                !node.leaf.pose && node.unreadable.empty() && may_be_point_stream(node.leaf.name());
    }
}

}  // namespace scanmill
