// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_layout.hpp"

#include <algorithm>
#include <ranges>

#include "scanmill/base/error.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_columns.hpp"

namespace scanmill {

namespace {

constexpr std::size_t most_columns = 1000;

std::vector<std::string_view> tokens_of_row(TextCursor row) {
    std::vector<std::string_view> tokens;
    while (row.more() && tokens.size() <= most_columns) tokens.push_back(row.token());
    return tokens;
}

bool is_number(std::string_view token) {
    double ignored = 0;
    return number_of_token(token, ignored);
}

class LayoutReader {
public:
    explicit LayoutReader(TextCursor& text) : text_(text) {}

    TextLayout read() {
        if (!text_.next_row()) throw Error("holds no points: nothing but blanks and comments");
        const bool counted = pass_count();
        if (pass_names() && !counted) pass_count();
        layout_.width = tokens_of_row(text_).size();
        if (layout_.width > most_columns) throw Error("line {}: more than {} columns", text_.line(), most_columns);
        if (layout_.width < 3)
            throw Error("line {}: found {}; a point has at least the three numbers x, y and z", text_.line(),
                        counted_columns());
        if (layout_.names.empty())
            look_into_comments();
        else if (layout_.names.size() != layout_.width)
            throw names_do_not_fit();
        return std::move(layout_);
    }

private:
    std::string counted_columns() const { return count_text(layout_.width, "column", "columns"); }

    /// Twice as many numbers in a row with semicolons as names is what decimal commas look like.
    Error names_do_not_fit() {
        Error error("line {}: {} for {} names", text_.line(), counted_columns(), layout_.names.size());
        if (layout_.width == 2 * layout_.names.size())
            error.set_hint("if the commas are decimal commas, write points instead: 1.5 for 1,5");
        return error;
    }

    bool pass_count() {
        TextCursor row = text_;
        u64 count = 0;
        if (!row.number(count) || row.more()) return false;
        layout_.promised = count;
        layout_.promised_in_line = text_.line();
        if (!text_.next_row()) throw Error("holds no points: its last line is a count");
        return true;
    }

    bool pass_names() {
        const std::vector<std::string_view> tokens = tokens_of_row(text_);
        const std::string_view line(tokens.front().begin(), tokens.back().end());
        std::vector<std::string> names = split_names(line, most_columns);
        const auto axes = axes_among(names);
        if (!axes) {
            if (std::ranges::any_of(tokens, is_number)) return false;
            if (const auto twice = repeated_axis(names))
                throw Error("line {}: two columns are called {}", text_.line(), quote(*twice))
                    .hint("rename one of them");
            throw Error("line {}: {} is neither a row of numbers nor names among which are x, y and z", text_.line(),
                        quote(tokens.front()));
        }
        layout_.axes = *axes;
        layout_.names = std::move(names);
        if (!text_.next_row()) throw Error("holds no points: its only line has the columns' names");
        return true;
    }

    /// "//X Y Z Intensity" and "# x y z nx ny nz" are comments to most programs and names to some.
    void look_into_comments() {
        layout_.unread_comments = text_.comments().others();
        for (const std::string& comment : std::views::reverse(text_.comments().texts())) {
            std::vector<std::string> names = split_names(comment, most_columns);
            const auto axes = axes_among(names);
            if (!axes) continue;
            if (names.size() != layout_.width || *axes != layout_.axes) {
                layout_.passed_over = comment;
                continue;
            }
            layout_.passed_over.clear();
            layout_.names = std::move(names);
            return;
        }
    }

    TextCursor& text_;
    TextLayout layout_;
};

}  // namespace

TextLayout read_text_layout(TextCursor& text) { return LayoutReader(text).read(); }

bool is_row_of_numbers(TextCursor row) {
    const std::vector<std::string_view> tokens = tokens_of_row(std::move(row));
    return std::ranges::all_of(tokens, is_number);
}

}  // namespace scanmill
