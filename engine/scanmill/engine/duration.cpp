// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/duration.hpp"

#include <array>
#include <cmath>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/quantity.hpp"

namespace scanmill {

namespace {

struct TimeUnit {
    std::string_view symbol;
    double units_per_second, seconds;  // one of them is 1, so that whole numbers stay whole
};
// In the order in which a text's end is compared: `ms` before `s`.
constexpr std::array<TimeUnit, 4> units{{{"ms", 1000, 1}, {"min", 1, 60}, {"h", 1, 3600}, {"s", 1, 1}}};

}  // namespace

double parse_duration(std::string_view text) {
    constexpr std::string_view expected = "expected 500 ms, 30 s, 10 min or 2 h";
    for (const TimeUnit& unit : units) {
        if (!text.ends_with(unit.symbol)) continue;
        std::string_view number = text;
        number.remove_suffix(unit.symbol.size());
        while (number.ends_with(' ')) number.remove_suffix(1);
        double amount = 0;
        if (!parse_number(number, amount)) break;
        const double seconds = amount * unit.seconds / unit.units_per_second;
        if (!(seconds >= 0) || !std::isfinite(seconds)) break;
        return seconds;
    }
    double bare = 0;
    if (parse_number(text, bare) && std::isfinite(bare)) throw Error("'{}' has no unit; {}", text, expected);
    throw Error("'{}' is no time; {}", text, expected);
}

std::string duration_text(double seconds) {
    if (seconds >= 3600) return number_text(seconds / 3600) + " h";
    if (seconds >= 60) return number_text(seconds / 60) + " min";
    if (seconds >= 1 || seconds == 0) return number_text(seconds) + " s";
    return number_text(seconds * 1000) + " ms";
}

}  // namespace scanmill
