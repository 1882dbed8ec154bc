// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reads a text of numbers row by row and token by token, counts its lines and collects its comments.
///
/// A row is a line with at least one token; blank lines and comments are skipped. Lines end with LF, CRLF or CR. If the
/// format allows it, a continuation sign right before the line's end joins the next line to the row; in a comment the
/// sign is text. Blanks and tabs separate tokens, and, if the format allows it, also commas, semicolons and bars.
/// Numbers are read independently of the locale, in every spelling of nan and inf that parse_number() accepts. No text
/// is copied.

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

/// Keeps comments in bounded memory, because a file may have a comment in every other line.
class KeptComments {
public:
    void add(std::string_view comment);
    /// Adds the comments of the text that follows.
    void append(const KeptComments& following);
    /// The first 1000 comments, and every later comment that declares a unit or a frame (see declared_frame()).
    const std::vector<std::string>& texts() const { return texts_; }

private:
    std::vector<std::string> texts_;
};

struct TextRules {
    bool commas = false;  ///< commas, semicolons and bars separate as well
    bool decimal_commas = false;  ///< numbers have commas instead of points; commas do not separate
    char comment = '\0';  ///< begins a comment that lasts until the line's end; zero: no such comments
    bool slashes = false;  ///< two slashes at the beginning of a token begin a comment as well
    char continuation = '\0';  ///< joins two lines if it is the last character of the first; zero: none
    std::size_t line = 1;  ///< number of the first line
};

/// Reads the number that a token spells, like parse_number(). Also accepts infinity and NaN as Microsoft's libraries
/// printed them until 2015: 1.#INF, -1.#IND. Returns false for other tokens.
bool number_of_token(std::string_view token, double& value);
/// The same for a number with a decimal comma: at most one comma, between two digits. A point is not accepted.
bool number_with_decimal_comma(std::string_view token, double& value);

class TextCursor {
public:
    explicit TextCursor(std::string_view text, TextRules rules = {})
        : at_(text.data()),
          end_(text.data() + text.size()),
          rules_(rules),
          separators_(!rules.commas          ? blank_gap
                      : rules.decimal_commas ? any_gap & ~comma_gap
                                             : any_gap),
          line_(rules.line) {}

    /// Moves to the next row, skipping the rest of this one; false at the end of the text.
    bool next_row();
    /// Whether a token is left in this row.
    bool more();
    /// The next token of this row. Pre: more().
    std::string_view token();
    /// Reads the next token of this row as a number. Returns false if the token is not a number of the type; the token
    /// is then consumed, too. Whole numbers may be written as 3.0 or +3. Pre: more().
    template <class Number>
    bool number(Number& value);
    /// The token that number() just refused.
    std::string_view last_token() const { return last_token_; }
    /// Makes `tail`, the end of the token just read, the next token.
    void put_back(std::string_view tail) { at_ = tail.data(); }
    /// Whether the part of the row that was read has different separators, such as commas and blanks: "1,5 2,5 3" may
    /// mean three numbers or five.
    bool mixes_separators() const { return (gaps_ & any_gap & ((gaps_ & any_gap) - 1)) != 0; }
    bool has_decimal_commas() const { return rules_.decimal_commas; }
    /// Whether commas separate tokens in the part of the row that was read.
    bool has_commas() const { return (gaps_ & comma_gap) != 0; }
    /// Whether the part of the row that was read has a comma, semicolon or bar without a number before it.
    bool has_empty_field() const { return gaps_ & empty_field; }
    /// The number of tokens left in this row. Does not move the cursor.
    std::size_t count_tokens() const;

    /// The text that was not read yet.
    std::string_view rest() const { return {at_, end_}; }
    /// Number of the current line.
    std::size_t line() const { return line_; }
    /// The comments so far, without the characters that begin them.
    const KeptComments& comments() const { return comments_; }

private:
    // Bits of gaps_; the first four and line_end are also the classes of characters.
    static constexpr unsigned comma_gap = 1, semicolon_gap = 2, bar_gap = 4, blank_gap = 8, any_gap = 15;
    static constexpr unsigned empty_field = 16, line_end = 32;
    static constexpr auto kinds = [] {
        std::array<unsigned char, 256> table{};
        for (const char c : {' ', '\t', '\v', '\f'}) table[static_cast<unsigned char>(c)] = blank_gap;
        for (const char c : {'\n', '\r'}) table[static_cast<unsigned char>(c)] = line_end;
        table[','] = comma_gap;
        table[';'] = semicolon_gap;
        table['|'] = bar_gap;
        return table;
    }();

    static unsigned kind(char c) { return kinds[static_cast<unsigned char>(c)]; }
    static bool ends_line(char c) { return kind(c) == line_end; }
    unsigned gap_at(char c) const { return kind(c) & separators_; }
    /// Pre: `at` is neither the end nor the first character of a token.
    bool ends_token(const char* at) const {
        if ((kind(*at) & (separators_ | line_end)) != 0) return true;
        if (*at == '\0') return false;
        return *at == rules_.continuation || (*at == rules_.comment && at[-1] != '.');  // 1.#INF is a number
    }
    bool at_comment() const {
        if (*at_ == '/') return rules_.slashes && end_ - at_ > 1 && at_[1] == '/';
        return *at_ == rules_.comment && rules_.comment != '\0';
    }
    bool at_continuation() const {
        return rules_.continuation != '\0' && at_ != end_ && *at_ == rules_.continuation &&
               (at_ + 1 == end_ || ends_line(at_[1]));
    }
    void skip_gap(unsigned& all, int& commas) {
        for (unsigned gap; at_ != end_ && (gap = gap_at(*at_)) != 0; ++at_) {
            all |= gap;
            commas += gap != blank_gap;
        }
    }
    void skip_continuation();
    void skip_comment();
    void skip_line_end();

    const char* at_;
    const char* end_;
    TextRules rules_;
    unsigned separators_;
    std::size_t line_;
    unsigned gaps_ = 0;
    bool begun_ = false;
    std::string_view last_token_;
    KeptComments comments_;
};

inline bool TextCursor::more() {
    const char* const begin = at_;
    int commas = 0;
    unsigned all = 0;
    skip_gap(all, commas);
    while (at_continuation()) {
        skip_continuation();
        skip_gap(all, commas);
    }
    if (commas > 1) gaps_ |= empty_field;
    if (at_ == end_ || ends_line(*at_)) return false;
    if (at_comment()) {
        skip_comment();
        return false;
    }
    if (at_ != begin) gaps_ |= commas == 0 ? blank_gap : all & ~blank_gap;
    return true;
}

template <class Number>
bool TextCursor::number(Number& value) {
    const auto [rest, error] = std::from_chars(at_, end_, value);
    if (error == std::errc() && (rest == end_ || ends_token(rest)) && !rules_.decimal_commas) {
        at_ = rest;
        return true;
    }
    double wide = 0;
    last_token_ = token();
    if (!(rules_.decimal_commas ? number_with_decimal_comma : number_of_token)(last_token_, wide)) return false;
    if constexpr (std::is_integral_v<Number>) {
        // The largest integer may round up as a double, so the number is compared with its successor, which is exact.
        constexpr double low = static_cast<double>(std::numeric_limits<Number>::min());
        const double beyond = std::ldexp(1.0, std::numeric_limits<Number>::digits);
        if (!(wide >= low && wide < beyond) || wide != std::trunc(wide)) return false;
    }
    value = static_cast<Number>(wide);
    return true;
}

/// The next number of the row. Throws Error with the line if the row has ended or the token is not a number of the
/// type. `purpose`, formatted with the arguments, describes the number in the message: "the normal of vertex 5".
template <class Number = double, class... Arguments>
Number next_number(TextCursor& text, fmt::format_string<Arguments...> purpose, Arguments&&... arguments) {
    const auto described = [&] { return fmt::format(purpose, std::forward<Arguments>(arguments)...); };
    Number value{};
    if (!text.more()) throw Error("line {}: the row ends before {}", text.line(), described());
    if (!text.number(value))
        throw Error("line {}: {} is not a {}number for {}", text.line(), quote(text.last_token()),
                    std::is_integral_v<Number> ? "whole " : "", described());
    return value;
}

/// Moves to row `row` of `rows`. Throws Error when the text has ended: "line 9: the text ends after 3 of 8 faces".
inline void require_row(TextCursor& text, u64 row, u64 rows, std::string_view elements) {
    if (!text.next_row())
        throw Error("line {}: the text ends after {} of {} {}", text.line(), row, rows, elements).hint(truncated_hint);
}

}  // namespace scanmill
