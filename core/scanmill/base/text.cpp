// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <vector>

namespace scanmill {

namespace {

/// Optimal string alignment distance.
std::size_t edits(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        now[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = std::min(now[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, now);
    }
    return last[b.size()];
}

constexpr std::size_t longest_word = 100;  // longer words are not typing errors
constexpr std::size_t most_enumerated = 40;

}  // namespace

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
    if (word.size() > longest_word) return {};
    std::size_t allowed = std::max<std::size_t>(word.size() >= 4 ? 2 : 1, word.size() / 3);
    std::string best;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edits(word, candidate);
        if (distance > allowed || distance >= std::max(word.size(), candidate.size())) continue;
        if (best.empty() || distance < allowed) best = candidate;
        allowed = std::min(allowed, distance);
    }
    return best.empty() ? "" : "; did you mean '" + best + "'?";
}

std::string enumerated(std::span<const std::string> names) {
    const std::size_t shown = names.size() <= most_enumerated ? names.size() : most_enumerated - 1;
    std::string text;
    for (std::size_t i = 0; i < shown; ++i) {
        if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
        text += names[i];
    }
    if (shown < names.size()) text += " and " + std::to_string(names.size() - shown) + " more";
    return text;
}

namespace {

/// Whether an unsigned decimal number outside the range of double is too small, not too large.
bool is_too_small(std::string_view number) {
    const std::size_t mantissa_end = std::min(number.find_first_of("eE"), number.size());
    const std::string_view mantissa = number.substr(0, mantissa_end);
    const auto point = static_cast<std::int64_t>(std::min(mantissa.find('.'), mantissa.size()));
    const auto first_digit = static_cast<std::int64_t>(std::min(mantissa.find_first_not_of("0."), mantissa.size()));
    if (first_digit == static_cast<std::int64_t>(mantissa.size())) return true;
    std::int64_t exponent = 0;
    if (mantissa_end < number.size()) {
        std::string_view digits = number.substr(mantissa_end + 1);
        if (digits.front() == '+') digits.remove_prefix(1);
        // An exponent that does not fit into 64 bits decides alone: no text has that many digits.
        if (std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec != std::errc())
            return digits.front() == '-';
    }
    // The mantissa is about 10^(point - first_digit). This estimate suffices, because numbers outside the range of
    // double are hundreds of orders of magnitude away from 1.
    return exponent < first_digit - point;
}

}  // namespace

std::string byte_size_text(std::uint64_t bytes) {
    constexpr std::array<const char*, 4> units{"KiB", "MiB", "GiB", "TiB"};
    if (bytes < 1024) return fmt::format("{} B", bytes);
    std::size_t unit = 0;
    double amount = static_cast<double>(bytes) / 1024;
    for (; amount >= 1024 && unit + 1 < units.size(); ++unit) amount /= 1024;
    return fmt::format("{:.{}f} {}", amount, amount < 10 ? 2 : amount < 100 ? 1 : 0, units[unit]);
}

std::string number_text(double value) {
    std::array<char, 32> digits;
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    return {digits.data(), end};
}

bool parse_number(std::string_view text, double& value) {
    const char* begin = text.data();
    const char* end = begin + text.size();
    if (text.size() > 1 && *begin == '+' && begin[1] != '-') ++begin;
    const auto [rest, error] = std::from_chars(begin, end, value);
    if (rest != end || begin == end) return false;
    if (error == std::errc()) return true;
    if (error != std::errc::result_out_of_range) return false;
    // A number outside the range of double becomes 0 or infinity, as in other number readers.
    const bool negative = *begin == '-';
    value = is_too_small({begin + (negative ? 1 : 0), end}) ? 0.0 : std::numeric_limits<double>::infinity();
    if (negative) value = -value;
    return true;
}

std::string quote(std::string_view bytes) {
    constexpr std::size_t longest = 40;
    std::string text = "'";
    for (char c : bytes.substr(0, longest)) text += c >= ' ' && c <= '~' ? c : '?';
    return text + (bytes.size() > longest ? "…'" : "'");
}

std::string shell_word(const std::filesystem::path& path) {
    const std::string text = path.string();
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) ||
               std::string_view("/._-+,%@:=").find(c) != std::string::npos;
    };
    if (!text.empty() && text.front() != '-' && std::ranges::all_of(text, plain)) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

}  // namespace scanmill
