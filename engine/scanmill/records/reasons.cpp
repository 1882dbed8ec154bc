// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/reasons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace scanmill {

namespace {

using Texts = std::vector<std::pair<std::string, std::string>>;

std::string_view value_in(const Texts& texts, const std::string& name) {
    const auto found = std::ranges::find(texts, name, &Texts::value_type::first);
    return found == texts.end() ? std::string_view() : found->second;
}

/// A step of the graph with its parameters as texts.
struct Step {
    const RunNode& node;
    Texts parameters;
};

/// The number of parameters and of other facts in which the node differs from a step of an earlier run, without those
/// that are equal for all steps of the run.
std::size_t distance(const Step& step, const RunGraph& graph, FilterLibrary& library, const PastStep& past) {
    if (past.plan_key == step.node.key) return 0;
    const FilterSpec& spec = graph.step(step.node)->spec;
    std::size_t count = 1 + (past.filter != spec.name || past.filter_version != spec.version ||
                             past.build != library.build_id(spec.name));
    for (const auto& [name, text] : step.parameters) count += value_in(past.authored, name) != text;
    return count;
}

/// The differences between the node and a step of an earlier run; empty if the plan keys are equal.
std::vector<std::string> differences(const std::vector<NodePrediction>& prediction, FilterLibrary& library,
                                     const RunGraph& graph, const Step& now, const PastStep& past) {
    const RunNode& node = now.node;
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
    for (const auto& [name, text] : now.parameters)
        if (const std::string_view before = value_in(past.authored, name); text != before)
            found.push_back(fmt::format("{} changed {} → {}", name, before.empty() ? "(not set)" : before,
                                        text.empty() ? "(not set)" : text));
    if (past.seed != graph.seed) found.push_back(fmt::format("the seed changed {} → {}", past.seed, graph.seed));
    for (const NodeInput& input : node.inputs)
        if (!prediction[input.node].cached) {
            const RunNode& from = graph.nodes[input.node];
            found.push_back(from.step ? fmt::format("the result of '{}' may change", graph.label(from))
                                      : std::string("the scan changed"));
        }
    return found;
}

/// The steps of earlier runs by workflow, scan and label, read once.
class PastSteps {
public:
    explicit PastSteps(const RunRecords& records) : records_(records) {}

    const std::vector<PastStep>& of(const RunGraph& graph, const RunNode& node) {
        std::tuple names(workflow_name(*graph.plans[node.plan]), graph.scan_names[node.scan], graph.label(node));
        const auto [found, is_new] = steps_.try_emplace(names);
        if (is_new)
            found->second = records_.last_steps(std::get<0>(names), std::get<1>(names), std::get<2>(names));
        return found->second;
    }

private:
    const RunRecords& records_;
    std::map<std::tuple<std::string, std::string, std::string>, std::vector<PastStep>> steps_;
};

/// Why the node runs again; empty if it never ran in an earlier run.
std::string reason(const std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
                   const std::vector<PastStep>& past, const RunNode& node) {
    if (past.empty()) return {};
    Step now{node, {}};
    if (const PlannedStep* step = graph.step(node))
        for (const auto& [name, value] : step->parameters.values) now.parameters.emplace_back(name, text(value));
    const PastStep* nearest = &past.front();
    if (node.step && past.size() > 1)
        nearest = &*std::ranges::min_element(
            past, {}, [&](const PastStep& step) { return distance(now, graph, library, step); });
    const std::vector<std::string> least = differences(prediction, library, graph, now, *nearest);
    const std::int64_t run = past.front().run;
    if (least.empty() && std::ranges::any_of(past, [](const PastStep& step) { return !step.done; }))
        return fmt::format("it did not complete in run {}", run);
    if (least.empty())
        return fmt::format(
            "its result is not in the cache, but no parameter changed since run {}; the order of its inputs, a file "
            "that a parameter names, or Scanmill may have changed, or the result was removed from the cache",
            run);
    std::string text;
    for (const std::string& difference : least) text += (text.empty() ? "" : ", ") + difference;
    return text + fmt::format(" since run {}", run);
}

}  // namespace

void explain(std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
             const RunRecords& records) {
    PastSteps past(records);
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        NodePrediction& predicted = prediction[index];
        if (!predicted.will_run || predicted.cached) continue;
        const RunNode& node = graph.nodes[index];
        if (std::string why = reason(prediction, library, graph, past.of(graph, node), node); !why.empty())
            predicted.why = std::move(why);
    }
}

}  // namespace scanmill
