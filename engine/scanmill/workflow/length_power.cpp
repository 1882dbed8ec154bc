// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/length_power.hpp"

#include <array>
#include <cassert>
#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

std::string_view name_of_power(int power) { return power == 2 ? "area" : "volume"; }

/// The text before the exponent; nothing when it does not end in one that follows a unit.
std::optional<std::string_view> without_exponent(std::string_view text, int power) {
    const auto exponents =
        power == 2 ? std::array<std::string_view, 3>{"^2", "²", "2"} : std::array<std::string_view, 3>{"^3", "³", "3"};
    for (std::string_view exponent : exponents) {
        if (!text.ends_with(exponent)) continue;
        const std::string_view before = text.substr(0, text.size() - exponent.size());
        const char last = before.empty() ? ' ' : before.back();
        if (last >= 'a' && last <= 'z') return before;
    }
    return std::nullopt;
}

}  // namespace

int power_of_length(Unit unit) {
    return unit == Unit::length ? 1 : unit == Unit::area ? 2 : unit == Unit::volume ? 3 : 0;
}

Length parse_length_power(std::string_view text, int power) {
    assert(power == 2 || power == 3);
    double bare = 0;
    if (parse_number(text, bare)) throw Error("'{}' has no unit; expected {}", text, length_power_examples(power));
    if (const auto length = without_exponent(text, power)) return Length::parse(*length);
    throw Error("'{}' is not {} {}; expected {}", text, power == 2 ? "an" : "a", name_of_power(power),
                length_power_examples(power));
}

bool is_absolute(const Length& length) {
    return length.in() != Length::In::scan_unit && length.in() != Length::In::percent_of_diagonal &&
           length.in() != Length::In::spacing;
}

double resolved_length_power(const Length& written, int power, const LengthScale& scale) {
    // The unit is resolved, not the amount, which may be 0 or below it.
    if (scale.unit == LengthUnit::unknown && is_absolute(written))
        throw Error("{}{} needs a scan of known unit; this scan's unit is not declared", written.text(), power)
            .hint(fmt::format("declare it with `inputs: {{scan: {{kind: points, unit: mm}}}}` in the workflow, or "
                              "write the value in the scan's own unit, as 0.5 u{}",
                              power))
            .remedy(Remedy::declare_unit);
    const double unit = Length(1, written.in()).resolved(scale).value();
    return written.amount() * std::pow(unit, power);
}

std::string_view length_power_examples(int power) {
    return power == 2 ? "12 mm2, 0.5 u2 or 20 spacing2" : "12 mm3, 0.5 u3 or 20 spacing3";
}

}  // namespace scanmill
