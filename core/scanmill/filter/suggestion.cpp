// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/suggestion.hpp"

#include <algorithm>
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

constexpr std::size_t longest_word = 100;  // nobody's typing error; keeps hostile input cheap
constexpr std::size_t most_enumerated = 40;

}  // namespace

std::string closest(std::string_view word, std::span<const std::string> candidates) {
    if (word.size() > longest_word) return {};
    std::size_t allowed = std::max<std::size_t>(word.size() >= 4 ? 2 : 1, word.size() / 3);
    std::string best;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edits(word, candidate);
        if (distance > allowed || distance >= std::max(word.size(), candidate.size())) continue;
        if (best.empty() || distance < allowed) best = candidate;
        allowed = std::min(allowed, distance);
    }
    return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
    const std::string candidate = closest(word, candidates);
    return candidate.empty() ? "" : "; did you mean '" + candidate + "'?";
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

}  // namespace scanmill
