// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/colour_fractions.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

namespace scanmill {

namespace {

constexpr double full = 255;

/// Digits behind the point; none when there is an exponent, which no one writes into a colour by hand.
std::size_t digits_behind_point(std::string_view spelling) {
    const std::size_t point = spelling.find('.');
    if (point == std::string_view::npos || spelling.find_first_of("eE") != std::string_view::npos) return 0;
    return spelling.size() - point - 1;
}

bool cuts_to(double value, u8 byte) {
    return static_cast<int>(value * full) == byte &&
           static_cast<int>(static_cast<float>(value) * static_cast<float>(full)) == byte;
}

std::string shortest_fraction(u8 byte) {
    constexpr int most_digits = 9;
    double scale = 1;
    for (int digits = 0; digits <= most_digits; ++digits, scale *= 10) {
        const double below = std::floor(byte * scale / full);
        for (const double numerator : {below, below + 1}) {
            const double value = numerator / scale;
            const std::string spelling = fmt::format("{:.{}f}", value, digits);
            if (byte_of_fraction(spelling, value) == byte && cuts_to(value, byte)) return spelling;
        }
    }
    assert(!"one of so many digits is near enough and not below");
    return {};
}

}  // namespace

std::optional<u8> byte_of_fraction(std::string_view spelling, double value) {
    if (!(value >= 0 && value <= 1)) return std::nullopt;
    constexpr double single_precision = 0x1p-23;  // a rounded reciprocal, times the byte, rounded
    const double byte = std::round(value * full);
    const double error = std::abs(value - byte / full);
    if (error > single_precision) {
        constexpr std::size_t least_digits = 3;
        const std::size_t digits = digits_behind_point(spelling);
        if (digits < least_digits) return std::nullopt;
        if (error > 0.5 * std::pow(10.0, -static_cast<double>(digits)) + single_precision) return std::nullopt;
    }
    return static_cast<u8>(byte);
}

std::array<std::string, 256> colour_fractions() {
    std::array<std::string, 256> table;
    for (std::size_t byte = 0; byte < table.size(); ++byte) table[byte] = shortest_fraction(static_cast<u8>(byte));
    return table;
}

}  // namespace scanmill
