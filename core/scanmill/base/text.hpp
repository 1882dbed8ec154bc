// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text for messages: counts, suggestions, numbers, quoted bytes.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace scanmill {

/// `singular` for a count of 1, else `plural`.
inline std::string_view by_count(std::uint64_t count, std::string_view singular, std::string_view plural) {
    return count == 1 ? singular : plural;
}

/// The count and the word that by_count() chooses: "1 row", "3 rows".
inline std::string count_text(std::uint64_t count, std::string_view singular, std::string_view plural) {
    return std::to_string(count).append(" ").append(by_count(count, singular, plural));
}

/// "; did you mean 'x'?" with the candidate that needs the fewest edits (insert, delete, replace, swap neighbours). The
/// earlier candidate wins ties. Empty if every candidate needs too many edits. A third of the word's length is allowed,
/// but at least 1 edit, or 2 edits from four letters on.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// "a, b and c", for messages. With more than forty names: the first 39 and the number of the remaining names.
std::string enumerated(std::span<const std::string> names);

/// "1.50 GiB", "20.0 GiB", "512 MiB".
std::string byte_size_text(std::uint64_t bytes);

/// The shortest text that reads back to the same double. Independent of the locale.
std::string number_text(double value);
/// Reads all of `text` as a double, independently of the locale. Returns false if `text` is not a number. Accepts nan
/// and inf in any case and a leading '+', but no surrounding blanks.
bool parse_number(std::string_view text, double& value);

/// The first few dozen bytes of `bytes` in quotes, for a message. Unprintable bytes become '?'.
std::string quote(std::string_view bytes);

/// The path as one word of a shell's command line, for hints that contain a command.
std::string shell_word(const std::filesystem::path& path);

}  // namespace scanmill
