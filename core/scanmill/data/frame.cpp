// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/frame.hpp"

#include <array>
#include <cassert>
#include <cstdint>
#include <numeric>

namespace scanmill {

namespace {
struct UnitRow {
    LengthUnit unit;
    std::string_view symbol;
    std::int64_t micrometres;  // whole numbers, so that ratios of units are exact
};
constexpr std::array<UnitRow, 7> units{{
    {LengthUnit::unknown, "u", 0},
    {LengthUnit::micrometre, "um", 1},
    {LengthUnit::millimetre, "mm", 1'000},
    {LengthUnit::centimetre, "cm", 10'000},
    {LengthUnit::metre, "m", 1'000'000},
    {LengthUnit::inch, "in", 25'400},
    {LengthUnit::foot, "ft", 304'800},
}};

std::int64_t micrometres(LengthUnit unit) { return units[static_cast<std::size_t>(unit)].micrometres; }

}  // namespace

std::string_view symbol(LengthUnit unit) { return units[static_cast<std::size_t>(unit)].symbol; }

std::optional<LengthUnit> length_unit(std::string_view symbol) {
    for (const UnitRow& row : units)
        if (row.symbol == symbol && row.unit != LengthUnit::unknown) return row.unit;
    return std::nullopt;
}

std::string_view length_unit_symbols() { return "um, mm, cm, m, in, ft"; }

double in_unit(double length, LengthUnit from, LengthUnit to) {
    assert(from != LengthUnit::unknown && to != LengthUnit::unknown);
    const std::int64_t numerator = micrometres(from), denominator = micrometres(to);
    const std::int64_t common = std::gcd(numerator, denominator);
    return length * static_cast<double>(numerator / common) / static_cast<double>(denominator / common);
}

}  // namespace scanmill
