// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The names that a text of numbers gives its columns, and what the well-known ones mean.
///
/// A line of names is split at semicolons when it has some, else at commas, bars, tabs, blanks, the first that occurs.
/// Names may stand in double or single quotes, which protect what is inside them; blanks around a name and one
/// separator behind the last do not count. A name that is empty becomes the number of its column: c4. Names mean the
/// same in upper and lower case and with or without `_`, `-`, `.` and blanks: Nx, normal_x and NormalX are one.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanmill {

/// The names in a line, in order; at most `most` and one.
std::vector<std::string> split_names(std::string_view line, std::size_t most);

/// Which of the names are x, y and z; nothing unless each of the three occurs exactly once.
std::optional<std::array<std::size_t, 3>> axes_among(std::span<const std::string> names);

/// The first name that is x, y or z as an earlier one is too.
std::optional<std::string> repeated_axis(std::span<const std::string> names);

/// Columns that belong together as one of several components.
struct NamedGroup {
    enum class Kind { normal, colour } kind;
    std::vector<std::size_t> columns;  ///< in the order x y z, or red green blue and perhaps alpha
};

/// A normal (nx ny nz; normal x, y, z) and a colour (r g b, red green blue; with a or alpha), each at most once.
std::vector<NamedGroup> groups_among(std::span<const std::string> names);

}  // namespace scanmill
