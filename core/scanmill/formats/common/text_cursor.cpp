// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_cursor.hpp"

#include <algorithm>

#include "scanmill/data/quantity.hpp"

namespace scanmill {

void KeptComments::add(std::string_view comment) {
    ++added_;
    if (first_.size() < most) {
        first_.emplace_back(comment);
        return;
    }
    if (!declaration_in(comment, "frame").empty()) last_[frame] = comment;
    const std::string_view declared = declaration_in(comment, "unit");
    if (declared.empty()) return;
    const auto unit = length_unit(declared);
    std::string& last = last_[unit ? known_unit : unknown_unit];
    if (unit && !last.empty() && length_unit(declaration_in(last, "unit")) != unit) last_[other_unit] = last;
    last = comment;
}

std::vector<std::string> KeptComments::texts() const {
    std::vector<std::string> texts = first_;
    std::ranges::remove_copy(last_, std::back_inserter(texts), std::string());
    return texts;
}

void KeptComments::append(const KeptComments& following) {
    for (const std::string& text : following.texts()) add(text);
    added_ += following.others();
}

namespace {
constexpr std::string_view infinite = "#INF";
constexpr std::array<std::string_view, 4> not_numbers{infinite, "#IND", "#QNAN", "#SNAN"};
}  // namespace

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
    // The first character always belongs to the token: a continuation sign inside a line begins one.
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

std::pair<std::string_view, std::string_view> TextCursor::mixed_separators() const {
    std::vector<std::string_view> found;
    if (gaps_ & comma_gap) found.push_back("commas");
    if (gaps_ & semicolon_gap) found.push_back("semicolons");
    if (gaps_ & bar_gap) found.push_back("bars");
    if (gaps_ & blank_gap) found.push_back("blanks");
    return {found.at(0), found.at(1)};
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

bool TextCursor::begins_not_a_number(std::string_view text) {
    const auto begins = [text](std::string_view word) { return text.starts_with(word); };
    return std::ranges::any_of(not_numbers, begins);
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
    const std::size_t hash = token.find('#');
    if (hash == std::string_view::npos) return parse_number(token, value);
    for (const std::string_view word : not_numbers) {
        if (!token.substr(hash).starts_with(word)) continue;
        const std::string_view before = token.substr(0, hash), after = token.substr(hash + word.size());
        if ((before != "1." && before != "-1." && before != "+1.") ||
            after.find_first_not_of('0') != std::string_view::npos)
            return false;
        value = word == infinite ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
        if (before.front() == '-') value = -value;
        return true;
    }
    return false;
}

}  // namespace scanmill
