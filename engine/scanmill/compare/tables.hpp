// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A comparison as short texts and tables, which the formats for people arrange.

#include <string>
#include <utility>
#include <vector>

#include "scanmill/compare/comparison.hpp"

namespace scanmill {

struct ReportTable {
    std::vector<std::string> headers;
    std::vector<std::vector<std::string>> rows;
    std::string rest;  ///< "and 12 more": what the limit left out; empty: nothing
};

/// "12 cells: 1 failed, 2 regressed, 9 passed"
std::string counts_text(const Comparison& comparison);
/// "run 14 of 2026-11-23T02:00:11Z against run 9 of …, accepted by Ann: a new scanner"
std::string runs_text(const Comparison& comparison);
/// Name and text: `version`, `machine`, `gate`, `filters`, `note`; only existing ones.
std::vector<std::pair<std::string, std::string>> facts_of(const Comparison& comparison);

/// What changed, in the order of what_changed(). Changes that do not trip are left out where `most` rows do not
/// suffice.
ReportTable change_table(const Comparison& comparison, std::size_t most);

/// Cells that failed, are missing or doubtful, or regressed, with what differs in their files and steps, else with
/// their reasons. A reason that several variants of a scan share is given once.
ReportTable reason_table(const Comparison& comparison, std::size_t most);

/// Scans × variants for one metric; the unit is in the first header. A value is followed by `!` if it regressed
/// and by `?` if its cell is doubtful; a cell without the value shows its verdict. With more than `most` scans, those
/// whose cells did not pass come first.
ReportTable matrix(const Comparison& comparison, const std::string& metric, std::size_t most);

/// The commands that reproduce failed and regressed cells, equal ones once.
std::vector<std::string> commands_of(const Comparison& comparison);

}  // namespace scanmill
