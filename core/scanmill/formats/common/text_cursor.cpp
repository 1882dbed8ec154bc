// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

void KeptComments::add(std::string_view comment) {
    constexpr std::size_t most = 1000;
    if (texts_.size() < most || !declaration_in(comment, "unit").empty() || !declaration_in(comment, "frame").empty())
        texts_.emplace_back(comment);
}

void KeptComments::append(const KeptComments& following) {
    for (const std::string& text : following.texts()) add(text);
}

bool TextCursor::next_row() {
    if (begun_) {
        while (more()) token();
        if (at_ != end_) skip_line_end();
    }
    begun_ = true;
    gaps_ = 0;
    while (!more()) {
        if (at_ == end_) return false;
        skip_line_end();
        gaps_ = 0;
    }
    gaps_ = gaps_ & ~blank_gap ? empty_field : 0;  // blanks before the first token separate nothing
    return true;
}

std::string_view TextCursor::token() {
    const char* const begin = at_;
    // The first character always belongs to the token, because a continuation sign inside a line begins a token.
    if (at_ != end_) ++at_;
    while (at_ != end_ && !ends_token(at_)) ++at_;
    return {begin, at_};
}

std::size_t TextCursor::count_tokens() const {
    TextCursor copy(std::string_view(at_, end_), rules_);
    std::size_t count = 0;
    for (; copy.more(); copy.token()) ++count;
    return count;
}

void TextCursor::skip_comment() {
    at_ += *at_ == '/' ? 2 : 1;
    const char* const begin = at_;
    while (at_ != end_ && !ends_line(*at_)) ++at_;
    comments_.add({begin, at_});
}

void TextCursor::skip_continuation() {
    if (++at_ != end_) skip_line_end();
}

void TextCursor::skip_line_end() {
    const bool carriage_return = *at_++ == '\r';
    if (carriage_return && at_ != end_ && *at_ == '\n') ++at_;
    ++line_;
}

bool number_with_decimal_comma(std::string_view token, double& value) {
    if (token.find('.') != std::string_view::npos) return false;
    std::string with_point(token);
    if (const std::size_t comma = with_point.find(','); comma != std::string::npos) {
        const auto is_digit = [&](std::size_t at) { return with_point[at] >= '0' && with_point[at] <= '9'; };
        if (comma == 0 || comma + 1 == with_point.size() || !is_digit(comma - 1) || !is_digit(comma + 1)) return false;
        with_point[comma] = '.';
    }
    return number_of_token(with_point, value);
}

bool number_of_token(std::string_view token, double& value) {
    if (parse_number(token, value)) return true;
    const bool is_negative = token.starts_with('-');
    if (is_negative || token.starts_with('+')) token.remove_prefix(1);
    token = token.substr(0, token.find_last_not_of('0') + 1);
    const bool is_infinite = token == "1.#INF";
    if (!is_infinite && token != "1.#IND" && token != "1.#QNAN" && token != "1.#SNAN") return false;
    value = is_infinite ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
    if (is_negative) value = -value;
    return true;
}

}  // namespace scanmill
