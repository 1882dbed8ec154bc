// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Collects the warnings of one job. Equal sentences are kept once, with their number.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace scanmill {

class CountedWarnings {
public:
    /// Adds a sentence. Returns whether it is new. Cost: O(number of different sentences).
    bool add(const std::string& sentence) {
        const auto found = std::ranges::find(warnings_, sentence, &Warning::sentence);
        if (found != warnings_.end()) {
            ++found->count;
            return false;
        }
        warnings_.push_back({sentence, 1});
        return true;
    }
    /// Warnings in the order of their first appearance: "… (3 times)".
    std::vector<std::string> sentences() const {
        std::vector<std::string> sentences;
        for (const auto& [sentence, count] : warnings_)
            sentences.push_back(count > 1 ? fmt::format("{} ({} times)", sentence, count) : sentence);
        return sentences;
    }

private:
    struct Warning {
        std::string sentence;
        std::size_t count;
    };
    std::vector<Warning> warnings_;
};

}  // namespace scanmill
