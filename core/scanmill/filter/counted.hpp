// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Counts in sentences: "1 face", "12 faces".

#include <cstdint>
#include <string>
#include <string_view>

namespace scanmill {

/// The word that goes with a count: `singular` with 1, else `plural`.
inline std::string_view by_count(std::uint64_t count, std::string_view singular, std::string_view plural) {
    return count == 1 ? singular : plural;
}

/// The count and its word.
inline std::string counted(std::uint64_t count, std::string_view singular, std::string_view plural) {
    return std::to_string(count).append(" ").append(by_count(count, singular, plural));
}

}  // namespace scanmill
