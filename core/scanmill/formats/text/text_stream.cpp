// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/base/parallel.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_layout.hpp"
#include "scanmill/formats/text/text.hpp"

namespace scanmill {

namespace {

/// No row is shorter than the shortest three numbers and a line's end.
constexpr std::size_t most_rows = std::size_t(1) << 16, shortest_row = std::string_view("1 2 3\n").size();
constexpr std::size_t piece_size = std::size_t(1) << 18;
/// A text whose lines end otherwise than with LF is one long line to us.
constexpr std::size_t longest_piece = most_rows * shortest_row;

/// Thrown and caught here: something in the text needs a word, which whoever reads it whole has.
struct Unusual {};

/// The point of the cursor's row. Throws Unusual for a row of other than three numbers, separated alike.
Vec3 parse_row(TextCursor& text, const std::array<std::size_t, 3>& axes) {
    std::array<double, 3> row;
    for (double& number : row)
        if (!text.more() || !text.number(number)) throw Unusual{};
    if (text.more() || text.has_empty_field() || text.mixes_separators()) throw Unusual{};
    return {row[axes[0]], row[axes[1]], row[axes[2]]};
}

/// Whether there is nothing to be said of the columns, nor any beside x, y and z.
bool is_streamed(const TextLayout& layout) {
    return layout.width == 3 && !layout.promised && layout.passed_over.empty() && layout.unread_comments == 0;
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
        if (!look_over(threads, on_positions)) return false;
        frame_ = declared_frame(comments_.texts(), options);
        choose_origin();
        return true;
    }

    /// A streamed text has only its three coordinates.
    ColumnTable read_columns(std::size_t) const override { return {}; }

private:
    bool cut(std::string_view text) {
        while (!text.empty()) {
            const std::size_t line_end = text.size() > piece_size ? text.find('\n', piece_size) : text.npos;
            const std::size_t size = line_end == text.npos ? text.size() : line_end + 1;
            if (size > longest_piece) return false;
            texts_.push_back(text.substr(0, size));
            file_->release(texts_.back());  // looking for a line's end may have mapped megabytes around it
            text.remove_prefix(size);
        }
        return true;
    }

    /// False when a coordinate is not finite, or there are more rows than can be numbered.
    bool look_over(unsigned threads, const OnWorldPositions& on_positions) {
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

    /// Nothing was unusual when the text was looked over: if something is now, the text is another.
    template <class Reading>
    static void as_before(Reading&& reading) {
        try {
            reading();
        } catch (const Unusual&) {
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
        as_before([&] { parse(piece, room); });
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
            as_before([&] {
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
    std::vector<std::string_view> texts_;  // of the pieces
    KeptComments comments_;
};

}  // namespace

bool may_be_text_stream(std::string_view file) {
    TextCursor cursor(without_byte_order_mark(file), text_rules);
    return is_streamed(read_text_layout(cursor));
}

std::unique_ptr<PointStream> open_text_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                              unsigned threads, const OnWorldPositions& on_positions) {
    try {
        auto stream = std::make_unique<TextStream>(std::move(file));
        if (stream->open(options, threads, on_positions)) return stream;
    } catch (const Unusual&) {
    }
    return nullptr;
}

}  // namespace scanmill
