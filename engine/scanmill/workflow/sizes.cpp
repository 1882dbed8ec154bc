// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/sizes.hpp"

#include <array>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill {

namespace {

struct SizeUnit {
    std::string_view symbol;
    double bytes;
};
constexpr std::array<SizeUnit, 9> units{{{"TiB", 0x1p40},
                                         {"GiB", 0x1p30},
                                         {"MiB", 0x1p20},
                                         {"KiB", 0x1p10},
                                         {"TB", 1e12},
                                         {"GB", 1e9},
                                         {"MB", 1e6},
                                         {"kB", 1e3},
                                         {"B", 1}}};

}  // namespace

u64 parse_byte_size(std::string_view text) {
    std::string_view number = text;
    double unit = 1;
    for (const SizeUnit& candidate : units)
        if (number.ends_with(candidate.symbol)) {
            number.remove_suffix(candidate.symbol.size());
            unit = candidate.bytes;
            break;
        }
    while (number.ends_with(' ')) number.remove_suffix(1);
    double amount = 0;
    constexpr double most = 0x1p62;
    if (!parse_number(number, amount) || !(amount >= 0) || !(amount * unit <= most))
        throw Error("'{}' is no size; expected 500 MiB, 20 GiB, 1.5 GB or a number of bytes", text);
    return static_cast<u64>(std::llround(amount * unit));
}

std::string byte_size_text(u64 bytes) {
    for (const SizeUnit& unit : std::span(units).first(4))
        if (static_cast<double>(bytes) >= unit.bytes) {
            const double amount = static_cast<double>(bytes) / unit.bytes;
            return fmt::format("{:.{}f} {}", amount, amount < 10 ? 2 : amount < 100 ? 1 : 0, unit.symbol);
        }
    return fmt::format("{} B", bytes);
}

namespace {

struct TimeUnit {
    std::string_view symbol;
    double units_per_second, seconds;  // one of them is 1, so that whole numbers stay whole
};
// In the order in which a text's end is compared: `ms` before `s`.
constexpr std::array<TimeUnit, 4> time_units{{{"ms", 1000, 1}, {"min", 1, 60}, {"h", 1, 3600}, {"s", 1, 1}}};

}  // namespace

double parse_duration(std::string_view text) {
    constexpr std::string_view expected = "expected 500 ms, 30 s, 10 min or 2 h";
    for (const TimeUnit& unit : time_units) {
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
