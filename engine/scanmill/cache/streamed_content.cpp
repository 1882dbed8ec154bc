// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/streamed_content.hpp"

#include <optional>

#include "scanmill/base/parallel.hpp"
#include "scanmill/cache/value_fields.hpp"

namespace scanmill {

namespace {

/// The stream's cloud with every size right and nothing behind it.
PointCloud hollow_cloud(const PointStream& stream) {
    PointCloud cloud;
    cloud.frame = stream.frame();
    cloud.positions = Buffer<Vec3>(nullptr, nullptr, stream.size());
    const PointCloud without_rows = stream.gather({}, 1);
    for (const Column& column : without_rows.columns) {
        const std::size_t bytes = stream.size() * column.components() * size_of(column.type());
        cloud.columns.add(
            Column(column.name(), column.type(), column.components(), Buffer<std::byte>(nullptr, nullptr, bytes), {}));
    }
    return cloud;
}

std::size_t piece_count(const PointStream& stream) { return stream.pieces().size() - 1; }

void add_positions(const PointStream& stream, unsigned threads, const std::function<void()>& on_piece,
                   ArraysHash& hash) {
    for_each_in_order<Array<Vec3>>(
        threads, piece_count(stream), [&](std::size_t piece, Array<Vec3>& room) { stream.read(piece, room); },
        [&](std::size_t, const Array<Vec3>& positions) {
            if (on_piece) on_piece();
            hash.add(std::as_bytes(std::span(positions)));
        });
}

void add_column(const PointStream& stream, const std::string& name, unsigned threads,
                const std::function<void()>& on_piece, ArraysHash& hash) {
    for_each_in_order<std::optional<Column>>(
        threads, piece_count(stream),
        [&](std::size_t piece, std::optional<Column>& room) { room = stream.read_column(piece, name); },
        [&](std::size_t, const std::optional<Column>& room) {
            if (on_piece) on_piece();
            hash.add(room->bytes().span());
        });
}

}  // namespace

ValueName StreamedContent::of(const PointStream& stream, unsigned threads, const std::function<void()>& on_piece) {
    ArraysHash hash = std::move(positions_);
    if (stream.frame().origin != Vec3::Zero()) {
        hash = {};
        add_positions(stream, threads, on_piece, hash);
    }
    hash.end_array();
    const PointCloud hollow = hollow_cloud(stream);
    for (const Column& column : hollow.columns) {
        add_column(stream, column.name(), threads, on_piece, hash);
        hash.end_array();
    }
    return name_of_value(fields_of(std::make_shared<const PointCloud>(hollow)), hash);
}

}  // namespace scanmill
