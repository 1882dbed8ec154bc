// SPDX-License-Identifier: GPL-3.0-or-later
// Writes CSV by RFC 4180. Fields that contain a comma, a quote or a line end are quoted, and quotes in them are
// doubled. Records end with CR LF.
#include <array>

#include "scanmill/base/text.hpp"
#include "scanmill/compare/formats.hpp"

namespace scanmill {

namespace {

std::string field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

template <class Fields>
std::string record(const Fields& fields) {
    std::string line;
    for (const std::string& text : fields) line += (line.empty() ? "" : ",") + field(text);
    return line + "\r\n";
}

std::string unit_text(const CellValue& value) {
    const std::string lengths(symbol(value.lengths));
    switch (value.metric.unit) {
        case Unit::length: return lengths;
        case Unit::area: return lengths + "2";
        case Unit::volume: return lengths + "3";
        case Unit::angle: return "rad";
        case Unit::seconds: return "s";
        default: return std::string(name_of(value.metric.unit));
    }
}

}  // namespace

std::string csv_header() {
    return record(std::array<std::string, 10>{"run", "started", "workflow", "scan", "variant", "outcome", "source",
                                              "metric", "value", "unit"});
}

std::string csv_rows(const RunDetails& run) {
    std::string text;
    const Comparison alone = compare(run, nullptr);
    for (const CellComparison& cell : alone.cells) {
        const std::size_t begin = text.size();
        const auto add = [&](const std::string& source, const std::string& metric, const std::string& value,
                             const std::string& unit) {
            text +=
                record(std::array<std::string, 10>{std::to_string(run.summary.id), run.summary.started, cell.workflow,
                                                   cell.scan, cell.variant, cell.outcome, source, metric, value, unit});
        };
        for (const CellValue& value : cell.values)
            add(value.source, value.metric.name, number_text(value.metric.value), unit_text(value));
        for (const std::string cost : {"seconds", "cpu-seconds", "memory"})
            if (const auto value = number_of(cell, cost))
                add("", cost, number_text(value->metric.value), cost == "memory" ? "bytes" : "s");
        if (text.size() == begin) add("", "", "", "");  // a cell without numbers gets one row, too
    }
    return text;
}

}  // namespace scanmill
