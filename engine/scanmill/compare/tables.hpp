// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Short texts and tables that describe a comparison. The formats for people are composed of them.

#include <string>
#include <utility>
#include <vector>

#include "scanmill/compare/comparison.hpp"

namespace scanmill {

struct ReportTable {
    std::vector<std::string> headers;
    std::vector<std::vector<std::string>> rows;
    std::string rest;  ///< "and 12 more", if the limit left out rows; empty otherwise
};

/// "mm", "u²": the unit that display() writes after the metric's number; empty for a metric that is not a length, an
/// area or a volume.
std::string length_unit_text(const Metric& metric, LengthUnit lengths);

/// "12 cells: 1 failed, 2 regressed, 9 passed"
std::string counts_text(const Comparison& comparison);
/// "run 14 of 2026-11-23T02:00:11Z against run 9 of …, accepted by Ann: a new scanner"
std::string runs_text(const Comparison& comparison);
/// Names and texts of properties of the comparison. The names are `version`, `machine`, `gate`, `filters` and `note`;
/// properties without a text are left out.
std::vector<std::pair<std::string, std::string>> facts_of(const Comparison& comparison);

/// A table with a row per rule of the gate and variant: the number of cells that have the value, its median, the median
/// change against the accepted run, and the number of regressions. Without rules, the rows are for default_metric().
/// Cells without an accepted value do not count in the median change. The table has at most `most` rows; if that is too
/// few, one row per rule is for all variants.
ReportTable rule_table(const Comparison& comparison, std::size_t most);

/// A table of the changes in the order of what_changed(), regressions first. It has at most `most` rows.
ReportTable change_table(const Comparison& comparison, std::size_t most);

/// A table of the cells that failed, are missing, regressed or are doubtful. It shows their reasons, and the
/// differences in their files and steps. For a regressed cell with such differences, it omits the reasons, which
/// change_table() shows. Variants of a scan with the same text share a row. The table has at most `most` rows.
ReportTable reason_table(const Comparison& comparison, std::size_t most);

/// A table of the cells whose doubts are all acknowledged: scan, variant, who, when and why. It has at most `most`
/// rows.
ReportTable known_table(const Comparison& comparison, std::size_t most);

/// A table of one metric with a row per scan and a column per variant, or with a row per variant if there is only one
/// scan; the unit is in the first header. A value is followed by `!` if it regressed, and by `?` if its cell is
/// doubtful. If a cell that did not pass lacks the value, the table shows the verdict. The table has at most `most`
/// rows, and rows with such cells come first.
ReportTable matrix(const Comparison& comparison, const std::string& metric, std::size_t most);

/// The commands that reproduce regressed and failed cells. Equal commands appear once.
std::vector<std::string> commands_of(const Comparison& comparison);

}  // namespace scanmill
