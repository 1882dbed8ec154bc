// SPDX-License-Identifier: GPL-3.0-or-later
#include "progress_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanmill::runner {

namespace {

/// Whole characters of UTF-8, at most `width` of them; the beginning gives way, for the end of a name says more.
std::string fitted(const std::string& text, std::size_t width) {
    const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
    const auto characters = static_cast<std::size_t>(std::ranges::count_if(text, begins));
    if (characters <= width) return text;
    if (width < 2) return "";
    std::size_t surplus = characters - (width - 1);
    std::size_t place = 0;
    for (; place < text.size(); ++place)
        if (begins(text[place]) && surplus-- == 0) break;
    return "…" + text.substr(place);
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
    constexpr double telling = 1;
    if (ran_ == 0 || now < telling || ended_ >= steps_) return std::nullopt;
    const std::size_t to_come = to_run_ > ran_ ? to_run_ - ran_ : 0;
    return now / static_cast<double>(ran_) * static_cast<double>(to_come);
}

std::vector<std::string> ProgressBoard::lines(double now, std::size_t width) const {
    std::vector<std::string> all;
    for (std::size_t worker = 0; worker < workers_.size(); ++worker) {
        const Doing& doing = workers_[worker];
        const std::string head = workers_.size() > 1 ? fmt::format("{:>3} ", worker + 1) : "";
        if (!doing.id) {
            all.push_back(fitted(head + "-", width));
            continue;
        }
        const std::string percent = doing.fraction > 0 ? fmt::format(" {:.0f} %", 100 * doing.fraction) : "";
        const std::string tail = fmt::format("{} {}", percent, clock_text(now - doing.since));
        const std::size_t taken = head.size() + tail.size();
        all.push_back(head + fitted(doing.what, width > taken ? width - taken : 0) + tail);
    }
    constexpr std::size_t bar_width = 20;
    const std::size_t filled = steps_ > 0 ? bar_width * std::min(ended_, steps_) / steps_ : bar_width;
    std::string total = fmt::format("[{}{}] {}/{} steps", std::string(filled, '#'),
                                    std::string(bar_width - filled, '.'), std::min(ended_, steps_), steps_);
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

}  // namespace scanmill::runner
