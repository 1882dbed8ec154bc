// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Writes comparisons in formats for other programs. Names may contain any bytes; each format escapes them.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scanmill/compare/comparison.hpp"

namespace scanmill {

/// The whole comparison as {"scanmill": 1, "report": {…}}; see schemas/output/report.schema.json. Numbers are in the
/// units of the records: radians, fractions, bytes, and the cell's unit of lengths.
nlohmann::ordered_json report_json(const Comparison& comparison);

/// The comparison as JUnit XML, valid under the schemas of Ant and of Jenkins. A workflow is a suite. A cell is a test
/// case, with the scan as its name and the variant in its class. A regressed or missing cell is a failure. A failed
/// cell is an error. A doubtful cell is a failure if `strict`. If not, it passes, and its doubts are in the suite's
/// output.
std::string junit_xml(const Comparison& comparison, bool strict);

/// The comparison in GitHub's Markdown, for a comment on a pull request. The matrix shows `metric`.
std::string markdown(const Comparison& comparison, const std::string& metric);

/// The header line of a CSV file (RFC 4180).
std::string csv_header();
/// The CSV rows of a run: one row for every metric, property and cost of every cell.
std::string csv_rows(const RunDetails& run);

}  // namespace scanmill
