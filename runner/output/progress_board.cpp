// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/progress_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/text.hpp"

namespace scanmill::runner {

namespace {

/// Columns that a character takes on a terminal.
std::size_t columns_of(char32_t character) {
    struct Range {
        char32_t first, last;
    };
    constexpr std::array<Range, 11> wide{{{0x1100, 0x115F},
                                          {0x2E80, 0xA4CF},
                                          {0xAC00, 0xD7A3},
                                          {0xF900, 0xFAFF},
                                          {0xFE30, 0xFE6F},
                                          {0xFF00, 0xFF60},
                                          {0xFFE0, 0xFFE6},
                                          {0x1F300, 0x1F64F},
                                          {0x1F680, 0x1FAFF},
                                          {0x20000, 0x2FFFD},
                                          {0x30000, 0x3FFFD}}};
    if (character >= 0x300 && character <= 0x36F) return 0;  // accents over what stands before
    const auto is_within = [&](const Range& range) { return character >= range.first && character <= range.last; };
    return std::ranges::any_of(wide, is_within) ? 2 : 1;
}

struct Character {
    std::size_t place, columns;
};

/// Of UTF-8; a byte that is none counts as a character.
std::vector<Character> characters_of(const std::string& text) {
    std::vector<Character> all;
    for (std::size_t place = 0; place < text.size();) {
        const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
        const std::size_t length = byte(place) >= 0xF0 ? 4 : byte(place) >= 0xE0 ? 3 : byte(place) >= 0xC0 ? 2 : 1;
        char32_t character = length == 1 ? byte(place) : byte(place) & (0xFFu >> (length + 1));
        std::size_t end = place + 1;
        for (; end < text.size() && end < place + length && (byte(end) & 0xC0) == 0x80; ++end)
            character = character << 6 | (byte(end) & 0x3F);
        all.push_back({place, columns_of(character)});
        place = end;
    }
    return all;
}

/// Whole characters, at most `width` columns of them; the beginning gives way, for the end of a name says more.
std::string fitted(const std::string& text, std::size_t width) {
    const std::vector<Character> characters = characters_of(text);
    std::size_t columns = 0;
    for (const Character& each : characters) columns += each.columns;
    if (columns <= width) return text;
    if (width < 2) return "";
    for (const Character& each : characters) {
        if (columns + 1 <= width) return "…" + text.substr(each.place);
        columns -= each.columns;
    }
    return "…";
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

}  // namespace scanmill::runner
