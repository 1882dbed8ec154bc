// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/comparison_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/tables.hpp"

namespace scanmill::runner {

namespace {

constexpr std::size_t most_rules = 8, most_changes = 10, most_reasons = 10, most_known = 5, most_scans = 20,
                      most_commands = 3;

std::string rest_text(const std::string& rest) { return rest.empty() ? "" : rest + "\n"; }

/// The table, with columns of names cut if it is wider than the terminal.
std::string table_text(const ReportTable& changes, const std::vector<std::string>& names,
                       std::optional<std::size_t> width) {
    Table table(changes.headers);
    for (const std::string& header : names) table.may_cut(header);
    for (const std::vector<std::string>& row : changes.rows) table.add(row);
    return table.text(width);
}

/// "failed  a.ply [fine, coarse]: the file ends too early"
std::string reason_text(const ReportTable& reasons) {
    std::string text;
    for (const std::vector<std::string>& row : reasons.rows)
        text += fmt::format("{:<9}  {} [{}]: {}\n", row[0], printable_line(row[1]), printable_line(row[2]),
                            printable_line(row[3]));
    return text;
}

/// Prints the matrix as several tables if it is wider than the terminal; each table has the column of scans.
std::string matrix_text(const ReportTable& matrix, std::optional<std::size_t> width) {
    const auto width_of = [&](std::size_t column) {
        std::size_t widest = columns_of(printable_line(matrix.headers[column]));
        for (const std::vector<std::string>& row : matrix.rows)
            widest = std::max(widest, columns_of(printable_line(row[column])));
        return widest;
    };
    constexpr std::size_t gap = 2, longest_scan = 40;
    const std::size_t scan_width = std::min(width_of(0), longest_scan);
    std::string text;
    for (std::size_t begin = 1, end = 1; begin < matrix.headers.size(); begin = end) {
        std::size_t total = scan_width;
        do total += gap + width_of(end++);
        while (end < matrix.headers.size() && (!width || total + gap + width_of(end) <= *width));
        const auto part_of = [&](const std::vector<std::string>& row) {
            std::vector<std::string> part{row[0]};
            part.insert(part.end(), row.begin() + static_cast<std::ptrdiff_t>(begin),
                        row.begin() + static_cast<std::ptrdiff_t>(end));
            return part;
        };
        Table table(part_of(matrix.headers));
        table.may_cut(matrix.headers[0]);
        for (std::size_t column = begin; column < end; ++column) table.may_cut(matrix.headers[column]);
        for (const std::vector<std::string>& row : matrix.rows) table.add(part_of(row));
        text += (text.empty() ? "" : "\n") + table.text(width);
    }
    return text;
}

}  // namespace

std::string comparison_text(const Comparison& comparison, const std::filesystem::path& folder,
                            const std::string& metric, std::optional<std::size_t> width) {
    std::string text = fmt::format("{}: {}\n{}\n{}\n\n", printable_line(comparison.batch), name_of(comparison.verdict),
                                   counts_text(comparison), printable_line(runs_text(comparison)));
    for (const auto& [name, fact] : facts_of(comparison))
        text += fmt::format("{:<7}  {}\n", name, printable_line(fact));
    if (!metric.empty()) {
        const ReportTable cells = matrix(comparison, metric, most_scans);
        return text + "\n" + matrix_text(cells, width) + rest_text(cells.rest);
    }
    const ReportTable rules = rule_table(comparison, most_rules);
    text += "\nBy rule and variant\n" + table_text(rules, {"variant", "metric"}, width) + rest_text(rules.rest);
    if (const ReportTable changes = change_table(comparison, most_changes); !changes.rows.empty())
        text += "\nWhat changed\n" + table_text(changes, {"scan", "variant", "what"}, width) + rest_text(changes.rest);
    if (const ReportTable reasons = reason_table(comparison, most_reasons); !reasons.rows.empty())
        text += "\nWhy\n" + reason_text(reasons) + rest_text(reasons.rest);
    if (const ReportTable known = known_table(comparison, most_known); !known.rows.empty())
        text += "\nKnown doubts\n" + table_text(known, {"scan", "variant", "why"}, width) + rest_text(known.rest);
    if (const std::vector<std::string> commands = commands_of(comparison); !commands.empty()) {
        text += "\nTo reproduce\n";
        for (std::size_t i = 0; i < std::min(commands.size(), most_commands); ++i) text += commands[i] + "\n";
        if (commands.size() > most_commands) text += fmt::format("and {} more\n", commands.size() - most_commands);
    }
    return text + fmt::format("\nFor every scan: scanmill report {} --metric NAME; for everything: --json\n",
                              shell_word(folder));
}

std::string verdict_text(const Comparison& comparison, const std::filesystem::path& folder) {
    constexpr std::size_t most_lines = 5;
    const ReportTable reasons = reason_table(comparison, most_lines);
    return fmt::format("\n{}: {}\n{}\n{}\n{}{}for details: scanmill report {}\n", printable_line(comparison.batch),
                       name_of(comparison.verdict), counts_text(comparison), printable_line(runs_text(comparison)),
                       reason_text(reasons), rest_text(reasons.rest), shell_word(folder));
}

}  // namespace scanmill::runner
