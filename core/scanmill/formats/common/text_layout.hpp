// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What stands before the numbers of a text, and how its rows are to be read: perhaps a count of points, perhaps a line
/// of names, in either order, and the number of columns.

#include <array>
#include <optional>

#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// Blanks, tabs, commas, semicolons and bars separate; `#` and `//` begin comments.
constexpr TextRules text_rules{.commas = true, .comment = '#', .slashes = true};

struct TextLayout {
    /// A line with a single whole number before the first row: the points that follow.
    std::optional<std::size_t> promised;
    std::size_t promised_in_line = 0;
    /// Empty, or one name per column.
    std::vector<std::string> names;
    std::size_t width = 0;  ///< numbers per row, at least 3
    std::array<std::size_t, 3> axes{0, 1, 2};  ///< which of them are x, y, z
    /// A comment that speaks of x, y and z but does not name every column; empty when there is none.
    std::string passed_over;
    /// Comments before the first row of numbers that were too many to be looked through for names; 0 where a row
    /// has the names.
    std::size_t unread_comments = 0;
};

/// Moves the cursor, which is at the text's beginning, to the first row of numbers, and looks at it. The names are a
/// row or else the last comment before it that names x, y, z and one for each column. Throws Error with the line: no
/// row, fewer than three columns, names without x, y and z or not one for each column.
TextLayout read_text_layout(TextCursor& text);

/// Whether all tokens left in the cursor's row are numbers; does not move it.
bool is_row_of_numbers(TextCursor row);

}  // namespace scanmill
