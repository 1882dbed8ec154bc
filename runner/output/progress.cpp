// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <wchar.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cwchar>

#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::runner {

namespace {

struct Character {
    std::size_t begin, columns;
};

/// The characters of UTF-8 text with their columns on a terminal; an invalid byte counts as one.
std::vector<Character> characters_of(const std::string& text) {
    static const ::locale_t utf8 = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    const ::locale_t before = ::uselocale(utf8);
    std::vector<Character> all;
    std::mbstate_t state{};
    for (std::size_t begin = 0; begin < text.size();) {
        wchar_t character = 0;
        const std::size_t bytes = std::mbrtowc(&character, &text[begin], text.size() - begin, &state);
        const bool is_valid = bytes != 0 && bytes <= text.size();
        all.push_back({begin, is_valid ? static_cast<std::size_t>(std::max(0, ::wcwidth(character))) : 1});
        if (!is_valid) state = {};
        begin += is_valid ? bytes : 1;
    }
    ::uselocale(before);
    return all;
}

/// At most `width` columns of whole characters; the beginning is cut off, because names differ at their end.
std::string fitted(const std::string& text, std::size_t width) {
    const std::vector<Character> characters = characters_of(text);
    std::size_t columns = 0;
    for (const Character& each : characters) columns += each.columns;
    if (columns <= width) return text;
    if (width < 2) return "";
    for (const Character& each : characters) {
        if (columns + 1 <= width) return "…" + text.substr(each.begin);
        columns -= each.columns;
    }
    return "…";
}

/// Columns and lines of the terminal.
std::pair<std::size_t, std::size_t> terminal_size() {
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
    return {size.ws_col, size.ws_row};
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::size_t count_to_run(const std::vector<NodePrediction>& predictions) {
    return static_cast<std::size_t>(std::ranges::count(predictions, true, &NodePrediction::will_run));
}

}  // namespace

void ProgressBoard::progressed(const void* id, double fraction) {
    for (Doing& each : workers_)
        if (each.id == id) each.fraction = std::clamp(fraction, 0.0, 1.0);
}

void ProgressBoard::ended(const void* id) {
    for (Doing& each : workers_)
        if (each.id == id) each = {};
}

std::optional<double> ProgressBoard::time_left(double now) const {
    constexpr double least_time = 1;
    if (ran_ == 0 || now < least_time || ended_ >= steps_) return std::nullopt;
    const std::size_t to_come = to_run_ > ran_ ? to_run_ - ran_ : 0;
    return now / static_cast<double>(ran_) * static_cast<double>(to_come);
}

std::string ProgressBoard::line_of(std::size_t worker, double now, std::size_t width) const {
    const Doing& doing = workers_[worker];
    const std::string head = workers_.size() > 1 ? fmt::format("{:>3} ", worker + 1) : "";
    if (!doing.id) return fitted(head + "-", width);
    const std::string percent = doing.fraction > 0 ? fmt::format(" {:.0f} %", 100 * doing.fraction) : "";
    const std::string tail = fmt::format("{} {}", percent, clock_text(now - doing.since));
    const std::size_t taken = head.size() + tail.size();
    return fitted(head + fitted(doing.what, width > taken ? width - taken : 0) + tail, width);
}

std::vector<std::string> ProgressBoard::lines(double now, std::size_t width, std::size_t height) const {
    std::vector<std::string> all;
    const bool has_room = workers_.size() < height;
    for (std::size_t worker = 0; worker < workers_.size() && all.size() + 1 < height; ++worker)
        if (has_room || workers_[worker].id) all.push_back(line_of(worker, now, width));
    constexpr std::size_t bar_width = 20;
    const std::size_t filled = steps_ > 0 ? bar_width * std::min(ended_, steps_) / steps_ : bar_width;
    std::string total = fmt::format("[{}{}] {}/{}", std::string(filled, '#'), std::string(bar_width - filled, '.'),
                                    std::min(ended_, steps_), count_text(steps_, "step", "steps"));
    if (failed_ > 0) total += fmt::format(", {} failed", failed_);
    total += ", " + clock_text(now);
    if (const std::optional<double> left = time_left(now)) total += fmt::format(", about {} left", clock_text(*left));
    all.push_back(total.substr(0, width));
    return all;
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<long long>(std::max(0.0, std::floor(seconds)));
    const long long hours = whole / 3600, minutes = whole / 60 % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60)
                     : fmt::format("{}:{:02}", minutes, whole % 60);
}

Progress::Progress(const RunGraph& graph, const std::vector<NodePrediction>& predictions, std::size_t workers,
                   bool quiet)
    : graph_(graph),
      board_(workers, graph.nodes.size(), count_to_run(predictions)),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) != 0),
      begin_(std::chrono::steady_clock::now()) {}

std::string Progress::label(const RunNode& node) const {
    return printable_line(node.step ? fmt::format("{}: {}", graph_.scan_names[node.scan], graph_.label(node))
                                    : fmt::format("{}: read", node.leaf.file.string()));
}

void Progress::print(const std::string& text) {
    wipe();
    print_stderr("{}\n", printable(text));
}

void Progress::wipe() {
    if (painted_ > 0) print_stderr("\x1b[{}A\x1b[J", painted_);
    painted_ = 0;
}

void Progress::paint() {
    wipe();
    const auto [width, height] = terminal_size();
    // The last column and the last line stay free, so that no line wraps or scrolls.
    for (const std::string& line : board_.lines(seconds_since(begin_), std::max<std::size_t>(width, 2) - 1,
                                                std::max<std::size_t>(height, 2) - 1)) {
        print_stderr("{}\n", line);
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
    // Warnings of readers begin with the file's path; a file that is an input twice is read twice.
    if (!node.step && !read_.insert(std::string(text)).second) return;
    print("warning: " + printable_line(node.step ? fmt::format("{}: {}", label(node), text) : std::string(text)));
}

void Progress::node_ended(const RunNode& node, const NodeReport& report) {
    const std::scoped_lock lock(mutex_);
    ++ended_;
    board_.ended(&node);
    board_.step_ended(report.origin != Origin::cached);
    if (quiet_ || terminal_ || report.outcome != Outcome::ok) return;
    const std::string took =
        report.origin == Origin::ran ? fmt::format("{:.2f} s", report.effort.seconds) : std::string("cached");
    print_stderr("[{}/{}] {} {}\n", ended_, graph_.nodes.size(), label(node), took);
}

void Progress::output_started(const RunCell&, const RunOutput& output, std::size_t worker) {
    const std::scoped_lock lock(mutex_);
    board_.started(worker, &output, printable_line(output.file.string()), seconds_since(begin_));
}

void Progress::output_written(const RunCell& cell, const OutputReport& report) {
    const std::scoped_lock lock(mutex_);
    for (const RunOutput& output : cell.outputs)
        if (output.file == report.file) board_.ended(&output);
    for (const std::string& warning : report.warnings) print("warning: " + printable_line(warning));
}

void Progress::cell_ended(const RunCell& cell, const CellReport& report) {
    const std::scoped_lock lock(mutex_);
    for (const std::string& doubt : report.doubts) {
        const std::string text = fmt::format("doubt: {}: {}", graph_.scan_names[cell.scan], doubt);
        if (printed_doubts_.insert(text).second) print(printable_line(text));  // variants share steps
    }
    if (!report.failure) return;
    board_.cell_failed();
    const bool several = graph_.plans[cell.plan]->variants.size() > 1;
    print(error_text(with_option(report.failure.whole())) +
          (several ? fmt::format("\n  under variant '{}'", graph_.variant(cell).name) : ""));
}

void Progress::pass_started(unsigned pass, unsigned passes) {
    const std::scoped_lock lock(mutex_);
    if (!quiet_) print(fmt::format("pass {} of {}: the steps run again, to measure their costs", pass, passes));
}

void Progress::print_beside(const std::function<void()>& print) {
    const std::scoped_lock lock(mutex_);
    wipe();
    print();
}

void Progress::finish() {
    const std::scoped_lock lock(mutex_);
    wipe();
}

}  // namespace scanmill::runner
