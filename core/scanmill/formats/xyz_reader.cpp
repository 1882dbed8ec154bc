// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <cmath>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/quantity.hpp"
#include "scanmill/formats/reading.hpp"
#include "scanmill/formats/text_cursor.hpp"
#include "scanmill/formats/xyz.hpp"

namespace scanmill {

namespace {

constexpr TextRules rules{.commas = true, .comment = '#'};
constexpr std::size_t most_columns = 1000;

std::vector<std::string_view> tokens_of_row(TextCursor row) {
    std::vector<std::string_view> tokens;
    while (row.more() && tokens.size() <= most_columns) tokens.push_back(row.token());
    return tokens;
}

bool is_number(std::string_view token) {
    double ignored = 0;
    return parse_number(token, ignored);
}

/// A name without its quotes.
std::string_view unquoted(std::string_view name) {
    if (name.size() >= 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front())
        return name.substr(1, name.size() - 2);
    return name;
}

bool names_axis(std::string_view name, char axis) {
    return name.size() == 1 && std::tolower(static_cast<unsigned char>(name[0])) == axis;
}

/// Whether three components per row are lengths of about one, or zero where there is no normal.
bool are_unit(const std::vector<Array<double>>& columns) {
    constexpr double tolerance = 0.1;
    for (std::size_t row = 0; row < columns[0].size(); ++row) {
        const double length = std::hypot(columns[0][row], columns[1][row], columns[2][row]);
        if (std::abs(length - 1) > tolerance && length != 0) return false;
    }
    return true;
}

class XyzReader {
public:
    XyzReader(const FileBytes& file, const ReadOptions& options)
        : text_(without_byte_order_mark(file.bytes), rules),
          size_(file.bytes.size()),
          options_(options) {}

    LoadedFile read() {
        begin();
        read_rows();
        LoadedFile loaded;
        loaded.format = "XYZ";
        loaded.encoding = "ascii";
        loaded.comments = text_.comments();
        PointCloud cloud;
        cloud.frame = declared_frame(loaded.comments, options_);
        move_near_origin(positions_, bounding_box(positions_), cloud.frame);
        cloud.positions = std::move(positions_);
        cloud.columns = columns();
        loaded.value = std::make_shared<const PointCloud>(std::move(cloud));
        return loaded;
    }

private:
    /// Finds the first row of numbers; what comes before it may be a count and names.
    void begin() {
        if (!text_.next_row()) throw Error("holds no points: nothing but blanks and comments");
        std::vector<std::string_view> tokens = tokens_of_row(text_);
        if (tokens.size() == 1 && text_.number(promised_)) {
            counted_ = true;
            if (!text_.next_row()) throw Error("holds no points: its only line is a count");
            tokens = tokens_of_row(text_);
        }
        if (std::ranges::none_of(tokens, is_number)) {
            read_names(tokens);
            if (!text_.next_row()) throw Error("holds no points: its only line has the columns' names");
            tokens = tokens_of_row(text_);
        }
        width_ = tokens.size();
        if (width_ < 3)
            throw Error("line {}: found {}; a point has at least the three numbers x, y and z", text_.line(),
                        counted(width_, "column", "columns"));
        if (width_ > most_columns) throw Error("line {}: more than {} columns", text_.line(), most_columns);
        if (!names_.empty() && names_.size() != width_)
            throw Error("line {}: {} for {} names", text_.line(), counted(width_, "column", "columns"), names_.size());
    }

    void read_names(const std::vector<std::string_view>& tokens) {
        constexpr std::string_view axes = "xyz";
        for (std::size_t i = 0; i < axes.size(); ++i)
            if (tokens.size() <= i || !names_axis(unquoted(tokens[i]), axes[i]))
                throw Error("line {}: {} is neither a row of numbers nor names that begin with x, y, z", text_.line(),
                            quote(tokens.front()));
        for (std::string_view token : tokens) names_.emplace_back(unquoted(token));
    }

    void read_rows() {
        // A row takes at least two bytes per number: the file's size bounds what may be reserved.
        constexpr std::size_t usual_number_text = 8;
        const std::size_t guess = size_ / (usual_number_text * width_) + 1;
        positions_.reserve(guess);
        further_.resize(width_ - 3);
        for (Array<double>& column : further_) column.reserve(guess);
        do {
            Vec3 p;
            for (std::size_t i = 0; i < width_; ++i) {
                double value = 0;
                if (!text_.more()) {
                    require_plain_separators();
                    throw Error("line {}: found {}; the rows before have {}", text_.line(),
                                counted(i, "column", "columns"), width_);
                }
                if (!text_.number(value))
                    throw Error("line {}: {} is no number", text_.line(), quote(text_.last_token()));
                if (i < 3)
                    p[static_cast<Eigen::Index>(i)] = value;
                else
                    further_[i - 3].push_back(value);
            }
            if (text_.more())
                throw Error("line {}: found {}; the rows before have {}", text_.line(),
                            counted(width_ + text_.count_tokens(), "column", "columns"), width_);
            require_plain_separators();
            positions_.push_back(p);
        } while (text_.next_row());
        require_countable(positions_.size(), "points");
        if (counted_ && promised_ != positions_.size())
            throw Error("its first line promises {} points; {} follow", promised_, positions_.size())
                .hint("the file is truncated or its count is wrong: correct or remove the first line");
    }

    /// Of the row as far as it was read.
    void require_plain_separators() const {
        if (text_.has_empty_field())
            throw Error("line {}: a field is empty; every point needs a number in every column", text_.line());
        if (text_.mixes_separators())
            throw Error("line {}: commas separate some numbers and blanks others", text_.line())
                .hint("if the commas are decimal ones, write points in their place");
    }

    ColumnTable columns() {
        ColumnTable table;
        if (names_.empty() && further_.size() == 3) {
            if (are_unit(further_)) {
                Array<double> normals(3 * positions_count());
                for (std::size_t row = 0; row < positions_count(); ++row)
                    for (std::size_t axis = 0; axis < 3; ++axis) normals[3 * row + axis] = further_[axis][row];
                table.add(Column("normal", 3, Buffer(std::move(normals))));
                return table;
            }
            warn(options_.on_warning, "columns 4 to 6 are no unit normals; they are kept as c4, c5 and c6");
        }
        for (std::size_t i = 0; i < further_.size(); ++i)
            table.add(Column(names_.empty() ? "c" + std::to_string(i + 4) : names_[i + 3], 1,
                             Buffer(std::move(further_[i]))));
        return table;
    }

    std::size_t positions_count() const { return further_.front().size(); }

    TextCursor text_;
    std::size_t size_;
    const ReadOptions& options_;
    bool counted_ = false;
    u64 promised_ = 0;
    std::vector<std::string> names_;
    std::size_t width_ = 0;
    Array<Vec3> positions_;
    std::vector<Array<double>> further_;
};

}  // namespace

Recognition recognise_xyz(std::string_view head, u64) {
    TextCursor text(without_byte_order_mark(head), rules);
    if (!text.next_row()) return Recognition::no;
    const std::vector<std::string_view> tokens = tokens_of_row(text);
    const bool numbers = tokens.size() >= 3 && std::ranges::all_of(tokens, is_number);
    return numbers ? Recognition::plausible : Recognition::no;
}

LoadedFile read_xyz(const FileBytes& file, const ReadOptions& options) { return XyzReader(file, options).read(); }

}  // namespace scanmill
