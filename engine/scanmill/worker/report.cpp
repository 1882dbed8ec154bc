// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/report.hpp"

#include <algorithm>

namespace scanmill {

std::string_view name_of(Outcome outcome) {
    switch (outcome) {
        case Outcome::done: return "done";
        case Outcome::failed: return "failed";
        case Outcome::skipped: return "skipped";
    }
    return "";
}

std::string_view name_of(Origin origin) {
    switch (origin) {
        case Origin::ran: return "ran";
        case Origin::cached: return "cached";
        case Origin::same_inputs: return "same inputs";
    }
    return "";
}

std::string_view name_of(Cause cause) {
    switch (cause) {
        case Cause::none: return "";
        case Cause::refused: return "refused";
        case Cause::expectation: return "expectation";
        case Cause::exception: return "exception";
        case Cause::memory: return "memory";
        case Cause::time: return "time";
        case Cause::signal: return "signal";
        case Cause::exit: return "exit";
        case Cause::output: return "output";
    }
    return "";
}

bool RunReport::all_done() const {
    return std::ranges::all_of(cells, [](const CellReport& cell) { return cell.outcome == Outcome::done; });
}

}  // namespace scanmill
