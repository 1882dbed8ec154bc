// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_columns.hpp"
#include "scanmill/formats/common/text_layout.hpp"
#include "scanmill/formats/text/detail/tagged_points.hpp"
#include "scanmill/formats/text/text.hpp"

namespace scanmill {

namespace {

constexpr TextRules rules{.comment = '#'};
constexpr std::string_view usual_tags = "pdsg";

bool is_tag(std::string_view word) {
    return word.size() == 1 && ((word[0] >= 'a' && word[0] <= 'z') || (word[0] >= 'A' && word[0] <= 'Z'));
}

Vec3 point_in_row(TextCursor& text) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
        if (!text.more()) throw Error("line {}: a point has three numbers, here are {}", text.line(), axis);
        if (!text.number(p[axis]))
            throw Error("line {}: {} is no number for a point", text.line(), quote(text.last_token()));
    }
    if (text.more())
        throw Error("line {}: a point has three numbers, here are {}", text.line(), 3 + text.count_tokens());
    return p;
}

}  // namespace

bool are_tagged_points(std::string_view text) {
    TextCursor cursor(text, rules);
    if (!cursor.next_row()) return false;
    const std::string_view tag = cursor.token();
    return is_tag(tag) && usual_tags.find(tag) != std::string_view::npos && cursor.count_tokens() == 3 &&
           is_row_of_numbers(cursor);
}

LoadedFile read_tagged_points(std::string_view text, const ReadOptions& options) {
    TextCursor cursor(text, rules);
    Array<Vec3> positions;
    u64 others = 0;
    std::set<char> tags;
    while (cursor.next_row()) {
        const std::string_view tag = cursor.token();
        if (!is_tag(tag))
            throw Error("line {}: {} is no letter that says what the row holds, such as p for a point", cursor.line(),
                        quote(tag));
        if (tag == "p") {
            positions.push_back(point_in_row(cursor));
        } else {
            ++others;
            tags.insert(tag[0]);
        }
    }
    if (positions.empty()) throw Error("holds no points: no row begins with p");
    require_countable(positions.size(), "points");
    if (others > 0)
        warn(options.on_warning, "{} not of points ({}) and left out", count_text(others, "row is", "rows are"),
             fmt::join(tags, ", "));

    LoadedFile loaded;
    loaded.format = "XYZ";
    loaded.encoding = "ascii";
    loaded.comments = cursor.comments().texts();
    PointCloud cloud;
    cloud.frame = declared_frame(loaded.comments, options);
    move_near_origin(positions, bounding_box(positions), cloud.frame);
    cloud.positions = std::move(positions);
    loaded.value = std::make_shared<const PointCloud>(std::move(cloud));
    return loaded;
}

namespace {

class XyzReader {
public:
    XyzReader(const FileBytes& file, std::string_view text, const ReadOptions& options)
        : text_(text, text_rules),
          size_(text.size()),
          extension_(plain_extension(file.path.extension().string())),
          options_(options) {}

    LoadedFile read() {
        layout_ = read_text_layout(text_);
        if (!layout_.passed_over.empty())
            warn(options_.on_warning,
                 "the comment {} was passed over: it does not name x, y, z and then the rest of {}",
                 quote(layout_.passed_over), count_text(layout_.width, "column", "columns"));
        if (layout_.unread_comments > 0)
            warn(options_.on_warning,
                 "{} before the numbers, behind the first {}, {} not looked through for the names of columns",
                 count_text(layout_.unread_comments, "comment", "comments"), KeptComments::most,
                 by_count(layout_.unread_comments, "was", "were"));
        read_rows();
        std::optional<Column> normals = normals_behind_points();
        if (!normals) check_count();
        require_countable(positions_.size(), "points");

        LoadedFile loaded;
        loaded.format = "XYZ";
        loaded.encoding = "ascii";
        loaded.comments = text_.comments().texts();
        PointCloud cloud;
        cloud.frame = declared_frame(loaded.comments, options_);
        move_near_origin(positions_, bounding_box(positions_), cloud.frame);
        if (normals)
            cloud.columns.add(std::move(*normals));
        else
            cloud.columns = columns();
        cloud.positions = std::move(positions_);
        loaded.value = std::make_shared<const PointCloud>(std::move(cloud));
        return loaded;
    }

private:
    /// Points that a line with their number announces.
    struct Block {
        u64 promised;
        std::size_t line;
        std::size_t first;  // of its points
    };

    void read_rows() {
        if (layout_.promised) blocks_.push_back({*layout_.promised, layout_.promised_in_line, 0});
        // A row takes at least two bytes per number: the file's size bounds what may be reserved.
        constexpr std::size_t usual_number_text = 8;
        const std::size_t guess = size_ / (usual_number_text * layout_.width) + 1;
        positions_.reserve(guess);
        for (std::size_t i = 0; i < layout_.width; ++i)
            if (std::ranges::find(layout_.axes, i) == layout_.axes.end()) further_places_.push_back(i);
        further_.resize(further_places_.size());
        for (Array<double>& column : further_) column.reserve(guess);
        row_.resize(layout_.width);
        do {
            if (!read_row()) continue;
            const auto [x, y, z] = layout_.axes;
            positions_.push_back({row_[x], row_[y], row_[z]});
            for (std::size_t i = 0; i < further_.size(); ++i) further_[i].push_back(row_[further_places_[i]]);
        } while (text_.next_row());
    }

    /// Fills row_; false when the row was the count of another block.
    bool read_row() {
        const std::size_t width = row_.size();
        double* const numbers = row_.data();
        for (std::size_t i = 0; i < width; ++i) {
            if (!text_.more()) {
                if (i == 1 && begins_block(numbers[0])) return false;
                require_plain_separators();
                throw_width(i);
            }
            if (!text_.number(numbers[i]) && !quoted_number(numbers[i]))
                throw Error("line {}: {} is no number", text_.line(), quote(text_.last_token()));
        }
        if (text_.more()) throw_width(width + text_.count_tokens());
        require_plain_separators();
        return true;
    }

    [[noreturn]] void throw_width(std::size_t found) const {
        throw Error("line {}: found {}; the rows before have {}", text_.line(), count_text(found, "column", "columns"),
                    layout_.width);
    }

    bool begins_block(double number) {
        constexpr double most = 1e15;  // whole, and within 64 bits
        if (blocks_.empty() || !(number >= 0 && number <= most) || number != std::trunc(number)) return false;
        check_count();
        blocks_.push_back({static_cast<u64>(number), text_.line(), positions_.size()});
        return true;
    }

    /// Some programs put everything in quotes.
    bool quoted_number(double& value) const {
        const std::string_view token = text_.last_token();
        return token.size() > 2 && token.front() == '"' && token.back() == '"' &&
               parse_number(token.substr(1, token.size() - 2), value);
    }

    /// Of the row as far as it was read.
    void require_plain_separators() const {
        if (text_.has_empty_field() || text_.mixes_separators()) throw_separators();
    }

    [[noreturn]] void throw_separators() const {
        if (text_.has_empty_field())
            throw Error("line {}: a field is empty; every point needs a number in every column", text_.line());
        throw Error("line {}: {} separate some numbers and {} others", text_.line(), text_.mixed_separators().first,
                    text_.mixed_separators().second)
            .hint("if the commas are decimal ones, write points in their place");
    }

    /// Warns when the last block is not as long as its count declares. A PWN file is refused: its count separates
    /// points from normals.
    void check_count() const {
        if (blocks_.empty()) return;
        const Block& block = blocks_.back();
        const std::size_t found = positions_.size() - block.first;
        if (found == block.promised) return;
        if (extension_ == "pwn")
            throw Error("line {} declares {}; {} {}", block.line, count_text(block.promised, "point", "points"), found,
                        by_count(found, "row follows", "rows follow"))
                .hint("the file is truncated or its count is wrong: correct that line");
        warn(options_.on_warning, "line {} declares {}; {} {}: the count is wrong, or the file is incomplete",
             block.line, count_text(block.promised, "point", "points"), found, by_count(found, "follows", "follow"));
    }

    /// The second half of the rows, taken away from them, when the only count says that they are twice as many as there
    /// are points.
    std::optional<Column> normals_behind_points() {
        if (blocks_.size() != 1 || !further_.empty()) return std::nullopt;
        const std::size_t points = blocks_[0].promised;
        if (points == 0 || positions_.size() % 2 != 0 || positions_.size() / 2 != points) return std::nullopt;
        std::array<Array<double>, 3> values;
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t row = points; row < 2 * points; ++row)
                values[axis].push_back(positions_[row][static_cast<Eigen::Index>(axis)]);
        const std::array<const Array<double>*, 3> components{&values[0], &values[1], &values[2]};
        const bool are_unit = are_unit_normals(components);
        if (!are_unit && extension_ != "pwn") return std::nullopt;
        if (!are_unit) warn(options_.on_warning, "not all normals have unit length");
        positions_.resize(points);
        return joined("normal", components);
    }

    ColumnTable columns() {
        std::vector<std::string> names;
        for (const std::size_t place : further_places_)
            if (!layout_.names.empty()) names.push_back(layout_.names[place]);
        ColumnTable table =
            text_columns(std::move(names), std::move(further_), extension_ == "pts", options_.on_warning);
        if (blocks_.size() < 2) return table;
        warn(options_.on_warning, "{} scans were read as one cloud; the column 'scan' tells them apart",
             blocks_.size());
        Array<u32> scans(positions_.size());
        for (std::size_t i = 0; i < blocks_.size(); ++i) {
            const std::size_t end = i + 1 < blocks_.size() ? blocks_[i + 1].first : scans.size();
            for (std::size_t row = blocks_[i].first; row < end; ++row) scans[row] = static_cast<u32>(i);
        }
        table.add(Column("scan", 1, Buffer(std::move(scans))));
        return table;
    }

    TextCursor text_;
    std::size_t size_;
    std::string extension_;
    const ReadOptions& options_;
    TextLayout layout_;
    std::vector<Block> blocks_;
    Array<double> row_;
    Array<Vec3> positions_;
    std::vector<std::size_t> further_places_;  // in a row, of what is not x, y or z
    std::vector<Array<double>> further_;
};

}  // namespace

Recognition recognise_xyz(std::string_view head, u64) {
    const std::string_view text = without_byte_order_mark(head);
    if (are_tagged_points(text)) return Recognition::plausible;
    try {
        TextCursor cursor(text, text_rules);
        read_text_layout(cursor);
        return is_row_of_numbers(cursor) ? Recognition::plausible : Recognition::no;
    } catch (const Error&) {
        return Recognition::no;
    }
}

LoadedFile read_xyz(const FileBytes& file, const ReadOptions& options) {
    const std::string_view text = without_byte_order_mark(file.bytes);
    return are_tagged_points(text) ? read_tagged_points(text, options) : XyzReader(file, text, options).read();
}

}  // namespace scanmill
