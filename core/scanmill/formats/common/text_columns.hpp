// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Tables of numbers as text: their header, the names of their columns, and the columns after x, y and z.
///
/// A line of names is split at semicolons when it has some, else at the first of commas, bars, tabs, blanks that it
/// has. Quotes and blanks around a name and one separator after the last do not count. An empty name becomes the number
/// of its column: c4. Upper and lower case, `_`, `-`, `.` and blanks make no difference: Nx and n.x are one name,
/// normal_x and NormalX another.

#include <optional>

#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// Blanks, tabs, commas, semicolons and bars separate; `#` and `//` begin comments.
constexpr TextRules text_rules{.commas = true, .comment = '#', .slashes = true};

/// The same for numbers with decimal commas: blanks, tabs, semicolons and bars separate.
constexpr TextRules decimal_comma_rules{.commas = true, .decimal_commas = true, .comment = '#', .slashes = true};

/// Thrown for a text that must be read with decimal_comma_rules, at the first row that shows it.
struct DecimalCommas {
    std::size_t line;
};
/// Throws DecimalCommas if the first line of `rest` is three or more numbers under decimal_comma_rules, some with a
/// comma: "1,5;2,5;3,5" and "1,5 2 3,5", but not "1,5,2,5".
void require_no_decimal_commas(std::string_view rest, std::size_t line);

struct TextLayout {
    /// The single whole number in a line before the first row: the number of points that follow.
    std::optional<std::size_t> declared_points;
    std::size_t declared_in_line = 0;
    /// Empty, or one name per column.
    std::vector<std::string> names;
    std::size_t width = 0;  ///< numbers per row, at least 3
    std::array<std::size_t, 3> axes{0, 1, 2};  ///< the columns of x, y, z
    /// A comment with the names x, y and z but without a name for every column; empty when there is none.
    std::string ignored_names;
};

/// Moves the cursor from the text's beginning to the first row of numbers. Names are taken from a row before it or else
/// from the last comment before it that names x, y, z and every column. Throws Error with the line: no row, fewer than
/// three columns, names without x, y and z or not one for each column. Throws DecimalCommas.
TextLayout read_text_layout(TextCursor& text);

/// Whether all remaining tokens of the cursor's row are numbers; does not move it.
bool is_row_of_numbers(TextCursor row);

/// Columns from the numbers after x, y and z.
///
/// With names: nx ny nz or normal x, y, z become `normal` (float64), with a warning unless all have unit length; r g b
/// or red green blue, optionally with a or alpha, become `colour` (uint8) when every number is whole, from 0 to 255,
/// and not all are 0 or 1 (1 may be the faintest or the full channel), else they stay single columns, with a warning.
/// Every other column keeps its name (float64).
///
/// Without names: three columns are `normal` when every row that is not zero has unit length within a tenth. In Leica's
/// PTS layout one column is `intensity`, four are `intensity` and `colour`, three that are not normals are `colour`,
/// under the same condition. Other columns are numbered from c4.
///
/// Pre: `values` are of equal length; `names` is empty or has one for each. Throws Error when two columns have the same
/// name.
ColumnTable text_columns(std::vector<std::string> names, std::vector<Array<double>> values, bool is_pts,
                         const std::function<void(std::string)>& on_warning);

/// Whether every row that is not zero has unit length within a tenth.
bool are_unit_normals(std::span<const double> x, std::span<const double> y, std::span<const double> z);

}  // namespace scanmill
