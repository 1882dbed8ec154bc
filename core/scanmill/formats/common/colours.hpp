// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Bytes of colour written as decimals from 0 to 1, a full channel being 1.
///
/// A decimal stands for the byte b when it is b / 255, rounded to its own digits behind the point, at least three of
/// them, or computed in single precision: 0.502, 0.50196 and 0.501960813999 are 128; 0.5 is no byte's.

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "scanmill/data/array.hpp"
#include "scanmill/data/columns.hpp"
#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// Pre: `value` is the number that `spelling` reads as.
std::optional<u8> byte_of_fraction(std::string_view spelling, double value);

/// For every byte its shortest decimal. Programs that cut the product with 255, in single precision or double, to a
/// whole number instead of rounding it find the same byte.
std::array<std::string, 256> colour_fractions();

// Collects the colours that a text format hangs behind its rows, one to four numbers each, into columns.
//
// Three or four numbers become `colour` (uint8) when every one is a byte: as `whole` numbers from 0 to 255, spelled
// without a point, or, where a format allows `fractions` as well, as bytes divided by 255 (see colour_fractions.hpp),
// which count first: 1 is then a full channel unless some number is larger. Others become `red`, `green`, `blue`,
// `alpha` (float64), a single one `colour_index`.

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
