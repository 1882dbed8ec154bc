// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// "did you mean …": the closest known name to one that is not known.

#include <span>
#include <string>
#include <string_view>

namespace scanmill {

/// The candidate with the fewest edits (insert, delete, replace, swap neighbours), ties to the earlier one; empty when
/// none is within a third of the word's length (at least 1 edit, 2 from four letters on).
std::string closest(std::string_view word, std::span<const std::string> candidates);

/// "; did you mean 'x'?" or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// "a, b and c", for messages; of more than forty names the first 39 and how many more there are.
std::string enumerated(std::span<const std::string> names);

}  // namespace scanmill
