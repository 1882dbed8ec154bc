// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/sizes.hpp"

#include <array>
#include <cassert>
#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

struct SizeUnit {
    std::string_view symbol;
    double bytes;
};
// In the order in which they are tried as suffixes; a number without a unit is in bytes.
constexpr std::array<SizeUnit, 10> units{{{"TiB", 0x1p40},
                                          {"GiB", 0x1p30},
                                          {"MiB", 0x1p20},
                                          {"KiB", 0x1p10},
                                          {"TB", 1e12},
                                          {"GB", 1e9},
                                          {"MB", 1e6},
                                          {"kB", 1e3},
                                          {"B", 1},
                                          {"", 1}}};

struct TimeUnit {
    std::string_view symbol;
    double units_per_second, seconds;  // one of the two is 1, so that whole numbers stay whole
};
// In the order in which they are tried as suffixes: `ms` before `s`.
constexpr std::array<TimeUnit, 4> time_units{{{"ms", 1000, 1}, {"min", 1, 60}, {"h", 1, 3600}, {"s", 1, 1}}};

/// The number before a unit, with or without blanks between them; empty for other texts.
std::optional<double> amount_before(std::string_view unit, std::string_view text) {
    if (!text.ends_with(unit)) return std::nullopt;
    text.remove_suffix(unit.size());
    while (text.ends_with(' ')) text.remove_suffix(1);
    double amount = 0;
    return parse_number(text, amount) ? std::optional(amount) : std::nullopt;
}

}  // namespace

u64 parse_byte_size(std::string_view text) {
    constexpr double most = 0x1p62;
    for (const SizeUnit& unit : units)
        if (const auto amount = amount_before(unit.symbol, text);
            amount && *amount >= 0 && *amount * unit.bytes <= most)
            return static_cast<u64>(std::llround(*amount * unit.bytes));
    throw Error("'{}' is not a size", text).expected("500 MiB, 20 GiB, 1.5 GB or a number of bytes");
}

double parse_duration(std::string_view text) {
    constexpr std::string_view examples = "500 ms, 30 s, 10 min or 2 h";
    for (const TimeUnit& unit : time_units)
        if (const auto amount = amount_before(unit.symbol, text)) {
            const double seconds = *amount * unit.seconds / unit.units_per_second;
            if (seconds >= 0 && std::isfinite(seconds)) return seconds;
        }
    double bare = 0;
    if (parse_number(text, bare) && std::isfinite(bare)) throw Error("'{}' has no unit", text).expected(examples);
    throw Error("'{}' is not a time", text).expected(examples);
}

std::string duration_text(double seconds) {
    if (seconds >= 3600) return number_text(seconds / 3600) + " h";
    if (seconds >= 60) return number_text(seconds / 60) + " min";
    if (seconds >= 1 || seconds == 0) return number_text(seconds) + " s";
    return number_text(seconds * 1000) + " ms";
}

namespace {

/// The text before the exponent; nothing if the text does not end in a unit and an exponent.
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
    if (parse_number(text, bare)) throw Error("'{}' has no unit", text).expected(length_power_examples(power));
    if (const auto length = without_exponent(text, power)) return Length::parse(*length);
    throw Error("'{}' is not {}", text, power == 2 ? "an area" : "a volume").expected(length_power_examples(power));
}

bool is_absolute(const Length& length) {
    return length.in() != Length::In::scan_unit && length.in() != Length::In::percent_of_diagonal &&
           length.in() != Length::In::spacing;
}

double resolved_length_power(const Length& written, int power, const LengthScale& scale) {
    // Resolve the unit without the amount, because the amount may be 0 or negative.
    if (scale.unit == LengthUnit::unknown && is_absolute(written))
        throw Error("{}{} needs a scan of known unit; this scan's unit is not declared", written.text(), power)
            .hint(fmt::format("declare it with `inputs: {{scan: {{kind: points, unit: mm}}}}` in the workflow, or "
                              "write the value in the scan's own unit, as 0.5 u{}",
                              power))
            .remedy(Remedy::declare_unit);
    const double unit = Length(1, written.in()).resolved(scale).value();
    return written.amount() * (power == 2 ? unit * unit : unit * unit * unit);
}

std::string_view length_power_examples(int power) {
    return power == 2 ? "12 mm2, 0.5 u2 or 20 spacing2" : "12 mm3, 0.5 u3 or 20 spacing3";
}

}  // namespace scanmill
