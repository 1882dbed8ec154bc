// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a run says on stderr while it runs: on a terminal a line per worker and one for the whole, written over and
/// over, elsewhere a plain line per finished step. Warnings and failures are always said.

#include <chrono>
#include <functional>
#include <mutex>

#include "output/progress_board.hpp"
#include "scanmill/run/run.hpp"

namespace scanmill::runner {

class Progress : public RunObserver {
public:
    Progress(const RunGraph& graph, const std::vector<NodePrediction>& prediction, std::size_t workers, bool quiet);

    void node_started(const RunNode& node, std::size_t worker) override;
    void node_progress(const RunNode& node, double fraction) override;
    void node_warning(const RunNode& node, std::string_view text) override;
    void node_ended(const RunNode& node, const NodeReport& report) override;
    void output_started(const RunCell& cell, const RunOutput& output, std::size_t worker) override;
    void output_written(const RunCell& cell, const OutputReport& report) override;
    void cell_ended(const RunCell& cell, const CellReport& report) override;
    void time_passed() override;
    /// Something else that is said on stderr meanwhile.
    void say_beside(const std::function<void()>& say);
    /// Leaves the terminal's lines empty.
    void finish();

private:
    std::string label(const RunNode& node) const;
    bool has_board() const { return terminal_ && !quiet_; }
    void say(const std::string& line);
    void paint();
    void wipe();

    const RunGraph& graph_;
    ProgressBoard board_;
    bool quiet_;
    bool terminal_;
    std::size_t ended_ = 0;
    std::size_t painted_ = 0;  // lines on the terminal
    std::chrono::steady_clock::time_point begin_, last_;
    std::mutex mutex_;
};

}  // namespace scanmill::runner
