// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/prediction.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

namespace {

std::optional<StepResult> remembered(const Cache& cache, const std::string& plan_key) {
    const std::optional<std::string> run_key = cache.run_key(plan_key);
    return run_key ? cache.step(*run_key) : std::nullopt;
}

class Seer {
public:
    Seer(const RunGraph& graph, const Cache* cache, KeepRule::Policy policy)
        : graph_(graph),
          cache_(cache),
          policy_(policy),
          nodes_(graph.nodes.size()) {}

    std::vector<NodePrediction> see() {
        for (const RunCell& cell : graph_.cells)
            for (const RunOutput& output : cell.outputs) nodes_[output.node].needed.insert(output.port);
        // A node's inputs stand before it: from the end, everybody who needs its values has spoken.
        for (std::size_t index = nodes_.size(); index-- > 0;) look_at(index);
        return std::move(nodes_);
    }

private:
    void look_at(std::size_t index) {
        const RunNode& node = graph_.nodes[index];
        NodePrediction& seen = nodes_[index];
        const PlannedStep* step = graph_.step(node);
        if (step && !step->expectations.empty()) seen.needed.insert(step->spec.outputs.front().name);
        if (cache_ && !node.is_uncacheable) seen.known = remembered(*cache_, node.key);
        if (seen.known && !is_sound(*seen.known, step)) seen.known.reset();
        if (!cache_)
            seen.why = "there is no cache";
        else if (node.is_uncacheable)
            seen.why = "it reads what has no content to be known by";
        else if (!seen.known)
            seen.why = step ? "it has not run on such inputs with such parameters" : "it was not read before";
        else if (const auto missing = std::ranges::find_if(
                     seen.needed, [&](const std::string& port) { return !is_kept(*seen.known, port); });
                 missing != seen.needed.end())
            seen.why = why_missing(*seen.known, *missing);
        seen.will_run = !seen.why.empty();
        if (!seen.will_run) return;
        for (const NodeInput& input : node.inputs) nodes_[input.node].needed.insert(input.from);
    }

    /// Whether the result speaks of this step's ports and parameters.
    static bool is_sound(const StepResult& result, const PlannedStep* step) {
        if (!step) return result.output("") != nullptr;
        const auto is_there = [&](const PortSpec& port) { return result.output(port.name) != nullptr; };
        const auto is_known = [&](const auto& parameter) { return step->spec.parameter(parameter.first) != nullptr; };
        return std::ranges::all_of(step->spec.outputs, is_there) && std::ranges::all_of(result.resolved, is_known);
    }

    bool is_kept(const StepResult& result, const std::string& port) const {
        const ResultOutput* output = result.output(port);
        return output && cache_->has_value(output->content, output->bytes);
    }

    /// Nobody noted what the run that made the value was to keep, nor how fast its disk was: only what cannot be
    /// otherwise is said.
    std::string why_missing(const StepResult& result, const std::string& port) const {
        const std::string what = port.empty() ? "content" : "'" + port + "'";
        if (policy_ == KeepRule::Policy::never)
            return fmt::format("its {} is not in the cache, and with --keep never none is kept", what);
        const ResultOutput* output = result.output(port);
        if (output && KeepRule().is_worth(result.seconds, output->bytes))
            return fmt::format(
                "its {} is not in the cache: the run that made it did not keep it, or it was removed since", what);
        return fmt::format("its {} was not kept, being quick to make again", what);
    }

    const RunGraph& graph_;
    const Cache* cache_;
    KeepRule::Policy policy_;
    std::vector<NodePrediction> nodes_;
};

}  // namespace

std::vector<NodePrediction> predict(const RunGraph& graph, const Cache* cache, KeepRule::Policy policy) {
    return Seer(graph, cache, policy).see();
}

}  // namespace scanmill
