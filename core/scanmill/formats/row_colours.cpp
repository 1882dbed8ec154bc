// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/row_colours.hpp"

#include <cmath>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/quantity.hpp"
#include "scanmill/formats/colour_fractions.hpp"
#include "scanmill/formats/reading.hpp"

namespace scanmill {

void RowColours::read_row(TextCursor& text, std::size_t leave) {
    constexpr std::size_t most = 4;
    ++rows_;
    std::size_t width = 0;
    for (; text.more() && (leave == 0 || text.count_tokens() > leave); ++width) {
        const std::string_view token = text.token();
        double value = 0;
        if (!parse_number(token, value))
            throw Error("line {}: {} is no number for a colour", text.line(), quote(token));
        if (width == most) throw Error("line {}: more than {} numbers for a colour", text.line(), most);
        // 1.0 is a full channel, 1 the faintest: the spelling decides.
        if (token.find_first_not_of("0123456789") != std::string_view::npos || value > 255) bytes_ = false;
        if (fractions_ && !byte_of_fraction(token, value)) fractions_ = false;
        values_.push_back(value);
    }
    if (width == 0) return;
    if (coloured_++ == 0) width_ = width;
    if (width != width_) uniform_ = false;
}

void RowColours::add_columns(ColumnTable& columns, std::string_view elements,
                             const std::function<void(std::string)>& on_warning) const {
    if (coloured_ == 0) return;
    if (!uniform_ || coloured_ != rows_ || width_ == 2)
        return warn(on_warning, "the colours of {} of {} {} were left out: not all have one of the same form",
                    coloured_, rows_, elements);
    if ((bytes_ || fractions_) && width_ >= 3) {
        const double full = fractions_ ? 255 : 1;
        Array<u8> colours(values_.size());
        for (std::size_t i = 0; i < colours.size(); ++i) colours[i] = static_cast<u8>(std::lround(values_[i] * full));
        columns.add(Column("colour", static_cast<u32>(width_), Buffer(std::move(colours))));
        return;
    }
    if (width_ >= 3)
        warn(on_warning, "the colours of the {} are no bytes; they are kept as columns of numbers: red, green, blue{}",
             elements, width_ == 4 ? ", alpha" : "");
    constexpr std::array<const char*, 4> channels{"red", "green", "blue", "alpha"};
    for (std::size_t channel = 0; channel < width_; ++channel) {
        Array<double> values(rows_);
        for (std::size_t row = 0; row < rows_; ++row) values[row] = values_[row * width_ + channel];
        columns.add(Column(width_ == 1 ? "colour_index" : channels[channel], 1, Buffer(std::move(values))));
    }
}

}  // namespace scanmill
