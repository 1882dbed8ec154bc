// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a comparison as JUnit XML. Ant's schema is the strictest, so elements and attributes are in its order,
// `testsuites` has no attributes, and a time stamp has no time zone.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "scanmill/compare/formats.hpp"
#include "scanmill/compare/tables.hpp"
#include "scanmill/compare/utf8.hpp"

namespace scanmill {

namespace {

/// Escapes text for elements and attributes. XML 1.0 does not allow control characters, not even escaped, so they are
/// written as "\x1b".
std::string escaped(std::string_view text) {
    std::string xml;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        const char c = text.front();
        if (length == 0)
            xml += "\uFFFD";
        else if (c == '&')
            xml += "&amp;";
        else if (c == '<')
            xml += "&lt;";
        else if (c == '>')
            xml += "&gt;";
        else if (c == '"')
            xml += "&quot;";
        else if (c == '\n' || c == '\t')
            xml += fmt::format("&#{};", static_cast<int>(c));
        else if (length == 1 && (static_cast<unsigned char>(c) < ' ' || c == 0x7f))
            xml += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        else
            xml += text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(1, length));
    }
    return xml;
}

enum class Result { passes, failure, error };

Result result_of(const CellComparison& cell, bool strict) {
    switch (cell.verdict) {
        case Verdict::failed: return Result::error;
        case Verdict::missing:
        case Verdict::regressed: return Result::failure;
        case Verdict::doubtful: return strict ? Result::failure : Result::passes;
        default: return Result::passes;
    }
}

std::string test_case(const CellComparison& cell, bool strict) {
    const Result result = result_of(cell, strict);
    const std::string begin = fmt::format(R"(    <testcase name="{}" classname="{}" time="{:.3f}")", escaped(cell.scan),
                                          escaped(cell.workflow + "." + cell.variant), cell.seconds);
    if (result == Result::passes) return begin + "/>\n";
    std::vector<std::string> lines = cell.reasons;
    lines.insert(lines.end(), cell.causes.begin(), cell.causes.end());
    if (!cell.command.empty()) lines.push_back("reproduce: " + cell.command);
    const std::string_view element = result == Result::error ? "error" : "failure";
    return fmt::format("{}>\n      <{} message=\"{}\" type=\"{}\">{}</{}>\n    </testcase>\n", begin, element,
                       escaped(cell.reasons.empty() ? "" : cell.reasons.front()), name_of(cell.verdict),
                       escaped(fmt::format("{}", fmt::join(lines, "\n"))), element);
}

/// "2026-11-23T02:00:11Z" without its zone.
std::string time_stamp(const std::string& started) {
    return started.size() >= 19 ? started.substr(0, 19) : "1970-01-01T00:00:00";
}

std::string suite(const Comparison& comparison, const std::string& workflow, std::size_t id, bool strict) {
    std::string cases, doubts;
    std::size_t tests = 0, failures = 0, errors = 0;
    double seconds = 0;
    for (const CellComparison& cell : comparison.cells) {
        if (cell.workflow != workflow) continue;
        ++tests;
        failures += result_of(cell, strict) == Result::failure;
        errors += result_of(cell, strict) == Result::error;
        seconds += cell.seconds;
        cases += test_case(cell, strict);
        if (cell.verdict == Verdict::doubtful)
            doubts += fmt::format("{} [{}] is doubtful: {}\n", cell.scan, cell.variant, fmt::join(cell.reasons, "; "));
    }
    std::string xml = fmt::format(
        R"(  <testsuite id="{}" package="{}" name="{}" timestamp="{}" hostname="localhost" tests="{}" failures="{}" )"
        R"(errors="{}" time="{:.3f}">)"
        "\n    <properties>\n",
        id, escaped(comparison.batch), escaped(workflow.empty() ? "workflow" : workflow),
        time_stamp(comparison.run.started), tests, failures, errors, seconds);
    const auto add_property = [&](std::string_view name, const std::string& value) {
        xml += fmt::format("      <property name=\"{}\" value=\"{}\"/>\n", name, escaped(value));
    };
    add_property("verdict", std::string(name_of(comparison.verdict)));
    add_property("runs", runs_text(comparison));
    for (const auto& [name, text] : facts_of(comparison)) add_property(name, text);
    return xml +
           fmt::format("    </properties>\n{}    <system-out>{}</system-out>\n    <system-err/>\n  </testsuite>\n",
                       cases, escaped(doubts));
}

}  // namespace

std::string junit_xml(const Comparison& comparison, bool strict) {
    std::vector<std::string> workflows;
    for (const CellComparison& cell : comparison.cells)
        if (std::ranges::find(workflows, cell.workflow) == workflows.end()) workflows.push_back(cell.workflow);
    std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
    for (std::size_t id = 0; id < workflows.size(); ++id) xml += suite(comparison, workflows[id], id, strict);
    return xml + "</testsuites>\n";
}

}  // namespace scanmill
