// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/base/parallel.hpp"
#include "scanmill/formats/ply/detail/ply_elements.hpp"

namespace scanmill {

namespace {

constexpr std::size_t rows_per_piece = std::size_t(1) << 16;

class PlyStream : public PointStream {
public:
    PlyStream(std::unique_ptr<MappedFile> file, PlyHeader header)
        : file_(std::move(file)),
          header_(std::move(header)),
          vertex_(header_.elements.front()),
          row_size_(vertex_.row_size()) {
        rows_ = file_->bytes().substr(header_.size, vertex_.count * row_size_);
        for (std::size_t row = 0; row < vertex_.count; row += rows_per_piece) pieces_.push_back(row);
        pieces_.push_back(vertex_.count);
    }

    bool open(const ReadOptions& options, unsigned threads, const OnWorldPositions& on_positions) {
        if (!read_all(threads, on_positions)) return false;
        frame_ = declared_frame(header_.comments, options);
        choose_origin();
        return true;
    }

    ColumnTable read_columns(std::size_t piece) const override {
        PlyElement part = vertex_;
        part.count = pieces_[piece + 1] - pieces_[piece];
        PlyTable table(part, header_.comments, ply_axes);
        const std::string_view rows = bytes_of(pieces_[piece], part.count);
        file_->fetch(rows);
        decode(rows, table.slots());
        file_->release(rows);
        return table.columns();
    }

private:
    /// Computes world_. Returns false if a coordinate is not finite.
    bool read_all(unsigned threads, const OnWorldPositions& on_positions) {
        struct Room {
            Array<Vec3> positions;
            FiniteBounds bounds;
        };
        for_each_in_order<Room>(
            threads, pieces_.size() - 1,
            [&](std::size_t piece, Room& room) { room.bounds = read_world(piece, room.positions); },
            [&](std::size_t, const Room& room) {
                world_.add(room.bounds);
                if (on_positions) on_positions(room.positions);
            });
        return world_.finite;
    }

    std::string_view bytes_of(std::size_t first, std::size_t count) const {
        return rows_.substr(first * row_size_, count * row_size_);
    }

    void decode(std::string_view rows, std::span<const PlySlot> slots) const {
        PlyElement part = vertex_;
        part.count = rows.size() / row_size_;
        decode_ply_binary(rows, header_.size, part, header_.encoding == PlyEncoding::binary_big_endian, slots);
    }

    FiniteBounds read_world(std::size_t piece, Array<Vec3>& room) const override {
        const std::size_t first = pieces_[piece], count = pieces_[piece + 1] - first;
        const std::string_view rows = bytes_of(first, count);
        file_->fetch(rows);
        room.resize(count);
        std::optional<FiniteBounds> bounds = widen_packed_positions(rows, vertex_, header_.encoding, room);
        if (!bounds) {
            std::vector<PlySlot> slots;
            for (const PlyProperty& property : vertex_.properties) slots.push_back({.property = &property});
            place_axes(slots, room.data());
            decode(rows, slots);
            bounds = finite_bounds(room);
        }
        file_->release(rows);
        return *bounds;
    }

    /// The bytes of these rows. Rows that are far apart load as many pages as all rows, so pages are released after
    /// each stretch.
    Array<char> picked_bytes(std::span<const u32> rows) const {
        constexpr std::size_t longest_stretch = std::size_t(1) << 20;
        Array<char> picked(rows.size() * row_size_);
        char* destination = picked.data();
        u32 first = rows.front();
        for (const u32 row : rows) {
            if ((row - first) * row_size_ > longest_stretch) {
                file_->release(bytes_of(first, row - first));
                first = row;
            }
            destination = std::ranges::copy(bytes_of(row, 1), destination).out;
        }
        file_->release(bytes_of(first, rows.back() - first + 1));
        return picked;
    }

    PointCloud gather_world(std::span<const u32> rows, unsigned threads) const override {
        PlyElement kept = vertex_;
        kept.count = rows.size();
        PlyTable table(kept, header_.comments, ply_axes);
        Array<Vec3> positions(rows.size());
        if (!rows.empty()) place_axes(table.slots(), positions.data());
        constexpr std::size_t block = 1 << 14;
        for_each_chunk(threads, rows.size(), block, [&](std::size_t begin, std::size_t end) {
            std::vector<PlySlot> slots(table.slots().begin(), table.slots().end());
            for (PlySlot& slot : slots)
                if (slot.destination) slot.destination += begin * slot.stride;
            const Array<char> picked = picked_bytes(rows.subspan(begin, end - begin));
            decode({picked.data(), picked.size()}, slots);
        });
        PointCloud cloud;
        cloud.positions = std::move(positions);
        cloud.columns = table.columns();
        return cloud;
    }

    std::unique_ptr<MappedFile> file_;
    PlyHeader header_;
    const PlyElement& vertex_;
    std::size_t row_size_;
    std::string_view rows_;
};

/// Whether the file contains all its vertices, and after them only line ends. Reading such a file gives no warning
/// about its content.
bool holds_only_vertices(std::string_view file, const PlyHeader& header) {
    if (header.encoding == PlyEncoding::ascii || header.elements.empty()) return false;
    const PlyElement& vertex = header.elements.front();
    if (vertex.name != "vertex" || vertex.count == 0 || vertex.count > ~u32(0) || vertex.has_lists()) return false;
    if (!std::ranges::all_of(ply_axes, [&](std::string_view axis) { return vertex.find(axis); })) return false;
    const auto has_rows = [](const PlyElement& element) { return element.count > 0; };
    if (std::any_of(header.elements.begin() + 1, header.elements.end(), has_rows)) return false;
    const std::string_view body = file.substr(header.size);
    return body.size() / vertex.row_size() >= vertex.count &&
           body.substr(vertex.count * vertex.row_size()).find_first_not_of("\r\n") == std::string_view::npos;
}

}  // namespace

bool may_be_ply_stream(std::string_view file) { return holds_only_vertices(file, parse_ply_header(file)); }

std::unique_ptr<PointStream> open_ply_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions) {
    PlyHeader header = parse_ply_header(file->bytes());
    if (!holds_only_vertices(file->bytes(), header)) return nullptr;
    auto stream = std::make_unique<PlyStream>(std::move(file), std::move(header));
    if (!stream->open(options, threads, on_positions)) return nullptr;
    return stream;
}

}  // namespace scanmill
