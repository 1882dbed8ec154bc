// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text for messages: counts, suggestions, numbers, quoted bytes.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace scanmill {

/// The word that goes with a count: `singular` with 1, else `plural`.
inline std::string_view by_count(std::uint64_t count, std::string_view singular, std::string_view plural) {
    return count == 1 ? singular : plural;
}

/// The count and its word.
inline std::string count_text(std::uint64_t count, std::string_view singular, std::string_view plural) {
    return std::to_string(count).append(" ").append(by_count(count, singular, plural));
}

/// The candidate with the fewest edits (insert, delete, replace, swap neighbours), ties to the earlier one; empty when
/// none is within a third of the word's length (at least 1 edit, 2 from four letters on).
std::string closest(std::string_view word, std::span<const std::string> candidates);

/// "; did you mean 'x'?" or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// "a, b and c", for messages; of more than forty names the first 39 and how many more there are.
std::string enumerated(std::span<const std::string> names);

/// Shortest text that reads back to the same double; locale-free.
std::string number_text(double value);
/// The whole of `text` as a double, locale-free; nothing when it is not one. Accepts nan and inf in any case, a leading
/// '+', and no surrounding blanks.
bool parse_number(std::string_view text, double& value);

/// Bytes of a file for a message: in quotes, at most a few dozen, everything unprintable as '?'.
std::string quote(std::string_view bytes);

/// The path as one word of a shell's command line, for hints that hold a command.
std::string shell_word(const std::filesystem::path& path);

}  // namespace scanmill
