// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The names that a text of numbers gives its columns, and what the well-known ones mean.
///
/// A line of names is split at semicolons when it has some, else at commas, bars, tabs, blanks, the first that occurs.
/// Names may stand in double or single quotes, which protect what is inside them; blanks around a name and one
/// separator behind the last do not count. A name that is empty becomes the number of its column: c4. Names mean the
/// same in upper and lower case and with or without `_`, `-`, `.` and blanks: Nx, normal_x and NormalX are one.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/columns.hpp"

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

// From the numbers behind x, y and z in the rows of a text to named columns.
//
// With names: a normal's three columns become `normal` (float64), a colour's three or four `colour` (uint8) when every
// number is whole, from 0 to 255, and not all are 0 or 1 (1 may be the faintest or the full channel); otherwise they
// stay columns of their own, which is told. Every other column keeps its name (float64). Normals that are not of unit
// length are told.
//
// Without names: three columns are `normal` when every row that is not zero has unit length within a tenth. In Leica's
// PTS layout one column is `intensity`, four are `intensity` and `colour`, three that are no normals are `colour`,
// under the same condition. Everything else is numbered from c4; three that are no unit normals are told.

/// Pre: `values` are of equal length; `names` is empty or has one for each of them. Throws Error when two columns have
/// one name.
ColumnTable text_columns(std::vector<std::string> names, std::vector<Array<double>> values, bool is_pts,
                         const std::function<void(std::string)>& on_warning);

/// Three columns of `rows` rows as normals, when every row that is not zero has about unit length.
bool are_unit_normals(std::span<const Array<double>* const> components);

/// Components side by side in one column.
Column joined(std::string name, std::span<const Array<double>* const> components);

/// The same as uint8 `colour`, when text_columns() calls it a colour.
std::optional<Column> as_colour(std::span<const Array<double>* const> components);

}  // namespace scanmill
