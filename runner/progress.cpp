// SPDX-License-Identifier: GPL-3.0-or-later
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "printable.hpp"

namespace scanmill::runner {

Progress::Progress(const Plan& plan, const RunGraph& graph, bool quiet)
    : plan_(plan),
      graph_(graph),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) != 0) {}

std::string Progress::label(const RunNode& node) const {
    return printable_line(node.step ? fmt::format("{}: {}", graph_.scan_names[node.scan], plan_.steps[*node.step].label)
                                    : fmt::format("{}: read", node.file.string()));
}

void Progress::say(const std::string& line) {
    if (terminal_ && !quiet_) fmt::print(stderr, "\r\x1b[K");
    fmt::print(stderr, "{}\n", printable(line));
}

void Progress::overwrite(const std::string& line) {
    if (terminal_ && !quiet_) {
        fmt::print(stderr, "\r\x1b[K[{}/{}] {}", ended_ + 1, graph_.nodes.size(), line);
        std::fflush(stderr);
    }
}

void Progress::node_started(const RunNode& node) {
    const std::scoped_lock lock(mutex_);
    percent_ = -1;
    overwrite(label(node));
}

void Progress::node_progress(const RunNode& node, double fraction) {
    const std::scoped_lock lock(mutex_);
    const int percent = static_cast<int>(100 * fraction);
    if (percent == percent_) return;
    percent_ = percent;
    overwrite(fmt::format("{} {} %", label(node), percent));
}

void Progress::node_warning(const RunNode& node, std::string_view text) {
    const std::scoped_lock lock(mutex_);
    // What is said of reading begins with the file's path.
    say(node.step ? fmt::format("warning: {}: {}", label(node), text) : fmt::format("warning: {}", text));
}

void Progress::node_ended(const RunNode& node, const NodeReport& report) {
    const std::scoped_lock lock(mutex_);
    ++ended_;
    if (quiet_ || terminal_ || report.outcome != Outcome::done) return;
    const std::string took =
        report.origin == Origin::ran ? fmt::format("{:.2f} s", report.seconds) : std::string("cached");
    fmt::print(stderr, "[{}/{}] {} {}\n", ended_, graph_.nodes.size(), label(node), took);
}

void Progress::output_written(const RunCell&, const OutputReport& report) {
    const std::scoped_lock lock(mutex_);
    for (const std::string& warning : report.warnings) say(fmt::format("warning: {}", warning));
}

void Progress::cell_ended(const RunCell& cell, const CellReport& report) {
    const std::scoped_lock lock(mutex_);
    if (report.error.empty()) return;
    const bool several = plan_.variants.size() > 1;
    say(fmt::format("error: {}{}", report.error,
                    several ? fmt::format("\n  under variant '{}'", plan_.variants[cell.variant].name) : ""));
}

void Progress::finish() {
    if (terminal_ && !quiet_) fmt::print(stderr, "\r\x1b[K");
}

}  // namespace scanmill::runner
