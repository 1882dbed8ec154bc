// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/reasons.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

namespace {

using Texts = std::vector<std::pair<std::string, std::string>>;

std::string value_in(const Texts& texts, const std::string& name) {
    const auto found = std::ranges::find(texts, name, &Texts::value_type::first);
    return found == texts.end() ? "" : found->second;
}

/// The differences between the node and a step of an earlier run; empty if the plan keys are equal.
std::vector<std::string> differences(const std::vector<NodePrediction>& prediction, FilterLibrary& library,
                                     const RunGraph& graph, std::size_t index, const PastStep& past) {
    const RunNode& node = graph.nodes[index];
    std::vector<std::string> found;
    if (past.plan_key == node.key) return found;
    if (!node.step) return {"the file, its unit or its frame changed"};
    const PlannedStep& step = *graph.step(node);
    if (past.filter != step.spec.name)
        found.push_back(fmt::format("the filter changed {} → {}", past.filter, step.spec.name));
    else if (past.filter_version != step.spec.version)
        found.push_back(
            fmt::format("{}'s version changed {} → {}", past.filter, past.filter_version, step.spec.version));
    else if (past.build != library.build_id(step.spec.name))
        found.push_back(fmt::format("{} was built again", past.filter));
    for (const auto& [name, value] : step.parameters.values)
        if (const std::string now = text(value), before = value_in(past.authored, name); now != before)
            found.push_back(fmt::format("{} changed {} → {}", name, before.empty() ? "(not set)" : before,
                                        now.empty() ? "(not set)" : now));
    if (past.seed != graph.seed) found.push_back(fmt::format("the seed changed {} → {}", past.seed, graph.seed));
    for (const NodeInput& input : node.inputs)
        if (!prediction[input.node].cached) {
            const RunNode& from = graph.nodes[input.node];
            found.push_back(from.step ? fmt::format("the result of '{}' may change", graph.label(from))
                                      : std::string("the scan changed"));
        }
    return found;
}

/// Why the node runs again; empty if it never ran in an earlier run.
std::string reason(const std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
                   const RunRecords& records, std::size_t index) {
    const RunNode& node = graph.nodes[index];
    const std::string& scan = graph.scan_names[node.scan];
    const std::vector<PastStep> past =
        records.last_steps(workflow_name(*graph.plans[node.plan]), scan, graph.label(node));
    std::vector<std::string> least;
    for (const PastStep& step : past)
        if (std::vector<std::string> found = differences(prediction, library, graph, index, step);
            &step == &past.front() || found.size() < least.size())
            least = std::move(found);
    if (past.empty()) return {};
    const std::int64_t run = past.front().run;
    if (least.empty() && std::ranges::any_of(past, [](const PastStep& step) { return !step.done; }))
        return fmt::format("it did not complete in run {}", run);
    if (least.empty())
        return fmt::format(
            "its result is not in the cache, but no parameter changed since run {}; the order of its inputs, a file "
            "that "
            "a parameter names, or Scanmill may have changed, or the result was removed from the cache",
            run);
    std::string text;
    for (const std::string& difference : least) text += (text.empty() ? "" : ", ") + difference;
    return text + fmt::format(" since run {}", run);
}

}  // namespace

void explain(std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
             const RunRecords& records) {
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        NodePrediction& predicted = prediction[index];
        if (!predicted.will_run || predicted.cached) continue;
        if (std::string why = reason(prediction, library, graph, records, index); !why.empty())
            predicted.why = std::move(why);
    }
}

}  // namespace scanmill
