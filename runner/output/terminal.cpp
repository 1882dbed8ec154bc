// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/terminal.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace scanmill::runner {

namespace {

std::string escaped(std::string_view text, bool keeps_line_ends) {
    std::string result;
    for (const char c : text) {
        const bool is_control = static_cast<unsigned char>(c) < ' ' || c == 0x7f;
        if (!is_control || (c == '\n' && keeps_line_ends))
            result += c;
        else
            result += c == '\n' ? "\\n" : c == '\t' ? "\\t" : fmt::format("\\x{:02x}", c);
    }
    return result;
}

/// Counts characters, not bytes: continuation bytes of UTF-8 are skipped.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

bool is_numeric(const std::string& text) {
    return text.empty() || text == "-" || (text.find_first_not_of("0123456789.+-e") == std::string::npos);
}

}  // namespace

std::string printable(std::string_view text) { return escaped(text, true); }
std::string printable_line(std::string_view text) { return escaped(text, false); }

void print_warning(std::string_view text) { print_stderr("warning: {}\n", printable_line(text)); }

void print_json(const nlohmann::ordered_json& json) {
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void Table::add(std::vector<std::string> row) {
    for (std::string& cell : row) cell = printable_line(cell);
    rows_.push_back(std::move(row));
}

std::string Table::text() const {
    std::vector<std::size_t> widths(rows_.front().size(), 0);
    std::vector<bool> numeric(rows_.front().size(), true);
    for (std::size_t row = 0; row < rows_.size(); ++row)
        for (std::size_t column = 0; column < rows_[row].size(); ++column) {
            widths[column] = std::max(widths[column], width_of(rows_[row][column]));
            if (row > 0 && !is_numeric(rows_[row][column])) numeric[column] = false;
        }
    std::string text;
    for (const std::vector<std::string>& row : rows_) {
        std::string line;
        for (std::size_t column = 0; column < row.size(); ++column) {
            const std::string padding(widths[column] - width_of(row[column]), ' ');
            line += (column > 0 ? "  " : "") + (numeric[column] ? padding + row[column] : row[column] + padding);
        }
        while (line.ends_with(' ')) line.pop_back();
        text += line + "\n";
    }
    return text;
}

}  // namespace scanmill::runner
