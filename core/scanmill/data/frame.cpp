// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/frame.hpp"

#include <array>
#include <cassert>
#include <cstdint>
#include <numeric>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {
struct UnitRow {
    std::string_view symbol;
    std::int64_t micrometres;  // integers, so that ratios of units are exact
};
/// Indexed by LengthUnit.
constexpr std::array<UnitRow, 7> units{
    {{"u", 0}, {"um", 1}, {"mm", 1'000}, {"cm", 10'000}, {"m", 1'000'000}, {"in", 25'400}, {"ft", 304'800}}};

const UnitRow& row_of(LengthUnit unit) { return units[static_cast<std::size_t>(unit)]; }

}  // namespace

std::string_view symbol(LengthUnit unit) { return row_of(unit).symbol; }

std::optional<LengthUnit> length_unit(std::string_view symbol) {
    for (std::size_t i = 1; i < units.size(); ++i)
        if (units[i].symbol == symbol) return static_cast<LengthUnit>(i);
    return std::nullopt;
}

std::string_view length_unit_symbols() { return "um, mm, cm, m, in, ft"; }

double in_unit(double length, LengthUnit from, LengthUnit to) {
    assert(from != LengthUnit::unknown && to != LengthUnit::unknown);
    const std::int64_t numerator = row_of(from).micrometres, denominator = row_of(to).micrometres;
    const std::int64_t common = std::gcd(numerator, denominator);
    return length * static_cast<double>(numerator / common) / static_cast<double>(denominator / common);
}

void require_same_frame(const Frame& first, std::string_view one, const Frame& second, std::string_view other) {
    if (first.unit != second.unit)
        throw Error("{} in {}, {} in {}; both need one unit", one, symbol(first.unit), other, symbol(second.unit))
            .hint("convert one of them with `scanmill convert`; u means that the unit is not declared");
    if (!first.name.empty() && !second.name.empty() && first.name != second.name)
        throw Error("{} in the frame '{}', {} in '{}'; both need one frame", one, first.name, other, second.name)
            .hint("move one of them into the other's frame, or give both files one frame name")
            .remedy(Remedy::move_to_frame);
}

}  // namespace scanmill
