// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>
#include <wchar.h>

#include <algorithm>
#include <cassert>
#include <clocale>
#include <cstdlib>
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

std::string for_locale(std::string text) {
    static const bool has_utf8 = [] {
        for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"})
            if (const char* locale = std::getenv(name); locale && *locale != '\0') {
                const std::string_view set = std::string_view(locale).substr(std::string_view(locale).find('.') + 1);
                return std::string_view(locale).find('.') == std::string_view::npos || set.starts_with("utf") ||
                       set.starts_with("UTF");
            }
        return true;
    }();
    if (has_utf8) return text;
    for (const auto& [symbol, plain] : {std::pair("…", '~'), std::pair("²", '2'), std::pair("³", '3')})
        for (std::size_t at = 0; (at = text.find(symbol, at)) != std::string::npos; ++at)
            text.replace(at, std::string_view(symbol).size(), 1, plain);
    return text;
}

std::string wrapped(const std::string& text, std::size_t width) {
    constexpr std::string_view indent = "  ";
    std::string result;
    std::size_t taken = 0;  // columns of the present line
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n", begin + 1), text.size());
        const bool is_new_line = text[begin] == '\n';
        std::string word = text.substr(begin, end - begin);  // with the blank or line end before it
        if (is_new_line) {
            taken = columns_of(word.substr(1));
        } else if (taken > indent.size() && taken + columns_of(word) > width && word[0] == ' ') {
            word = "\n" + std::string(indent) + word.substr(1);
            taken = columns_of(word.substr(1));
        } else {
            taken += columns_of(word);
        }
        result += word;
        begin = end;
    }
    return result;
}

std::string for_stderr(std::string text) {
    winsize size{};
    if (::isatty(STDERR_FILENO) != 0) {
        const bool is_known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
        text = wrapped(text, is_known ? size.ws_col : 80);
    }
    return for_locale(std::move(text));
}

void print_warning(std::string_view text) { print_stderr("{}\n", for_stderr("warning: " + printable_line(text))); }

void print_json(const nlohmann::ordered_json& json) {
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void print_document(const nlohmann::ordered_json& members) {
    nlohmann::ordered_json json{{"scanmill", 1}};
    json.update(members);
    print_json(json);
}

void Table::add(std::vector<std::string> row) {
    for (std::string& cell : row) cell = printable_line(cell);
    rows_.push_back(std::move(row));
}

std::size_t Table::column_of(const std::string& header) const {
    const auto found = std::ranges::find(rows_.front(), header);
    assert(found != rows_.front().end());
    return static_cast<std::size_t>(found - rows_.front().begin());
}

void Table::may_cut(const std::string& header, std::size_t comfortable) {
    to_cut_.emplace_back(column_of(header), comfortable);
}
void Table::may_leave_out(const std::string& header) { to_leave_out_.push_back(column_of(header)); }

FittedTable Table::fitted(std::optional<std::size_t> width) const {
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
    const auto is_too_wide = [&] { return width && total > *width; };
    const auto cut_names = [&](bool is_comfortable) {
        for (const auto& [column, comfortable] : to_cut_) {
            if (!is_too_wide()) break;
            const std::size_t limit = is_comfortable ? comfortable : least;
            const std::size_t cut = std::min(total - *width, widths[column] - std::min(widths[column], limit));
            widths[column] -= cut;
            total -= cut;
        }
    };
    std::vector<bool> is_left_out(widths.size(), false);
    FittedTable result;
    const std::vector<std::size_t> whole = widths;
    if (!to_leave_out_.empty()) cut_names(true);
    for (const std::size_t column : to_leave_out_) {
        if (!is_too_wide()) break;
        is_left_out[column] = true;
        total -= widths[column] + gap;
        ++result.left_out;
    }
    // What was left out may have made more room than the names need.
    for (std::size_t column = 0; column < widths.size(); ++column)
        if (!is_left_out[column]) total += whole[column] - widths[column];
    widths = whole;
    if (!to_leave_out_.empty()) cut_names(true);
    cut_names(false);
    for (const std::vector<std::string>& row : rows_) {
        std::string line;
        for (std::size_t column = 0; column < row.size(); ++column) {
            if (is_left_out[column]) continue;
            const std::string cell = cut_middle(row[column], widths[column]);
            const std::string padding(widths[column] - columns_of(cell), ' ');
            line += (line.empty() ? "" : std::string(gap, ' ')) + (numeric[column] ? padding + cell : cell + padding);
        }
        while (line.ends_with(' ')) line.pop_back();
        result.text += line + "\n";
    }
    result.text = for_locale(std::move(result.text));
    return result;
}

}  // namespace scanmill::runner
