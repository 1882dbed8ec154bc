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

class Explainer {
public:
    Explainer(std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
              const RunRecords& records)
        : prediction_(prediction),
          library_(library),
          graph_(graph),
          records_(records) {}

    void explain_all() {
        for (std::size_t index = 0; index < graph_.nodes.size(); ++index) {
            NodePrediction& predicted = prediction_[index];
            if (!predicted.will_run || predicted.cached) continue;
            if (std::string why = reason(index); !why.empty()) predicted.why = std::move(why);
        }
    }

private:
    std::string reason(std::size_t index) const {
        const RunNode& node = graph_.nodes[index];
        const std::string& scan = graph_.scan_names[node.scan];
        const std::vector<PastStep> past =
            records_.last_steps(workflow_name(*graph_.plans[node.plan]), scan, graph_.label(node));
        std::vector<std::string> least;
        for (const PastStep& step : past)
            if (std::vector<std::string> found = differences(index, step);
                &step == &past.front() || found.size() < least.size())
                least = std::move(found);
        if (past.empty()) return {};
        const std::int64_t run = past.front().run;
        if (least.empty() && std::ranges::any_of(past, [](const PastStep& step) { return !step.done; }))
            return fmt::format("it did not complete in run {}", run);
        if (least.empty())
            return fmt::format(
                "it is not in the cache: none of its parameters changed since run {}, but perhaps the order of its "
                "inputs, a file that a parameter names, or Scanmill itself; or the cache removed it",
                run);
        std::string text;
        for (const std::string& difference : least) text += (text.empty() ? "" : ", ") + difference;
        return text + fmt::format(" since run {}", run);
    }

    std::vector<std::string> differences(std::size_t index, const PastStep& past) const {
        const RunNode& node = graph_.nodes[index];
        std::vector<std::string> found;
        if (past.plan_key == node.key) return found;
        if (!node.step) return {"the file, its unit or its frame changed"};
        const PlannedStep& step = *graph_.step(node);
        if (past.filter != step.spec.name)
            found.push_back(fmt::format("the filter changed {} → {}", past.filter, step.spec.name));
        else if (past.filter_version != step.spec.version)
            found.push_back(
                fmt::format("{}'s version changed {} → {}", past.filter, past.filter_version, step.spec.version));
        else if (past.build != library_.build_id(step.spec.name))
            found.push_back(fmt::format("{} was built again", past.filter));
        for (const auto& [name, value] : step.parameters.values)
            if (const std::string now = text(value), before = value_in(past.authored, name); now != before)
                found.push_back(fmt::format("{} changed {} → {}", name, before.empty() ? "nothing" : before,
                                            now.empty() ? "nothing" : now));
        if (past.seed != graph_.seed) found.push_back(fmt::format("the seed changed {} → {}", past.seed, graph_.seed));
        for (const NodeInput& input : node.inputs)
            if (!prediction_[input.node].cached) {
                const RunNode& from = graph_.nodes[input.node];
                found.push_back(from.step ? fmt::format("the result of '{}' may change", graph_.label(from))
                                          : std::string("the scan changed"));
            }
        return found;
    }

    std::vector<NodePrediction>& prediction_;
    FilterLibrary& library_;
    const RunGraph& graph_;
    const RunRecords& records_;
};

}  // namespace

void explain(std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
             const RunRecords& records) {
    Explainer(prediction, library, graph, records).explain_all();
}

}  // namespace scanmill
