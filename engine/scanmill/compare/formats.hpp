// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Comparisons in the forms that other programs read. Names may contain any bytes; each form escapes them.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scanmill/compare/comparison.hpp"

namespace scanmill {

/// {"scanmill": 1, "report": {…}}: everything; schemas/output/report.schema.json describes it. Numbers are in the units
/// of the records: radians, fractions, bytes, the cell's unit of lengths.
nlohmann::ordered_json report_json(const Comparison& comparison);

/// JUnit XML, valid by the schemas of Ant and of Jenkins: a suite per workflow, a test case per cell with the scan as
/// its name and the variant in its class. A regressed or missing cell is a failure, a failed one an error; with
/// `strict` a doubtful one is a failure, else it passes and its doubts are in the suite's output.
std::string junit_xml(const Comparison& comparison, bool strict);

/// GitHub's Markdown, for a comment on a pull request. `metric`: shown in the matrix.
std::string markdown(const Comparison& comparison, const std::string& metric);

/// RFC 4180 with a header: every metric, property and cost of every cell, a row each.
std::string csv_header();
std::string csv_rows(const RunDetails& run);

}  // namespace scanmill
