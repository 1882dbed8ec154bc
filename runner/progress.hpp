// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a run says on stderr while it runs: on a terminal one line that is written over and over, elsewhere a plain
/// line per finished step. Warnings and failures are always said.

#include <mutex>

#include "scanmill/engine/run.hpp"

namespace scanmill::runner {

class Progress : public RunObserver {
public:
    Progress(const Plan& plan, const RunGraph& graph, bool quiet);

    void node_started(const RunNode& node) override;
    void node_progress(const RunNode& node, double fraction) override;
    void node_warning(const RunNode& node, std::string_view text) override;
    void node_ended(const RunNode& node, const NodeReport& report) override;
    void output_written(const RunCell& cell, const OutputReport& report) override;
    void cell_ended(const RunCell& cell, const CellReport& report) override;
    /// Leaves the terminal's line empty.
    void finish();

private:
    std::string label(const RunNode& node) const;
    void say(const std::string& line);
    void overwrite(const std::string& line);

    const Plan& plan_;
    const RunGraph& graph_;
    bool quiet_;
    bool terminal_;
    std::size_t ended_ = 0;
    int percent_ = -1;
    std::mutex mutex_;
};

}  // namespace scanmill::runner
