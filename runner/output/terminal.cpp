// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>
#include <wchar.h>

#include <algorithm>
#include <cassert>
#include <clocale>
#include <cwchar>
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

struct Character {
    std::size_t begin, columns;
};

/// The characters of UTF-8 text with the columns that they take on a terminal; an invalid byte takes one column.
std::vector<Character> characters_of(const std::string& text) {
    static const ::locale_t utf8 = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    const ::locale_t before = ::uselocale(utf8);
    std::vector<Character> all;
    std::mbstate_t state{};
    for (std::size_t begin = 0; begin < text.size();) {
        wchar_t character = 0;
        const std::size_t bytes = std::mbrtowc(&character, &text[begin], text.size() - begin, &state);
        const bool is_valid = bytes != 0 && bytes <= text.size();
        all.push_back({begin, is_valid ? static_cast<std::size_t>(std::max(0, ::wcwidth(character))) : 1});
        if (!is_valid) state = {};
        begin += is_valid ? bytes : 1;
    }
    ::uselocale(before);
    return all;
}

std::size_t columns_of(const std::vector<Character>& characters) {
    std::size_t columns = 0;
    for (const Character& each : characters) columns += each.columns;
    return columns;
}

bool is_numeric(const std::string& text) {
    return text.empty() || text == "-" || (text.find_first_not_of("0123456789.+-e") == std::string::npos);
}

}  // namespace

std::string printable(std::string_view text) { return escaped(text, true); }
std::string printable_line(std::string_view text) { return escaped(text, false); }

std::size_t columns_of(const std::string& text) {
    const bool is_ascii = std::ranges::all_of(text, [](char c) { return (c & 0x80) == 0; });
    return is_ascii ? text.size() : columns_of(characters_of(text));
}

std::string cut_begin(const std::string& text, std::size_t width) {
    const std::vector<Character> characters = characters_of(text);
    std::size_t columns = columns_of(characters);
    if (columns <= width) return text;
    if (width < 2) return "";
    for (const Character& each : characters) {
        if (columns + 1 <= width) return "…" + text.substr(each.begin);
        columns -= each.columns;
    }
    return "…";
}

std::string cut_middle(const std::string& text, std::size_t width) {
    if (columns_of(text) <= width) return text;
    if (width < 2) return "";
    const std::vector<Character> characters = characters_of(text);
    // Half of the width is before the mark, the rest after it.
    std::size_t head = 0, columns = 0;
    while (columns + characters[head].columns <= (width - 1) / 2) columns += characters[head++].columns;
    return text.substr(0, characters[head].begin) + cut_begin(text.substr(characters[head].begin), width - columns);
}

std::optional<std::size_t> stdout_width() {
    winsize size{};
    if (::isatty(STDOUT_FILENO) == 0) return std::nullopt;
    const bool is_known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return is_known ? size.ws_col : 80;
}

void print_warning(std::string_view text) { print_stderr("warning: {}\n", printable_line(text)); }

void print_json(const nlohmann::ordered_json& json) {
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void Table::add(std::vector<std::string> row) {
    for (std::string& cell : row) cell = printable_line(cell);
    rows_.push_back(std::move(row));
}

void Table::may_cut(const std::string& header) {
    const auto found = std::ranges::find(rows_.front(), header);
    assert(found != rows_.front().end());
    to_cut_.push_back(static_cast<std::size_t>(found - rows_.front().begin()));
}

std::string Table::text(std::optional<std::size_t> width) const {
    std::vector<std::size_t> widths(rows_.front().size(), 0);
    std::vector<bool> numeric(rows_.front().size(), true);
    for (std::size_t row = 0; row < rows_.size(); ++row)
        for (std::size_t column = 0; column < rows_[row].size(); ++column) {
            widths[column] = std::max(widths[column], columns_of(rows_[row][column]));
            if (row > 0 && !is_numeric(rows_[row][column])) numeric[column] = false;
        }
    constexpr std::size_t gap = 2, least = 12;
    std::size_t total = gap * (widths.size() - 1);
    for (const std::size_t each : widths) total += each;
    for (const std::size_t column : to_cut_) {
        if (!width || total <= *width) break;
        const std::size_t cut = std::min(total - *width, widths[column] - std::min(widths[column], least));
        widths[column] -= cut;
        total -= cut;
    }
    std::string text;
    for (const std::vector<std::string>& row : rows_) {
        std::string line;
        for (std::size_t column = 0; column < row.size(); ++column) {
            const std::string cell = cut_middle(row[column], widths[column]);
            const std::string padding(widths[column] - columns_of(cell), ' ');
            line += (column > 0 ? std::string(gap, ' ') : "") + (numeric[column] ? padding + cell : cell + padding);
        }
        while (line.ends_with(' ')) line.pop_back();
        text += line + "\n";
    }
    return text;
}

}  // namespace scanmill::runner
