// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a comparison in GitHub's Markdown.
#include <fmt/format.h>

#include <algorithm>

#include "scanmill/compare/formats.hpp"
#include "scanmill/compare/tables.hpp"
#include "scanmill/compare/utf8.hpp"

namespace scanmill {

namespace {

constexpr std::size_t most_rows = 20;

/// Escapes text so that Markdown shows it literally and on one line. Nothing in it acts as markup, as a tag, as a
/// mention of a user or an issue, or as the end of a table cell.
std::string plain(std::string_view text) {
    std::string markdown;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        const char c = text.front();
        if (c == '<')
            markdown += "&lt;";
        else if (c == '&')
            markdown += "&amp;";
        else if (c == '@' || c == '#')
            markdown += fmt::format("&#{};", static_cast<int>(c));
        else if (std::string_view("\\`*_{}[]()>|~!$").find(c) != std::string_view::npos)
            markdown += fmt::format("\\{}", c);
        else if (c == '\n')
            markdown += "↵";
        else if (length == 0 || is_control(c))
            markdown += "\uFFFD";
        else
            markdown += text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(1, length));
    }
    return markdown;
}

std::string row_text(const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& cell : cells) text += " " + plain(cell) + " |";
    return text + "\n";
}

std::string table_text(const std::string& title, const ReportTable& table) {
    if (table.rows.empty()) return "";
    std::string text = fmt::format("\n**{}**\n\n", plain(title)) + row_text(table.headers) + "|";
    for (std::size_t i = 0; i < table.headers.size(); ++i) text += "---|";
    text += "\n";
    for (const std::vector<std::string>& row : table.rows) text += row_text(row);
    return table.rest.empty() ? text : text + "\n" + table.rest + "\n";
}

/// The text as a code block. Its fence is longer than any fence in the text.
std::string fenced(const std::string& text) {
    std::size_t longest = 2, run = 0;
    for (const char c : text) {
        run = c == '`' ? run + 1 : 0;
        longest = std::max(longest, run);
    }
    const std::string fence(longest + 1, '`');
    return fence + "sh\n" + text + fence + "\n";
}

}  // namespace

std::string markdown(const Comparison& comparison, const std::string& metric) {
    std::string text = fmt::format("### {}: {}\n\n{}\n\n{}\n\n", plain(comparison.batch), name_of(comparison.verdict),
                                   plain(counts_text(comparison)), plain(runs_text(comparison)));
    for (const auto& [name, fact] : facts_of(comparison)) text += fmt::format("- {}: {}\n", name, plain(fact));
    text += table_text("By rule and variant", rule_table(comparison, most_rows));
    text += table_text("What changed", change_table(comparison, most_rows));
    text += table_text("Why", reason_table(comparison, most_rows));
    text += table_text("Known doubts", known_table(comparison, most_rows));
    text += table_text(metric, matrix(comparison, metric, most_rows));
    std::string commands;
    for (const std::string& command : commands_of(comparison)) commands += command + "\n";
    if (!commands.empty())
        text += "\n<details><summary>Commands that reproduce the failed and regressed cells</summary>\n\n" +
                fenced(commands) + "\n</details>\n";
    return text;
}

}  // namespace scanmill
