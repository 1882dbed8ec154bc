// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::runner {

namespace {

/// Columns and lines of the terminal; 80 and 24 if they are unknown.
std::pair<std::size_t, std::size_t> terminal_size() {
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
    return {size.ws_col, size.ws_row};
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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

std::string ProgressBoard::line_of(std::size_t worker, double now, std::size_t width) const {
    const Doing& doing = workers_[worker];
    const std::string head = workers_.size() > 1 ? fmt::format("{:>3} ", worker + 1) : "";
    if (!doing.id) return cut_begin(head + "-", width);
    const std::string percent = doing.fraction > 0 ? fmt::format(" {:.0f} %", 100 * doing.fraction) : "";
    const std::string tail = fmt::format("{} {}", percent, clock_text(now - doing.since));
    const std::size_t taken = head.size() + tail.size();
    return cut_begin(head + cut_begin(doing.what, width > taken ? width - taken : 0) + tail, width);
}

std::vector<std::string> ProgressBoard::lines(double now, std::size_t width, std::size_t height,
                                              std::optional<double> left) const {
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
    if (left) total += fmt::format(", about {} left", clock_text(std::ceil(*left)));  // never 0:00
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
                   bool quiet, unsigned passes)
    : graph_(graph),
      names_(graph),
      board_(workers, graph.nodes.size()),
      time_left_(workers, passes),
      is_settled_(graph.nodes.size()),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) != 0),
      begin_(std::chrono::steady_clock::now()) {
    expect_tasks(predictions);
    find_lists();
}

/// Adds the tasks whose time is estimated. All steps with the same name in one workflow are one kind of task, whatever
/// their parameters are. The outputs of one port of such steps are also one kind. The size of a task is the size of the
/// file from which its value is made.
void Progress::expect_tasks(const std::vector<NodePrediction>& predictions) {
    std::map<std::string, std::size_t> kinds;
    const auto kind = [&](const RunNode& node, const std::string& output) {
        const std::string& workflow = graph_.plans[node.plan]->workflow.file;
        return kinds.emplace(workflow + '\n' + graph_.label(node) + '\n' + output, kinds.size()).first->second;
    };
    std::vector<double> sizes;
    for (std::size_t index = 0; index < graph_.nodes.size(); ++index) {
        const RunNode& node = graph_.nodes[index];
        double size = 1;
        for (const NodeInput& input : node.inputs) size = std::max(size, sizes[input.node]);
        std::error_code gone;
        if (!node.step)
            if (const auto bytes = std::filesystem::file_size(node.leaf.file, gone); !gone)
                size = std::max(size, static_cast<double>(bytes));
        sizes.push_back(size);
        time_left_.add(kind(node, ""), node.scan, size);
        if (!predictions[index].will_run) time_left_.dropped(index);
    }
    cells_left_.resize(graph_.nodes.size());
    for (const RunCell& cell : graph_.cells) {
        for (const std::size_t node : cell.nodes) ++cells_left_[node];
        for (const RunOutput& output : cell.outputs) {
            const auto [found, is_new] = write_of_file_.emplace(output.file.string(), cells_left_.size());
            if (is_new) {
                const RunNode& made = graph_.nodes[output.node];
                time_left_.add(kind(made, "output " + output.port), made.scan, sizes[output.node]);
                cells_left_.push_back(0);
            }
            ++cells_left_[found->second];
        }
    }
}

void Progress::find_lists() {
    for (std::size_t step = 0; step < graph_.nodes.size(); ++step) {
        std::map<std::string, std::set<std::size_t>> files;  // nodes by port
        for (const NodeInput& input : graph_.nodes[step].inputs)
            if (!graph_.nodes[input.node].step) files[input.port].insert(input.node);
        for (const auto& [port, nodes] : files) {
            if (nodes.size() < 2) continue;
            for (const std::size_t node : nodes)
                if (list_of_.emplace(node, step).second) lists_[step].unread.insert(node);
        }
    }
}

void Progress::print_warnings(ListedFiles& list) {
    for (const auto& [sentence, first_file, files] : std::exchange(list.warnings, {}))
        print("warning: " + printable_line(files == 1
                                               ? fmt::format("'{}': {}", first_file, sentence)
                                               : fmt::format("'{}': {} ({} files)", first_file, sentence, files)));
}

void Progress::node_settled(std::size_t node) {
    if (is_settled_[node]) return;  // a step runs again if its value was lost
    is_settled_[node] = true;
    ++ended_;
    board_.step_ended();
}

std::optional<double> Progress::time_left(double now) {
    constexpr double least_time = 1;
    if (now - estimated_at_ >= least_time) {
        estimate_ = time_left_.seconds(now);
        estimated_at_ = now;
    }
    return estimate_;
}

void Progress::print(const std::string& text) {
    wipe();
    print_stderr("{}\n", for_stderr(printable(text)));
}

void Progress::wipe() {
    if (painted_ > 0) print_stderr("\x1b[{}A\x1b[J", painted_);
    painted_ = 0;
}

void Progress::paint() {
    wipe();
    const auto [width, height] = terminal_size();
    // The last column and the last line stay free, so that no line wraps or scrolls.
    const double now = seconds_since(begin_);
    for (const std::string& line :
         board_.lines(now, std::max<std::size_t>(width, 2) - 1, std::max<std::size_t>(height, 2) - 1, time_left(now))) {
        print_stderr("{}\n", for_locale(line));
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
    const double now = seconds_since(begin_);
    time_left_.started(graph_.index(node), now);
    if (has_board()) board_.started(worker, &node, printable_line(names_.step(node)), now);
}

void Progress::node_progress(const RunNode& node, double fraction) {
    {
        const std::scoped_lock lock(mutex_);
        time_left_.progressed(graph_.index(node), fraction);
        board_.progressed(&node, fraction);
    }
    time_passed();
}

void Progress::node_warning(const RunNode& node, std::string_view text) {
    const std::scoped_lock lock(mutex_);
    // Warnings of readers begin with the file's path. If a file is used for two inputs, it is read twice.
    if (!node.step && !read_.insert(std::string(text)).second) return;
    const std::string file = node.leaf.name(), begin = "'" + file + "': ";
    if (const auto list = list_of_.find(graph_.index(node)); list != list_of_.end() && text.starts_with(begin)) {
        std::vector<ListedFiles::Repeated>& warnings = lists_.at(list->second).warnings;
        const std::string sentence(text.substr(begin.size()));
        const auto known = std::ranges::find(warnings, sentence, &ListedFiles::Repeated::sentence);
        if (known == warnings.end())
            warnings.push_back({sentence, file, 1});
        else
            ++known->files;
        return;
    }
    print("warning: " + printable_line(node.step ? fmt::format("{}: {}", names_.step(node), text) : std::string(text)));
}

void Progress::node_ended(const RunNode& node, const NodeReport& report) {
    const std::scoped_lock lock(mutex_);
    const std::size_t index = graph_.index(node);
    const bool is_again = is_settled_[index];
    time_left_.ended(index, seconds_since(begin_), report.outcome == Outcome::ok && report.origin == Origin::ran);
    board_.ended(&node);
    node_settled(index);
    if (const auto step = list_of_.find(index); step != list_of_.end()) {
        ListedFiles& list = lists_.at(step->second);
        list.unread.erase(index);
        if (list.unread.empty()) print_warnings(list);
    }
    for (const Doubt& doubt : report.doubts)
        doubts_[index].push_back(fmt::format("{}: {}", graph_.label(node), doubt.text));
    if (quiet_ || terminal_ || report.outcome != Outcome::ok) return;
    const std::string took =
        report.origin == Origin::ran ? fmt::format("{:.2f} s", report.effort.seconds) : std::string("cached");
    print_stderr("[{}/{}] {} {}{}\n", ended_, graph_.nodes.size(), printable_line(names_.step(node)), took,
                 is_again ? ", again" : "");
}

void Progress::output_started(const RunCell&, const RunOutput& output, std::size_t worker) {
    const std::scoped_lock lock(mutex_);
    const double now = seconds_since(begin_);
    time_left_.started(write_of_file_.at(output.file.string()), now);
    if (has_board()) board_.started(worker, &output, printable_line(output.file.string()), now);
}

void Progress::output_written(const RunCell& cell, const OutputReport& report) {
    const std::scoped_lock lock(mutex_);
    time_left_.ended(write_of_file_.at(report.file.string()), seconds_since(begin_), report.outcome == Outcome::ok);
    for (const RunOutput& output : cell.outputs)
        if (output.file == report.file) board_.ended(&output);
    for (const std::string& warning : report.warnings) print("warning: " + printable_line(warning));
}

void Progress::cell_ended(const RunCell& cell, const CellReport& report) {
    const std::scoped_lock lock(mutex_);
    // Remaining work of the cell is dropped unless another cell needs it.
    for (const std::size_t node : cell.nodes)
        if (--cells_left_[node] == 0) {
            if (!is_settled_[node]) time_left_.dropped(node);
            node_settled(node);
        }
    for (const RunOutput& output : cell.outputs)
        if (const std::size_t write = write_of_file_.at(output.file.string()); --cells_left_[write] == 0)
            time_left_.dropped(write);
    // Variants share steps, and therefore also doubts.
    for (const std::string& doubt : report.doubts) {
        const auto has_doubt = [&](std::size_t node) {
            const auto found = doubts_.find(node);
            return found != doubts_.end() && std::ranges::find(found->second, doubt) != found->second.end();
        };
        const auto node = std::ranges::find_if(cell.nodes, has_doubt);
        const bool is_of_scan = node != cell.nodes.end() && graph_.nodes[*node].scan == cell.scan;
        const std::string where = is_of_scan ? names_.scan(graph_.nodes[*node]) : graph_.scan_names[cell.scan];
        const std::string text = fmt::format("doubt: {}: {}", where, doubt);
        if (printed_doubts_.insert(text).second) print(printable_line(text));
    }
    if (report.failure) {
        board_.cell_failed();
        print_failure(cell, report);
    }
}

/// Prints the failure of a cell. If several cells of a scan need the failed node, it is printed once, with these cells.
void Progress::print_failure(const RunCell& cell, const CellReport& report) {
    std::vector<std::size_t> cells{graph_.index(cell)};
    bool is_new = true, is_reading = false;
    if (report.failed_node) {
        const std::size_t node = *report.failed_node;
        is_new = printed_failures_.emplace(node, cell.scan).second;
        is_reading = !graph_.nodes[node].step;
        cells = names_.cells(node, cell.scan);
    }
    if (is_new) {
        Error error = with_option(report.failure.whole());
        if (const std::string some = is_reading ? "" : names_.in_words(cells); !some.empty())
            error.add_frame("under " + some);
        print(error_text(error));
    }
    for (const OutputReport& output : report.outputs) {
        if (!output.evidence.empty())
            print(printable_line(fmt::format("the failed result was written to '{}'", output.evidence.string())));
        if (!output.moved_to.empty())
            print(printable_line(
                fmt::format("warning: the file of an earlier run was moved to '{}'", output.moved_to.string())));
        if (!output.not_moved.empty())
            print(
                printable_line(fmt::format("warning: a file of an earlier run is still there: {}", output.not_moved)));
    }
}

void Progress::pass_started(unsigned pass, unsigned passes) {
    const std::scoped_lock lock(mutex_);
    time_left_.pass_started(pass, seconds_since(begin_));
    if (!quiet_) print(fmt::format("pass {} of {}: the steps run again, to measure their costs", pass, passes));
}

void Progress::print_beside(const std::function<void()>& print) {
    const std::scoped_lock lock(mutex_);
    wipe();
    print();
}

void Progress::finish() {
    const std::scoped_lock lock(mutex_);
    for (auto& [step, list] : lists_) print_warnings(list);
    wipe();
}

}  // namespace scanmill::runner
