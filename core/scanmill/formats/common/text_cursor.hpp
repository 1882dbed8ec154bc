// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The comments of a text, as many as anybody wants to read, and of all the others what they declare.

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace scanmill {

/// A file may hold a comment in every other line: memory is bounded.
class KeptComments {
public:
    static constexpr std::size_t most = 1000;

    void add(std::string_view comment);
    /// Those of the text that follows, where two parts were read by themselves: as if all had been added here.
    void append(const KeptComments& following);

    /// The first `most`; behind them the last of the others that declares a unit, before it the last that declares
    /// another one, the last that seems to declare one which is unknown, and the last that declares a frame (see
    /// declared_frame()).
    const std::vector<std::string>& texts() const { return texts_; }
    /// How many are not among texts().
    std::size_t others() const { return added_ - texts_.size(); }

private:
    /// The unit that was the last is no longer.
    void keep_other_unit();

    std::vector<std::string> texts_;
    std::size_t added_ = 0;
    /// Where in texts_ the last of each kind of declaration is; 0: there is none.
    std::array<std::size_t, 3> places_{};
    std::size_t other_unit_ = 0;
};

// Walks through a text of numbers, row by row and token by token, and knows the line it is in.
//
// A row is a line that holds at least one token; blank lines and comments are passed over. Lines end with LF, CRLF or
// CR; where a format allows it, a sign right before the line's end joins the next line to the row (in a comment it is
// text). Tokens are separated by blanks and tabs, and, where a format allows it, by commas, semicolons and bars.
// Numbers are read without regard to the locale, every spelling of nan and inf that parse_number() knows included.
// Nothing is copied and nothing beyond the text is touched.

struct TextRules {
    bool commas = false;  ///< commas, semicolons and bars separate, too
    char comment = '\0';  ///< begins a comment that lasts until the line's end; none when zero
    bool slashes = false;  ///< two slashes at the beginning of a token begin a comment, too
    char continuation = '\0';  ///< joins two lines when it stands right before the line's end; none when zero
    std::size_t line = 1;  ///< number of the first line
};

/// The number that a token spells: as parse_number(), and infinity and NaN as Microsoft's libraries print them.
bool number_of_token(std::string_view token, double& value);

class TextCursor {
public:
    explicit TextCursor(std::string_view text, TextRules rules = {})
        : at_(text.data()),
          end_(text.data() + text.size()),
          rules_(rules),
          separators_(rules.commas ? any_gap : blank_gap),
          line_(rules.line) {}

    /// Moves to the next row, passing over what is left of this one; false at the end of the text.
    bool next_row();
    /// Whether a token is left in this row.
    bool more();
    /// The next token of this row. Pre: more().
    std::string_view token();
    /// The next token of this row as a number; false, consuming it, when it is none or does not fit the type. Whole
    /// numbers may be written as 3.0 or +3. Pre: more().
    template <class Number>
    bool number(Number& value);
    /// The token that number() just refused.
    std::string_view last_token() const { return last_token_; }
    /// Makes `tail`, the end of the token just read, the next token.
    void put_back(std::string_view tail) { at_ = tail.data(); }
    /// Between the numbers of this row, as far as it was read, stood different separators, say commas here and blanks
    /// there: "1,5 2,5 3" may mean three numbers or five.
    bool mixes_separators() const { return (gaps_ & any_gap & ((gaps_ & any_gap) - 1)) != 0; }
    /// The first two kinds that mixes_separators() saw: "commas" and "blanks". Pre: it does.
    std::pair<std::string_view, std::string_view> mixed_separators() const;
    /// A comma, semicolon or bar with nothing before it in this row, as far as it was read.
    bool has_empty_field() const { return gaps_ & empty_field; }
    /// Tokens left in this row; does not move.
    std::size_t count_tokens() const;

    /// Number of the current line.
    std::size_t line() const { return line_; }
    /// The comments passed so far, without their sign.
    const KeptComments& comments() const { return comments_; }

private:
    // Bits of gaps_; the first four and line_end are also what a character is.
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
    /// Pre: `at` is not the end.
    bool ends_token(const char* at) const {
        if ((kind(*at) & (separators_ | line_end)) != 0) return true;
        if (*at == '\0') return false;
        return *at == rules_.continuation || (*at == rules_.comment && !begins_no_number({at, end_}));
    }
    /// Whether this is the rest of what Microsoft's libraries print for infinity and NaN: 1.#INF, -1.#IND, 1.#QNAN.
    static bool begins_no_number(std::string_view text);
    bool at_comment() const {
        if (*at_ == '/') return rules_.slashes && end_ - at_ > 1 && at_[1] == '/';
        return *at_ == rules_.comment && rules_.comment != '\0';
    }
    bool at_continuation() const {
        return rules_.continuation != '\0' && at_ != end_ && *at_ == rules_.continuation &&
               (at_ + 1 == end_ || ends_line(at_[1]));
    }
    void pass_gap(unsigned& all, int& commas) {
        for (unsigned gap; at_ != end_ && (gap = gap_at(*at_)) != 0; ++at_) {
            all |= gap;
            commas += gap != blank_gap;
        }
    }
    void pass_continuation();
    void pass_comment();
    void pass_line_end();
    bool unusual_number(double& value);

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
    pass_gap(all, commas);
    while (at_continuation()) {
        pass_continuation();
        pass_gap(all, commas);
    }
    if (commas > 1) gaps_ |= empty_field;
    if (at_ == end_ || ends_line(*at_)) return false;
    if (at_comment()) {
        pass_comment();
        return false;
    }
    if (at_ != begin) gaps_ |= commas == 0 ? blank_gap : all & ~blank_gap;
    return true;
}

template <class Number>
bool TextCursor::number(Number& value) {
    const auto [rest, error] = std::from_chars(at_, end_, value);
    if (error == std::errc() && (rest == end_ || ends_token(rest))) {
        at_ = rest;
        return true;
    }
    double wide = 0;
    if (!unusual_number(wide)) return false;
    if constexpr (std::is_integral_v<Number>) {
        // The upper limit as a double may be rounded up to one too many: hence < and the successor.
        constexpr double low = static_cast<double>(std::numeric_limits<Number>::min());
        const double beyond = std::ldexp(1.0, std::numeric_limits<Number>::digits);
        if (!(wide >= low && wide < beyond) || wide != std::trunc(wide)) return false;
    }
    value = static_cast<Number>(wide);
    return true;
}

}  // namespace scanmill
