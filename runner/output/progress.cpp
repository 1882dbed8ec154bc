// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

#include "output/error_output.hpp"
#include "output/printable.hpp"
#include "output/stderr_text.hpp"

namespace scanmill::runner {

namespace {

/// Columns and lines.
std::pair<std::size_t, std::size_t> terminal_size() {
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
    return {size.ws_col, size.ws_row};
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::size_t count_to_run(const std::vector<NodePrediction>& prediction) {
    return static_cast<std::size_t>(std::ranges::count(prediction, true, &NodePrediction::will_run));
}

}  // namespace

Progress::Progress(const RunGraph& graph, const std::vector<NodePrediction>& prediction, std::size_t workers,
                   bool quiet)
    : graph_(graph),
      board_(workers, graph.nodes.size(), count_to_run(prediction)),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) != 0),
      begin_(std::chrono::steady_clock::now()) {}

std::string Progress::label(const RunNode& node) const {
    return printable_line(node.step ? fmt::format("{}: {}", graph_.scan_names[node.scan], graph_.label(node))
                                    : fmt::format("{}: read", node.leaf.file.string()));
}

void Progress::say(const std::string& line) {
    wipe();
    tell("{}\n", printable(line));
}

void Progress::wipe() {
    if (painted_ > 0) tell("\x1b[{}A\x1b[J", painted_);
    painted_ = 0;
}

void Progress::paint() {
    wipe();
    const auto [width, height] = terminal_size();
    // The last column and the last line stay free: nothing wraps, nothing scrolls away.
    for (const std::string& line : board_.lines(seconds_since(begin_), std::max<std::size_t>(width, 2) - 1,
                                                std::max<std::size_t>(height, 2) - 1)) {
        tell("{}\n", line);
        ++painted_;
    }
    std::fflush(stderr);
}

void Progress::time_passed() {
    if (!has_board()) return;
    const std::scoped_lock lock(mutex_);
    constexpr std::chrono::milliseconds pause(100);
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < pause) return;
    last_ = now;
    paint();
}

void Progress::node_started(const RunNode& node, std::size_t worker) {
    const std::scoped_lock lock(mutex_);
    board_.started(worker, &node, label(node), seconds_since(begin_));
}

void Progress::node_progress(const RunNode& node, double fraction) {
    {
        const std::scoped_lock lock(mutex_);
        board_.progressed(&node, fraction);
    }
    time_passed();
}

void Progress::node_warning(const RunNode& node, std::string_view text) {
    const std::scoped_lock lock(mutex_);
    // What is said of reading begins with the file's path.
    say(node.step ? fmt::format("warning: {}: {}", label(node), text) : fmt::format("warning: {}", text));
}

void Progress::node_ended(const RunNode& node, const NodeReport& report) {
    const std::scoped_lock lock(mutex_);
    ++ended_;
    board_.ended(&node);
    board_.step_ended(report.origin != Origin::cached);
    if (quiet_ || terminal_ || report.outcome != Outcome::done) return;
    const std::string took =
        report.origin == Origin::ran ? fmt::format("{:.2f} s", report.effort.seconds) : std::string("cached");
    tell("[{}/{}] {} {}\n", ended_, graph_.nodes.size(), label(node), took);
}

void Progress::output_started(const RunCell&, const RunOutput& output, std::size_t worker) {
    const std::scoped_lock lock(mutex_);
    board_.started(worker, &output, printable_line(output.file.string()), seconds_since(begin_));
}

void Progress::output_written(const RunCell& cell, const OutputReport& report) {
    const std::scoped_lock lock(mutex_);
    for (const RunOutput& output : cell.outputs)
        if (output.file == report.file) board_.ended(&output);
    for (const std::string& warning : report.warnings) say(fmt::format("warning: {}", warning));
}

void Progress::cell_ended(const RunCell& cell, const CellReport& report) {
    const std::scoped_lock lock(mutex_);
    if (!report.failure) return;
    board_.cell_failed();
    const bool several = graph_.plans[cell.plan]->variants.size() > 1;
    say(fmt::format("error: {}{}", with_option(report.failure.whole()).what(),
                    several ? fmt::format("\n  under variant '{}'", graph_.variant(cell).name) : ""));
}

void Progress::say_beside(const std::function<void()>& say_it) {
    const std::scoped_lock lock(mutex_);
    wipe();
    say_it();
}

void Progress::finish() {
    const std::scoped_lock lock(mutex_);
    wipe();
}

}  // namespace scanmill::runner
