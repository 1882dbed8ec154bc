// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/byte_size.hpp"

#include <array>
#include <cmath>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/quantity.hpp"

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

}  // namespace scanmill
