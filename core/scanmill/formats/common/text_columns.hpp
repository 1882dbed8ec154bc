// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Tables of numbers as text: their header, the names of their columns, and the columns after x, y and z.
///
/// A line of names is split at semicolons if it has any, else at commas, else at bars, else at tabs, else at blanks.
/// Quotes and blanks around a name are ignored, and so is one separator after the last name. An empty name becomes the
/// number of its column: c4. Case, `_`, `-`, `.` and blanks make no difference: Nx and n.x are the same name, and so
/// are normal_x and NormalX.

#include <optional>

#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// Blanks, tabs, commas, semicolons and bars separate; `#` and `//` begin comments.
constexpr TextRules text_rules{.commas = true, .comment = '#', .slashes = true};

/// The same for numbers with decimal commas: blanks, tabs, semicolons and bars separate.
constexpr TextRules decimal_comma_rules{.commas = true, .decimal_commas = true, .comment = '#', .slashes = true};

/// Thrown for a text that must be read with decimal_comma_rules. `line` is the line of the first row that shows this.
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
    /// A comment that contains the names x, y and z, but cannot name the columns; empty if there is none.
    std::string ignored_names;
};

/// Moves the cursor from the text's beginning to the first row of numbers. Names are taken from a row before it, else
/// from the last comment before it that names x, y, z and every column.
///
/// Throws Error with the line if there is no row, if there are fewer than three columns, or if a row of names does not
/// contain x, y and z and one name per column. Throws DecimalCommas for a text with decimal commas.
TextLayout read_text_layout(TextCursor& text);

/// Whether all remaining tokens of the cursor's row are numbers. The caller's cursor does not move.
bool is_row_of_numbers(TextCursor row);

/// Columns from the numbers after x, y and z.
///
/// With names: nx ny nz or normal x, y, z become `normal` (float64), with a warning unless all have unit length.
/// Columns that are called exactly i, j and k become `approach` (float64), with the same warning. r g b or red green
/// blue, optionally with a or alpha, become `colour` (uint8) if every number is whole and from 0 to 255.
/// If the highest number is 1, the colours stay single columns, with a warning, because 1 may be the byte 1 or a full
/// channel. So do colours that are not bytes. Every other column keeps its name (float64).
///
/// Without names: three columns are `normal` if every row that is not zero has unit length within a tenth. In Leica's
/// PTS layout one column is `intensity`, and four are `intensity` and `colour`. Three columns that are not normals are
/// `colour` there, if they are bytes as above. Other columns are numbered from c4.
///
/// Pre: `values` have equal lengths; `names` is empty or has one name for each. Throws Error if two columns have the
/// same name.
ColumnTable text_columns(std::vector<std::string> names, std::vector<Array<double>> values, bool is_pts,
                         const std::function<void(std::string)>& on_warning);

/// Whether every row that is not zero has unit length within a tenth.
bool are_unit_normals(std::span<const double> x, std::span<const double> y, std::span<const double> z);

}  // namespace scanmill
