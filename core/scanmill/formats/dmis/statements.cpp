// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/dmis/statements.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill::dmis {

namespace {

struct UnitName {
    LengthUnit unit;
    std::string_view name;
};
constexpr std::array<UnitName, 5> units{{{LengthUnit::millimetre, "MM"},
                                         {LengthUnit::centimetre, "CM"},
                                         {LengthUnit::metre, "M"},
                                         {LengthUnit::inch, "INCH"},
                                         {LengthUnit::foot, "FEET"}}};

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Programs of DOS end with control-Z.
bool is_foreign(char c) { return static_cast<unsigned char>(c) >= 0x80 || c == '\x1a'; }

/// Splits at commas outside quotes and parentheses.
void split(std::string_view text, std::vector<std::string_view>& fields) {
    std::size_t begin = 0;
    int depth = 0;
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\'') is_quoted = !is_quoted;
        if (is_quoted) continue;
        if (c == '(') ++depth;
        if (c == ')') --depth;
        if (c != ',' || depth > 0) continue;
        fields.push_back(trimmed(text.substr(begin, i - begin)));
        begin = i + 1;
    }
    fields.push_back(trimmed(text.substr(begin)));
}

}  // namespace

std::string_view unit_name(LengthUnit unit) {
    const auto found = std::ranges::find(units, unit, &UnitName::unit);
    return found == units.end() ? std::string_view() : found->name;
}

std::optional<LengthUnit> unit_named(std::string_view name) {
    const auto found = std::ranges::find(units, name, &UnitName::name);
    if (found == units.end()) return std::nullopt;
    return found->unit;
}

std::string unit_names() { return "MM, CM, M, INCH or FEET"; }

void Statements::add_line(std::string_view line) {
    if (line.size() > longest_line) ++long_lines_;
    bool has_comment = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (c == '$' && !is_quoted_ && line.substr(i).starts_with("$$")) {
            has_comment = true;
            comments_.add(line.substr(i + 2));
            break;
        }
        if (is_foreign(c)) {
            ++foreign_bytes_;
            continue;
        }
        if (c == '\'') is_quoted_ = !is_quoted_;
        joined_ += is_quoted_ ? c : upper(c);
    }
    const std::size_t used = joined_.find_last_not_of(" \t") + 1;  // 0 if there is none
    const bool goes_on = !has_comment && used > 0 && joined_[used - 1] == '$';
    // A comment between the lines of a statement does not end it.
    const bool is_only_comment = has_comment && trimmed(line).starts_with("$$");
    if (goes_on) joined_.resize(used - 1);
    is_continued_ = goes_on || (is_continued_ && is_only_comment);
}

bool Statements::next() {
    joined_.clear();
    is_quoted_ = is_continued_ = false;
    bool is_blank = true, has_end = true;
    while (!rest_.empty() && (is_blank || is_continued_)) {
        ++line_;
        if (is_blank && !is_continued_) statement_.line = line_;
        const std::size_t size = std::min(rest_.find_first_of("\r\n"), rest_.size());
        has_end = size < rest_.size();
        add_line(rest_.substr(0, size));
        rest_.remove_prefix(size);
        if (rest_.starts_with("\r\n")) rest_.remove_prefix(1);
        if (!rest_.empty()) rest_.remove_prefix(1);
        is_blank = joined_.find_first_not_of(" \t\v\f") == std::string::npos;
        if (is_blank) joined_.clear();
    }
    if (is_continued_) is_cut_ = true;
    if (is_blank) return false;
    parse();
    if (!has_end && statement_.major != "ENDFIL") is_cut_ = true;
    return true;
}

void Statements::parse() {
    std::string_view text = trimmed(joined_);
    statement_.type = statement_.label = {};
    statement_.fields.clear();
    const std::size_t equal = text.find('=');
    if (equal < text.find('/')) {
        const std::string_view left = trimmed(text.substr(0, equal));
        const std::size_t open = std::min(left.find('('), left.size());
        statement_.type = trimmed(left.substr(0, open));
        if (open < left.size() && left.back() == ')')
            statement_.label = trimmed(left.substr(open + 1, left.size() - open - 2));
        text = trimmed(text.substr(equal + 1));
    }
    const std::size_t slash = std::min(text.find('/'), text.size());
    statement_.major = trimmed(text.substr(0, slash));
    if (slash < text.size()) split(text.substr(slash + 1), statement_.fields);
}

std::string lines_of(std::string_view statement) {
    std::string lines;
    while (statement.size() > longest_line) {
        constexpr std::size_t room = longest_line - 1;  // beside the continuation sign
        std::size_t size = statement.substr(0, room).rfind(',') + 1;  // 0 without a comma
        if (size == 0) size = room;
        // Two signs would begin a comment.
        while (size > 1 && (statement[size - 1] == '$' || statement[size] == '$')) --size;
        lines.append(statement.substr(0, size)).append("$\n");
        statement.remove_prefix(size);
    }
    return lines.append(statement).append("\n");
}

std::string fixed_text(double number, u32 decimals) {
    // The largest double has 309 digits before the point.
    std::array<char, 400> digits;
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number,
                                            std::chars_format::fixed, static_cast<int>(decimals));
    std::string text(digits.data(), error == std::errc() ? end : digits.data());
    if (text.starts_with('-') && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
    return text;
}

}  // namespace scanmill::dmis
