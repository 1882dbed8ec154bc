// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a run prints on stdout: the prediction with --dry-run, events during the run, and the report as JSON after it.

#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "output/step_names.hpp"
#include "scanmill/cache/prediction.hpp"
#include "scanmill/compare/documents.hpp"
#include "scanmill/report/documents.hpp"
#include "scanmill/run/run.hpp"

namespace scanmill::runner {

std::string graph_text(const RunGraph& graph, const std::vector<NodePrediction>& predictions);
Json graph_json(const RunGraph& graph, const std::vector<NodePrediction>& predictions);

Json report_json(const RunGraph& graph, const RunReport& report);

/// Prints events as JSON on stdout during the run, one object per line.
///
/// The first event is `run-started`, the last is `run-ended`. Between them come `step-started`, `step-progress` (whole
/// percents), `warning`, `step-ended`, `output-written` and `cell-ended`. `pass-started` is printed when costs are
/// measured again. If there is a gate or an accepted run, `verdict` comes before the last event. Each event has its
/// time in seconds since the start.
class EventStream : public RunObserver {
public:
    explicit EventStream(const RunGraph& graph)
        : graph_(graph),
          names_(graph),
          has_several_variants_(has_several_variants(graph)) {}

    /// `run`: number of the run in the records; 0 if it is not recorded.
    void begin(const std::string& name, unsigned jobs, unsigned threads, std::int64_t run);
    void judged(const VerdictEvent& verdict);
    void end(const RunReport& report);
    /// Whether some events could not be written.
    bool has_failed() const { return has_failed_; }

    void node_started(const RunNode& node, std::size_t worker) override;
    void node_progress(const RunNode& node, double fraction) override;
    void node_warning(const RunNode& node, std::string_view text) override;
    void node_ended(const RunNode& node, const NodeReport& report) override;
    void output_written(const RunCell& cell, const OutputReport& report) override;
    void cell_ended(const RunCell& cell, const CellReport& report) override;
    void pass_started(unsigned pass, unsigned passes) override;

private:
    /// The variants that use the node; empty if all cells have one variant.
    std::vector<std::string> variants_of(const RunNode& node) const;
    StepName name_of_step(const RunNode& node) const;
    void print(const char* name, const Json& members);

    const RunGraph& graph_;
    StepNames names_;
    bool has_several_variants_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    std::map<std::size_t, int> percents_;  // by node
    bool has_failed_ = false;
    std::mutex mutex_;
};

}  // namespace scanmill::runner
