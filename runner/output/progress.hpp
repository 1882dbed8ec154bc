// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Progress of a run on stderr. On a terminal there is one line per worker and one for the whole run; they are
/// overwritten. Elsewhere there is one plain line per finished step. Warnings and failures are always printed.

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "output/step_names.hpp"
#include "output/time_left.hpp"
#include "scanmill/run/run.hpp"

namespace scanmill::runner {

/// The lines on the terminal: one per worker, then one for the whole run with an estimate of the time left.
class ProgressBoard {
public:
    /// `steps`: number of all steps, including those taken from the cache.
    ProgressBoard(std::size_t workers, std::size_t steps) : workers_(workers), steps_(steps) {}

    /// A worker starts some work. `id` identifies the work in later calls. Times are seconds since the run began.
    void started(std::size_t worker, const void* id, std::string what, double at) {
        ended(id);  // another worker may have tried it before
        workers_[worker] = {id, std::move(what), at, 0};
    }
    void progressed(const void* id, double fraction);
    void ended(const void* id);
    /// Called once per step.
    void step_ended() { ++ended_; }
    void cell_failed() { ++failed_; }

    /// Returns the progress in at most `width` columns and `height` lines; idle workers are left out first. `left`:
    /// estimated seconds until the end; empty if unknown.
    std::vector<std::string> lines(double now, std::size_t width, std::size_t height = 1000,
                                   std::optional<double> left = {}) const;

private:
    struct Doing {
        const void* id = nullptr;  ///< nullptr: idle
        std::string what;
        double since = 0, fraction = 0;
    };
    std::vector<Doing> workers_;
    std::string line_of(std::size_t worker, double now, std::size_t width) const;
    std::size_t steps_, ended_ = 0, failed_ = 0;
};

/// "0:07", "12:30", "1:02:05".
std::string clock_text(double seconds);

class Progress : public RunObserver {
public:
    Progress(const RunGraph& graph, const std::vector<NodePrediction>& predictions, std::size_t workers, bool quiet,
             unsigned passes = 1);

    void node_started(const RunNode& node, std::size_t worker) override;
    void node_progress(const RunNode& node, double fraction) override;
    void node_warning(const RunNode& node, std::string_view text) override;
    void node_ended(const RunNode& node, const NodeReport& report) override;
    void output_started(const RunCell& cell, const RunOutput& output, std::size_t worker) override;
    void output_written(const RunCell& cell, const OutputReport& report) override;
    void cell_ended(const RunCell& cell, const CellReport& report) override;
    void pass_started(unsigned pass, unsigned passes) override;
    void time_passed() override;
    /// Clears the terminal's lines and calls `print`, which writes other lines to stderr.
    void print_beside(const std::function<void()>& print);
    /// Prints the remaining warnings and clears the terminal's lines.
    void finish();

private:
    bool has_board() const { return terminal_ && !quiet_; }
    void expect_tasks(const std::vector<NodePrediction>& predictions);
    void node_settled(std::size_t node);
    struct ListedFiles;
    void find_lists();
    void print_warnings(ListedFiles& list);
    void print_failure(const RunCell& cell, const CellReport& report);
    std::optional<double> time_left(double now);
    void print(const std::string& text);
    void paint();
    void wipe();

    const RunGraph& graph_;
    StepNames names_;
    ProgressBoard board_;
    TimeLeft time_left_;  ///< tasks: the nodes, then the outputs
    std::unordered_map<std::string, std::size_t> write_of_file_;  ///< task of every output file
    std::vector<std::size_t> cells_left_;  ///< number of unfinished cells that need the task
    std::vector<bool> is_settled_;  ///< by node: whether it has ended or will not run
    bool quiet_;
    bool terminal_;
    std::size_t ended_ = 0;
    std::size_t painted_ = 0;  ///< number of lines on the terminal
    std::chrono::steady_clock::time_point begin_, last_;
    std::optional<double> estimate_;  ///< estimate of the time left
    double estimated_at_ = 0;
    std::map<std::size_t, std::vector<std::string>> doubts_;  ///< doubts of nodes, as their cells repeat them
    std::set<std::string> printed_doubts_;
    std::set<std::pair<std::size_t, std::size_t>> printed_failures_;  ///< node and scan of each failure
    std::mutex mutex_;
    std::set<std::string> read_;  ///< warnings of readers that were reported

    /// The files that one step takes as a list. Their equal warnings are printed once, when all files have been read.
    struct ListedFiles {
        struct Repeated {
            std::string sentence, first_file;
            std::size_t files;
        };
        std::set<std::size_t> unread;  ///< nodes
        std::vector<Repeated> warnings;
    };
    std::map<std::size_t, std::size_t> list_of_;  ///< by the node of a file: the step that takes the list
    std::map<std::size_t, ListedFiles> lists_;  ///< by the node of the step
};

}  // namespace scanmill::runner
