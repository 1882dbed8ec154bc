// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <ranges>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/text_columns.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill {

namespace {

// Hoppe's points: rows that begin with a letter.

constexpr TextRules tagged_rules{.comment = '#'};

bool is_tag(std::string_view word) { return word.size() == 1 && std::isalpha(static_cast<unsigned char>(word[0])); }

/// Whether the text's first row is one of the letters p, d, s and g, followed by three numbers.
bool has_tagged_points(std::string_view text) {
    TextCursor cursor(text, tagged_rules);
    if (!cursor.next_row()) return false;
    const std::string_view tag = cursor.token();
    return is_tag(tag) && std::string_view("pdsg").find(tag) != std::string_view::npos && cursor.count_tokens() == 3 &&
           is_row_of_numbers(cursor);
}

/// Reads the rows that begin with p as points. Throws Error with the line for a row that does not begin with a single
/// letter, and for a point without three numbers.
LoadedFile read_tagged_points(std::string_view text, const ReadOptions& options) {
    TextCursor cursor(text, tagged_rules);
    Array<Vec3> positions;
    u64 others = 0;
    while (cursor.next_row()) {
        const std::string_view tag = cursor.token();
        if (!is_tag(tag))
            throw Error("line {}: {} is not a letter for the row's content, such as p for a point", cursor.line(),
                        quote(tag));
        if (tag != "p") {
            ++others;
            continue;
        }
        if (const std::size_t found = cursor.count_tokens(); found != 3)
            throw Error("line {}: a point has three numbers, here are {}", cursor.line(), found);
        Vec3& p = positions.emplace_back();
        for (double& coordinate : p) coordinate = next_number(cursor, "a point");
    }
    if (positions.empty()) throw Error("holds no points: no row begins with p");
    require_countable(positions.size(), "points");
    if (others > 0)
        warn(options.on_warning, "{} not begin with p and were left out", count_text(others, "row does", "rows do"));
    return loaded_file("XYZ", "ascii", cursor.comments().texts(), std::move(positions), {}, options);
}

class XyzReader {
public:
    /// `decimal_commas` contains the row that shows that the text has decimal commas.
    XyzReader(const FileBytes& file, std::string_view text, const ReadOptions& options,
              std::optional<DecimalCommas> decimal_commas = {})
        : text_(text, decimal_commas ? decimal_comma_rules : text_rules),
          decimal_commas_(decimal_commas),
          size_(text.size()),
          extension_(extension_of(file.path)),
          options_(options) {}

    LoadedFile read() {
        layout_ = read_text_layout(text_);
        if (!layout_.ignored_names.empty())
            warn(options_.on_warning, "the comment {} was ignored: it does not name x, y, z and then the rest of {}",
                 quote(layout_.ignored_names), count_text(layout_.width, "column", "columns"));
        read_rows();
        check_count();
        require_countable(positions_.size(), "points");
        warn_of_commas();
        TriangleMesh vertices;
        vertices.vertex_columns = columns();
        return loaded_file("XYZ", "ascii", text_.comments().texts(), std::move(positions_), std::move(vertices),
                           options_);
    }

private:
    void read_rows() {
        // A row takes at least two bytes per number, so the file's size bounds the reserved memory.
        constexpr std::size_t usual_number_text = 8;
        const std::size_t guess = size_ / (usual_number_text * layout_.width) + 1;
        positions_.reserve(guess);
        for (std::size_t i = 0; i < layout_.width; ++i)
            if (std::ranges::find(layout_.axes, i) == layout_.axes.end()) further_columns_.push_back(i);
        further_.resize(further_columns_.size());
        for (Array<double>& column : further_) column.reserve(guess);
        row_.resize(layout_.width);
        do {
            read_row();
            const auto [x, y, z] = layout_.axes;
            positions_.push_back({row_[x], row_[y], row_[z]});
            for (std::size_t i = 0; i < further_.size(); ++i) further_[i].push_back(row_[further_columns_[i]]);
        } while (text_.next_row());
    }

    /// Fills row_.
    void read_row() {
        const std::string_view rest = text_.rest();
        const std::size_t width = row_.size();
        double* const numbers = row_.data();
        for (std::size_t i = 0; i < width; ++i) {
            if (!text_.more()) {
                require_equal_separators(rest);
                throw_width(i);
            }
            if (!text_.number(numbers[i])) throw_not_a_number(rest);
        }
        if (text_.more()) {
            refuse_decimal_commas(rest);
            throw_width(width + text_.count_tokens());
        }
        require_equal_separators(rest);
        has_commas_ = text_.has_commas();
    }

    /// Throws DecimalCommas if the current row shows that the text has decimal commas. `rest` is the text from the row
    /// on.
    void refuse_decimal_commas(std::string_view rest) const {
        if (!decimal_commas_) require_no_decimal_commas(rest, text_.line());
    }

    [[noreturn]] void throw_not_a_number(std::string_view rest) const {
        refuse_decimal_commas(rest);
        const std::string_view token = text_.last_token();
        if (decimal_commas_ && token.find('.') != std::string_view::npos)
            throw Error("line {}: {} has a decimal point, and line {} has decimal commas", text_.line(), quote(token),
                        decimal_commas_->line)
                .hint("write all numbers with decimal points");
        throw Error("line {}: {} is not a number", text_.line(), quote(token));
    }

    /// Warns if the commas may be decimal commas: "1,5,2,5,3,5" may be six numbers or three.
    void warn_of_commas() const {
        if (!has_commas_ || layout_.width <= 3 || !layout_.names.empty()) return;
        const auto is_whole = [](double number) { return number == std::trunc(number); };
        const auto all_whole = [&](const auto& numbers) { return std::ranges::all_of(numbers, is_whole); };
        if (!std::ranges::all_of(positions_, all_whole) || !std::ranges::all_of(further_, all_whole)) return;
        warn(
            options_.on_warning,
            "commas separate {} numbers in a row, and no number has a decimal point; if the commas are decimal commas, "
            "separate the numbers with semicolons, else name the columns in a first line, such as x,y,z,intensity",
            layout_.width);
    }

    [[noreturn]] void throw_width(std::size_t found) const {
        Error error("line {}: found {}; the rows before have {}", text_.line(), count_text(found, "column", "columns"),
                    layout_.width);
        if (found == 1 && layout_.declared_points)
            error.set_hint("if another scan begins there, with its number of points, write it into a file of its own");
        throw error;
    }

    /// Throws Error if the part of the row that was read has an empty field or different separators.
    void require_equal_separators(std::string_view rest) const {
        if (text_.has_empty_field() || text_.mixes_separators()) refuse_decimal_commas(rest);
        if (text_.has_empty_field())
            throw Error("line {}: a field is empty; every point needs a number in every column", text_.line());
        if (text_.mixes_separators())
            throw Error("line {}: the numbers have different separators", text_.line())
                .hint("separate all numbers by the same character");
    }

    /// Warns when the number of points differs from the declared one. Normals that follow the points are refused.
    void check_count() const {
        const std::size_t found = positions_.size(), declared = layout_.declared_points.value_or(found);
        if (found == declared) return;
        const auto is_normal = [](const Vec3& row) { return std::abs(row.norm() - 1) < 0.1; };
        if (extension_ == "pwn" ||
            (found == 2 * declared && std::ranges::all_of(positions_ | std::views::drop(declared), is_normal)))
            throw Error("line {} declares {}; {} {}", layout_.declared_in_line, count_text(declared, "point", "points"),
                        found, by_count(found, "row follows", "rows follow"))
                .hint(
                    "if normals follow the points, write the normal of each point behind its coordinates; else "
                    "correct that line");
        warn(options_.on_warning, "line {} declares {}; {} {}: the count is wrong, or the file is incomplete",
             layout_.declared_in_line, count_text(declared, "point", "points"), found,
             by_count(found, "follows", "follow"));
    }

    ColumnTable columns() {
        std::vector<std::string> names;
        for (const std::size_t column : further_columns_)
            if (!layout_.names.empty()) names.push_back(layout_.names[column]);
        return text_columns(std::move(names), std::move(further_), extension_ == "pts", options_.on_warning);
    }

    TextCursor text_;
    std::optional<DecimalCommas> decimal_commas_;
    bool has_commas_ = false;  // between the numbers of the last row
    std::size_t size_;
    std::string extension_;
    const ReadOptions& options_;
    TextLayout layout_;
    Array<double> row_;
    Array<Vec3> positions_;
    std::vector<std::size_t> further_columns_;  // the columns of a row except x, y and z
    std::vector<Array<double>> further_;
};

Recognition recognise(std::string_view head, u64) {
    const std::string_view text = without_byte_order_mark(head);
    if (has_tagged_points(text)) return Recognition::plausible;
    try {
        TextCursor cursor(text, text_rules);
        read_text_layout(cursor);
        return is_row_of_numbers(cursor) ? Recognition::plausible : Recognition::no;
    } catch (const DecimalCommas&) {
        return Recognition::plausible;
    } catch (const Error&) {
        return Recognition::no;
    }
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) {
    const std::string_view text = without_byte_order_mark(file.bytes);
    if (has_tagged_points(text)) return read_tagged_points(text, options);
    std::vector<std::string> warnings;  // discarded if the text has decimal commas
    try {
        ReadOptions kept = options;
        kept.on_warning = [&](std::string sentence) { warnings.push_back(std::move(sentence)); };
        LoadedFile loaded = XyzReader(file, text, kept).read();
        for (std::string& sentence : warnings) warn(options.on_warning, "{}", std::move(sentence));
        return loaded;
    } catch (const DecimalCommas& found) {
        return XyzReader(file, text, options, found).read();
    }
}

/// No row is shorter than three digits with separators and a line end.
constexpr std::size_t most_rows = std::size_t(1) << 16, shortest_row = std::string_view("1 2 3\n").size();
constexpr std::size_t piece_size = std::size_t(1) << 18;
/// The largest size of a piece. A larger piece contains a line that is too long, so the text is not streamed.
constexpr std::size_t longest_piece = most_rows * shortest_row;

/// Thrown and caught in this file, for content that the reader of whole files refuses or warns about.
struct NotStreamable {};

/// The point of the cursor's row. Throws NotStreamable unless the row is three numbers with equal separators.
Vec3 parse_row(TextCursor& text, const std::array<std::size_t, 3>& axes) {
    std::array<double, 3> row;
    for (double& number : row)
        if (!text.more() || !text.number(number)) throw NotStreamable{};
    if (text.more() || text.has_empty_field() || text.mixes_separators()) throw NotStreamable{};
    return {row[axes[0]], row[axes[1]], row[axes[2]]};
}

/// Whether the columns are only x, y and z, without a reason for a warning.
bool is_streamed(const TextLayout& layout) {
    return layout.width == 3 && !layout.declared_points && layout.ignored_names.empty();
}

class TextStream : public PointStream {
public:
    explicit TextStream(std::unique_ptr<MappedFile> file) : file_(std::move(file)) {}

    bool open(const ReadOptions& options, unsigned threads, const OnWorldPositions& on_positions) {
        const std::string_view text = without_byte_order_mark(file_->bytes());
        TextCursor cursor(text, text_rules);
        const TextLayout layout = read_text_layout(cursor);
        if (!is_streamed(layout)) return false;
        axes_ = layout.axes;
        comments_ = cursor.comments();
        std::size_t first_row = static_cast<std::size_t>(TextCursor(cursor).token().data() - text.data());
        while (first_row > 0 && text[first_row - 1] != '\n' && text[first_row - 1] != '\r') --first_row;
        if (!cut(text.substr(first_row))) return false;
        if (!read_all(threads, on_positions)) return false;
        frame_ = declared_frame(comments_.texts(), options);
        choose_origin();
        return true;
    }

    /// A streamed text has only its three coordinates.
    ColumnTable read_columns(std::size_t) const override { return {}; }

private:
    /// Divides the text into pieces. Returns false if a line is too long.
    bool cut(std::string_view text) {
        while (!text.empty()) {
            const std::size_t line_end = text.size() > piece_size ? text.find('\n', piece_size) : text.npos;
            const std::size_t size = line_end == text.npos ? text.size() : line_end + 1;
            if (size > longest_piece) return false;
            texts_.push_back(text.substr(0, size));
            file_->release(texts_.back());  // the search for a line end may have mapped megabytes around it
            text.remove_prefix(size);
        }
        return true;
    }

    /// Computes pieces_ and world_. Returns false if a coordinate is not finite, or if there are too many rows.
    bool read_all(unsigned threads, const OnWorldPositions& on_positions) {
        struct Room {
            Array<Vec3> positions;
            FiniteBounds bounds;
            KeptComments comments;
        };
        std::size_t rows = 0;
        for_each_in_order<Room>(
            threads, texts_.size(),
            [&](std::size_t piece, Room& room) {
                room.comments = parse(piece, room.positions).comments();
                room.bounds = finite_bounds(room.positions);
            },
            [&](std::size_t, Room& room) {
                world_.add(room.bounds);
                pieces_.push_back(rows);
                rows += room.positions.size();
                comments_.append(room.comments);
                if (on_positions) on_positions(room.positions);
            });
        pieces_.push_back(rows);
        return world_.finite && rows <= ~u32(0);
    }

    /// Calls `read` on content that was streamable when the file was opened. If it no longer is, throws the Error for a
    /// file that has changed.
    template <class Read>
    static void reread(Read&& read) {
        try {
            read();
        } catch (const NotStreamable&) {
            throw_changed();
        }
    }

    TextCursor parse(std::size_t piece, Array<Vec3>& room) const {
        room.clear();
        file_->fetch(texts_[piece]);
        TextCursor cursor(texts_[piece], text_rules);
        while (cursor.next_row()) room.push_back(parse_row(cursor, axes_));
        file_->release(texts_[piece]);
        return cursor;
    }

    FiniteBounds read_world(std::size_t piece, Array<Vec3>& room) const override {
        reread([&] { parse(piece, room); });
        return finite_bounds(room);
    }

    PointCloud gather_world(std::span<const u32> rows, unsigned threads) const override {
        Array<Vec3> positions(rows.size());
        for_each_chunk(threads, texts_.size(), 1, [&](std::size_t piece, std::size_t) {
            const auto begin = std::ranges::lower_bound(rows, pieces_[piece]);
            const auto end = std::ranges::lower_bound(rows, pieces_[piece + 1]);
            if (begin == end) return;
            file_->fetch(texts_[piece]);
            TextCursor cursor(texts_[piece], text_rules);
            std::size_t row = pieces_[piece];
            reread([&] {
                for (auto kept = begin; kept != end; ++row) {
                    cursor.next_row();
                    if (*kept == row)
                        positions[static_cast<std::size_t>(kept++ - rows.begin())] = parse_row(cursor, axes_);
                }
            });
            file_->release(texts_[piece]);
        });
        PointCloud cloud;
        cloud.positions = std::move(positions);
        return cloud;
    }

    std::unique_ptr<MappedFile> file_;
    std::array<std::size_t, 3> axes_{0, 1, 2};
    std::vector<std::string_view> texts_;  // the text of every piece
    KeptComments comments_;
};

bool may_stream(std::string_view file) try {
    TextCursor cursor(without_byte_order_mark(file), text_rules);
    return is_streamed(read_text_layout(cursor));
} catch (const DecimalCommas&) {
    return false;
}

std::unique_ptr<PointStream> open_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options, unsigned threads,
                                         const OnWorldPositions& on_positions) {
    try {
        auto stream = std::make_unique<TextStream>(std::move(file));
        if (stream->open(options, threads, on_positions)) return stream;
    } catch (const NotStreamable&) {
    } catch (const DecimalCommas&) {
    }
    return nullptr;
}

void write(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    const Column* const normal = TextColumns(cloud.columns).normal;
    warn_lost_precision(cloud.frame, cloud.positions.span(), false, "XYZ", options);
    std::vector<std::string_view> kept;
    if (normal) kept.push_back(normal->name());
    warn_left_out(cloud.columns, "points", "XYZ", options, kept);

    out.text(comment_lines(cloud.frame));
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        put_position(cloud.frame, cloud.positions[row], out);
        if (normal) put_row_text(*normal, row, out);
        out.text("\n");
    }
}

}  // namespace

std::vector<Format> text_formats() {
    Format xyz{"XYZ", {"xyz", "txt"}, recognise, read, {{kind_of<PointCloud>(), write}}};
    xyz.memory_per_byte = 5;
    xyz.may_stream = may_stream;
    xyz.open_stream = open_stream;
    // Files with these extensions are not written, because other programs expect commas, a count or normals in them.
    Format csv = xyz;
    csv.name = "CSV";
    csv.extensions = {"csv", "pts", "pwn", "asc"};
    csv.writers.clear();
    return {xyz, csv};
}

}  // namespace scanmill
