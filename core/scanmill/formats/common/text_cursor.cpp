// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_cursor.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {

std::optional<LengthUnit> unit_of(std::string_view comment) { return length_unit(declaration_in(comment, "unit")); }

/// 0 to 2, for what the comment declares.
std::optional<std::size_t> kind_of(std::string_view comment) {
    if (!declaration_in(comment, "frame").empty()) return 2;
    const std::string_view unit = declaration_in(comment, "unit");
    if (unit.empty() || is_prose(unit)) return {};
    return length_unit(unit) ? 0 : 1;
}

}  // namespace

void KeptComments::add(std::string_view comment) {
    ++added_;
    if (added_ <= most) {
        texts_.emplace_back(comment);
        return;
    }
    const std::optional<std::size_t> kind = kind_of(comment);
    if (!kind) return;
    std::size_t& place = places_[*kind];
    if (*kind == 0 && place != 0 && unit_of(texts_[place]) != unit_of(comment)) keep_other_unit();
    if (place == 0) {
        place = texts_.size();
        texts_.emplace_back();
    }
    texts_[place] = comment;
}

void KeptComments::keep_other_unit() {
    if (other_unit_ == 0) {
        other_unit_ = places_[0];
        places_[0] = 0;
    } else
        texts_[other_unit_] = texts_[places_[0]];
}

void KeptComments::append(const KeptComments& following) {
    for (const std::string& text : following.texts_) add(text);
    added_ += following.others();
}

namespace {
constexpr std::string_view infinite = "#INF";
constexpr std::array<std::string_view, 4> no_numbers{infinite, "#IND", "#QNAN", "#SNAN"};
}  // namespace

bool TextCursor::next_row() {
    if (begun_) {
        while (more()) token();
        if (at_ != end_) pass_line_end();
    }
    begun_ = true;
    gaps_ = 0;
    while (!more()) {
        if (at_ == end_) return false;
        pass_line_end();
        gaps_ = 0;
    }
    gaps_ = gaps_ & ~blank_gap ? empty_field : 0;  // what stands before the first token is no gap
    return true;
}

std::string_view TextCursor::token() {
    const char* const begin = at_;
    // The first is the token's in any case: a continuation sign inside a line begins one.
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

void TextCursor::pass_comment() {
    at_ += *at_ == '/' ? 2 : 1;
    const char* const begin = at_;
    while (at_ != end_ && !ends_line(*at_)) ++at_;
    comments_.add({begin, at_});
}

void TextCursor::pass_continuation() {
    if (++at_ != end_) pass_line_end();
}

void TextCursor::pass_line_end() {
    const bool carriage_return = *at_++ == '\r';
    if (carriage_return && at_ != end_ && *at_ == '\n') ++at_;
    ++line_;
}

bool TextCursor::begins_no_number(std::string_view text) {
    const auto begins = [text](std::string_view word) { return text.starts_with(word); };
    return std::ranges::any_of(no_numbers, begins);
}

bool TextCursor::unusual_number(double& value) {
    last_token_ = token();
    return number_of_token(last_token_, value);
}

bool number_of_token(std::string_view token, double& value) {
    const std::size_t hash = token.find('#');
    if (hash == std::string_view::npos) return parse_number(token, value);
    for (const std::string_view word : no_numbers) {
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
