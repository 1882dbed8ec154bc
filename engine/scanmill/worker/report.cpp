// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/report.hpp"

#include <algorithm>
#include <array>

namespace scanmill {

namespace {

template <std::size_t size, class Enum>
std::string_view nth(const std::array<std::string_view, size>& names, Enum value) {
    return names.at(static_cast<std::size_t>(value));
}

}  // namespace

std::string_view name_of(Outcome outcome) {
    return nth(std::array<std::string_view, 3>{"done", "failed", "skipped"}, outcome);
}

std::string_view name_of(Origin origin) {
    return nth(std::array<std::string_view, 3>{"ran", "cached", "same inputs"}, origin);
}

std::string_view name_of(Cause cause) {
    return nth(std::array<std::string_view, 9>{"", "refused", "expectation", "exception", "memory", "time", "signal",
                                               "exit", "output"},
               cause);
}

Error Failure::whole() const {
    Error all = error;
    if (!equal_scan.empty())
        all.add_frame(fmt::format("on scan '{}', which equals '{}'", scan, equal_scan));
    else if (!scan.empty())
        all.add_frame(fmt::format("on scan '{}'", scan));
    return all;
}

bool RunReport::all_done() const {
    return std::ranges::all_of(cells, [](const CellReport& cell) { return cell.outcome == Outcome::done; });
}

}  // namespace scanmill
