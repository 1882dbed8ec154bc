// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The sentences that a filter reported.

#include <string>
#include <vector>

#include "scanmill/filter/context.hpp"

namespace scanmill::test {

inline std::vector<std::string> doubts_of(const Context& context) {
    std::vector<std::string> doubts;
    for (const Doubt& doubt : context.doubts()) doubts.push_back(doubt.text);
    return doubts;
}

/// The warnings, then the doubts.
inline std::vector<std::string> sentences_of(const Context& context) {
    std::vector<std::string> sentences = context.warnings();
    for (std::string& doubt : doubts_of(context)) sentences.push_back(std::move(doubt));
    return sentences;
}

}  // namespace scanmill::test
