// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/colours.hpp"

#include <cassert>

namespace scanmill {

namespace {

constexpr double full = 255;

/// Digits after the point; 0 for numbers with an exponent, which colours do not have.
std::size_t digits_after_point(std::string_view spelling) {
    const std::size_t point = spelling.find('.');
    if (point == std::string_view::npos || spelling.find_first_of("eE") != std::string_view::npos) return 0;
    return spelling.size() - point - 1;
}

std::string shortest_fraction(u8 byte) {
    constexpr int most_digits = 9;
    double scale = 1;
    for (int digits = 0; digits <= most_digits; ++digits, scale *= 10) {
        const double below = std::floor(byte * scale / full);
        for (const double numerator : {below, below + 1}) {
            const double value = numerator / scale;
            const std::string spelling = fmt::format("{:.{}f}", value, digits);
            const bool is_truncated_alike =
                static_cast<int>(value * full) == byte &&
                static_cast<int>(static_cast<float>(value) * static_cast<float>(full)) == byte;
            if (is_truncated_alike && byte_of_fraction(spelling, value) == byte) return spelling;
        }
    }
    assert(!"a decimal of nine digits is exact enough");
    return {};
}

}  // namespace

std::optional<u8> byte_of_fraction(std::string_view spelling, double value) {
    if (!(value >= 0 && value <= 1)) return std::nullopt;
    constexpr double single_precision = 0x1p-23;  // error of byte * (1 / 255) with both steps rounded
    const double byte = std::round(value * full);
    const double error = std::abs(value - byte / full);
    if (error > single_precision) {
        constexpr std::size_t least_digits = 3;
        const std::size_t digits = digits_after_point(spelling);
        if (digits < least_digits) return std::nullopt;
        double scale = 1;  // exact up to 22 digits
        for (std::size_t i = 0; i < digits; ++i) scale *= 10;
        if (error > 0.5 / scale + single_precision) return std::nullopt;
    }
    return static_cast<u8>(byte);
}

std::array<std::string, 256> colour_fractions() {
    std::array<std::string, 256> table;
    for (std::size_t byte = 0; byte < table.size(); ++byte) table[byte] = shortest_fraction(static_cast<u8>(byte));
    return table;
}

void RowColours::read_row(TextCursor& text, std::size_t leave) {
    constexpr std::size_t most = 4;
    ++rows_;
    std::size_t width = 0;
    for (; text.more() && (leave == 0 || text.count_tokens() > leave); ++width) {
        const std::string_view token = text.token();
        double value = 0;
        if (!parse_number(token, value))
            throw Error("line {}: {} is not a number for a colour", text.line(), quote(token));
        if (width == most) throw Error("line {}: more than {} numbers for a colour", text.line(), most);
        // The spelling decides: 1.0 is a full channel, 1 may be the byte 1.
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
        return warn(on_warning,
                    "the colours of {} of {} {} were left out: all need the same number of channels, 1, 3 or 4",
                    coloured_, rows_, elements);
    if ((bytes_ || fractions_) && width_ >= 3) {
        const double full = fractions_ ? 255 : 1;
        Array<u8> colours(values_.size());
        for (std::size_t i = 0; i < colours.size(); ++i) colours[i] = static_cast<u8>(std::lround(values_[i] * full));
        columns.add(Column("colour", static_cast<u32>(width_), Buffer(std::move(colours))));
        return;
    }
    if (width_ >= 3)
        warn(on_warning, "the colours of the {} are not bytes; they are kept as columns of numbers: red, green, blue{}",
             elements, width_ == 4 ? ", alpha" : "");
    constexpr std::array<const char*, 4> channels{"red", "green", "blue", "alpha"};
    for (std::size_t channel = 0; channel < width_; ++channel) {
        Array<double> values(rows_);
        for (std::size_t row = 0; row < rows_; ++row) values[row] = values_[row * width_ + channel];
        columns.add(Column(width_ == 1 ? "colour_index" : channels[channel], 1, Buffer(std::move(values))));
    }
}

}  // namespace scanmill
