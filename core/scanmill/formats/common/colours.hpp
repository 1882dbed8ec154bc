// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Colours of text formats: bytes written as decimals from 0 to 1, where 1 is a full channel, and colours at the end of
/// rows.
///
/// A decimal means the byte b if it is b / 255, rounded to the decimal's own digits after the point (at least three) or
/// computed in single precision. 0.502, 0.50196 and 0.501960813999 are 128; 0.5 is not a byte.

#include <optional>

#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// The byte that a decimal means; nullopt if it means none. Pre: `value` is the number that `spelling` reads as.
std::optional<u8> byte_of_fraction(std::string_view spelling, double value);

/// The shortest decimal for every byte. Programs that multiply it by 255, in single or double precision, and round or
/// truncate, get the same byte.
std::array<std::string, 256> colour_fractions();

/// Collects the colours at the end of the rows of a text format, one to four numbers each, into columns.
///
/// Three or four numbers become `colour` (uint8) if every number is a byte. `whole` bytes are numbers from 0 to 255,
/// spelled without a point. `fractions` also allows bytes divided by 255. Fractions have precedence: 1 is then a full
/// channel unless some number is larger. Three or four other numbers become `red`, `green`, `blue`, `alpha` (float64).
/// A single number becomes `colour_index`.
class RowColours {
public:
    enum class Bytes { whole, fractions };
    explicit RowColours(Bytes bytes = Bytes::whole) : fractions_(bytes == Bytes::fractions) {}

    /// Reads the rest of the cursor's row, except the last `leave` tokens, as the colour of the next row. The colour
    /// may be absent. Throws Error with the line for more than four numbers or a token that is not a number.
    void read_row(TextCursor& text, std::size_t leave = 0);

    /// Adds the columns for the rows that were read. `elements` names the rows in warnings ("vertices"). Warns if it
    /// adds no column because the rows differ, or if three or four numbers are not bytes.
    void add_columns(ColumnTable& columns, std::string_view elements,
                     const std::function<void(std::string)>& on_warning) const;

private:
    std::size_t rows_ = 0;
    std::size_t coloured_ = 0;
    std::size_t width_ = 0;  // number of channels of the first coloured row
    bool uniform_ = true;
    bool bytes_ = true;  // every number is whole, from 0 to 255, and written without a point
    bool fractions_;  // every number is a byte divided by 255
    Array<double> values_;
};

}  // namespace scanmill
