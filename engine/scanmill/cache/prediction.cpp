// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/prediction.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

namespace {

/// The node's cached result, if it has this step's ports and parameters.
std::optional<StepResult> cached_result(const Cache& cache, const std::string& plan_key, const PlannedStep* step) {
    const std::optional<std::string> run_key = cache.run_key(plan_key);
    std::optional<StepResult> result = run_key ? cache.step(*run_key) : std::nullopt;
    if (!result) return result;
    const auto has_output = [&](const PortSpec& port) { return result->output(port.name) != nullptr; };
    const auto is_declared = [&](const auto& parameter) { return step->spec.parameter(parameter.first) != nullptr; };
    const bool is_sound = step ? std::ranges::all_of(step->spec.outputs, has_output) &&
                                     std::ranges::all_of(result->resolved.values, is_declared)
                               : result->output("") != nullptr;
    return is_sound ? result : std::nullopt;
}

/// Explains why a value is not in the cache. The cache does not record the policies of earlier runs, so the text leaves
/// open what cannot be known.
std::string why_missing(const StepResult& result, const std::string& port, KeepRule::Policy policy) {
    const std::string what = port.empty() ? "content" : "'" + port + "'";
    if (policy == KeepRule::Policy::never)
        return fmt::format("its {} is not in the cache, and the policy 'never' stores no values", what);
    const ResultOutput* output = result.output(port);
    if (output && KeepRule().is_worth(result.seconds, output->bytes))
        return fmt::format("its {} is not in the cache: an earlier run did not store it, or it was removed later",
                           what);
    return fmt::format("its {} was not stored, because it is quick to compute again", what);
}

}  // namespace

std::vector<NodePrediction> predict(const RunGraph& graph, const Cache* cache, KeepRule::Policy policy) {
    std::vector<NodePrediction> predictions(graph.nodes.size());
    for (const RunCell& cell : graph.cells)
        for (const RunOutput& output : cell.outputs) predictions[output.node].needed.insert(output.port);
    // A node comes after its inputs. In reverse order, all steps that need a node's values come before it.
    for (std::size_t index = predictions.size(); index-- > 0;) {
        const RunNode& node = graph.nodes[index];
        NodePrediction& predicted = predictions[index];
        const PlannedStep* step = graph.step(node);
        if (step && !step->expectations.empty()) predicted.needed.insert(step->spec.outputs.front().name);
        if (cache && !node.is_uncacheable) predicted.cached = cached_result(*cache, node.key, step);
        const auto is_missing = [&](const std::string& port) {
            const ResultOutput* output = predicted.cached->output(port);
            return !output || !cache->has_value(output->content, output->bytes);
        };
        if (!cache)
            predicted.why = "there is no cache";
        else if (node.is_uncacheable)
            predicted.why = "it reads a folder or a file that cannot be hashed";
        else if (!predicted.cached)
            predicted.why = step ? "it has not run with these inputs and parameters" : "it was not read before";
        else if (const auto missing = std::ranges::find_if(predicted.needed, is_missing);
                 missing != predicted.needed.end())
            predicted.why = why_missing(*predicted.cached, *missing, policy);
        predicted.will_run = !predicted.why.empty();
        if (!predicted.will_run) continue;
        for (const NodeInput& input : node.inputs) predictions[input.node].needed.insert(input.from);
    }
    return predictions;
}

}  // namespace scanmill
