// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Collects the colours that a text format hangs behind its rows, one to four numbers each, into columns.

#include "scanmill/data/columns.hpp"
#include "scanmill/formats/text_cursor.hpp"

namespace scanmill {

class RowColours {
public:
    /// Reads what is left of the cursor's row, but for the last `leave` tokens, as the colour of the next row; a row
    /// may have none. Throws Error with the line for more than four values or for what is no number.
    void read_row(TextCursor& text, std::size_t leave = 0);

    /// Adds the columns (see off.hpp) for the rows read. Returns the rows with a colour when they are not all of equal
    /// length, so that nothing was added; else 0.
    std::size_t add_columns(ColumnTable& columns) const;

private:
    std::size_t rows_ = 0;
    std::size_t coloured_ = 0;
    std::size_t width_ = 0;  // of the first coloured row
    bool uniform_ = true;
    bool bytes_ = true;  // every number is whole, from 0 to 255, and written without a point
    Array<double> values_;
};

}  // namespace scanmill
