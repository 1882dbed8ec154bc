// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Collects the colours that a text format hangs behind its rows, one to four numbers each, into columns.
///
/// Three or four numbers become `colour` (uint8) when every one is a byte: as `whole` numbers from 0 to 255, spelled
/// without a point, or, where a format allows `fractions` as well, as bytes divided by 255 (see colour_fractions.hpp),
/// which count first: 1 is then a full channel unless some number is larger. Others become `red`, `green`, `blue`,
/// `alpha` (float64), a single one `colour_index`.

#include <functional>

#include "scanmill/data/columns.hpp"
#include "scanmill/formats/text_cursor.hpp"

namespace scanmill {

class RowColours {
public:
    enum class Bytes { whole, fractions };
    explicit RowColours(Bytes bytes = Bytes::whole) : fractions_(bytes == Bytes::fractions) {}

    /// Reads what is left of the cursor's row, but for the last `leave` tokens, as the colour of the next row; a row
    /// may have none. Throws Error with the line for more than four values or for what is no number.
    void read_row(TextCursor& text, std::size_t leave = 0);

    /// Adds the columns for the rows read, one for each of the `elements` ("vertices"). Tells when the rows with a
    /// colour are not all of equal length, so that nothing was added, and when three or four numbers are no bytes.
    void add_columns(ColumnTable& columns, std::string_view elements,
                     const std::function<void(std::string)>& on_warning) const;

private:
    std::size_t rows_ = 0;
    std::size_t coloured_ = 0;
    std::size_t width_ = 0;  // of the first coloured row
    bool uniform_ = true;
    bool bytes_ = true;  // every number is whole, from 0 to 255, and written without a point
    bool fractions_;  // every number is a byte's, divided by 255
    Array<double> values_;
};

}  // namespace scanmill
