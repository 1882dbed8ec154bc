// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/frame.hpp"

#include <array>
#include <cassert>

namespace scanmill {

namespace {
struct UnitRow {
    LengthUnit unit;
    std::string_view symbol;
    double metres;
};
constexpr std::array<UnitRow, 7> units{{
    {LengthUnit::unknown, "u", 0},
    {LengthUnit::micrometre, "um", 1e-6},
    {LengthUnit::millimetre, "mm", 1e-3},
    {LengthUnit::centimetre, "cm", 1e-2},
    {LengthUnit::metre, "m", 1},
    {LengthUnit::inch, "in", 0.0254},
    {LengthUnit::foot, "ft", 0.3048},
}};
}  // namespace

std::string_view symbol(LengthUnit unit) { return units[static_cast<std::size_t>(unit)].symbol; }

std::optional<LengthUnit> length_unit(std::string_view symbol) {
    for (const UnitRow& row : units)
        if (row.symbol == symbol && row.unit != LengthUnit::unknown) return row.unit;
    return std::nullopt;
}

std::string_view length_unit_symbols() { return "um, mm, cm, m, in, ft"; }

double metres(LengthUnit unit) {
    assert(unit != LengthUnit::unknown);
    return units[static_cast<std::size_t>(unit)].metres;
}

}  // namespace scanmill
