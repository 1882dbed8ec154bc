// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <vector>

#include "fuzz/targets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "support/same_points.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

namespace {

/// The stream's points, after checking that pieces, single columns and gather() agree.
PointCloud put_together(const PointStream& stream) {
    std::vector<u32> rows(stream.size());
    std::iota(rows.begin(), rows.end(), 0u);
    PointCloud cloud = stream.gather(rows, 1);
    Array<Vec3> positions, room;
    for (std::size_t piece = 0; piece + 1 < stream.pieces().size(); ++piece) {
        require_law(positions.size() == stream.pieces()[piece], "a piece does not begin where the last one ended");
        stream.read(piece, room);
        positions.insert(positions.end(), room.begin(), room.end());
    }
    require_law(std::ranges::equal(positions, cloud.positions), "gathering gives other points than reading");
    const PointCloud hollow = stream.gather({}, 1);
    for (const Column& column : hollow.columns) {
        std::vector<std::byte> bytes;
        for (std::size_t piece = 0; piece + 1 < stream.pieces().size(); ++piece) {
            const ColumnTable part = stream.read_columns(piece);
            const Buffer<std::byte>& column_bytes = part.find(column.name())->bytes();
            bytes.insert(bytes.end(), column_bytes.begin(), column_bytes.end());
        }
        require_law(std::ranges::equal(bytes, cloud.columns.find(column.name())->bytes()),
                    "a column that is read piece by piece differs");
    }
    return cloud;
}

}  // namespace

bool read_stream(std::string_view extension, std::string_view bytes) {
    static const TemporaryFolder folder;
    const std::filesystem::path path = folder.write("scan." + std::string(extension), bytes);
    std::vector<std::string> warnings, warnings_whole;
    const auto stream =
        open_point_stream(path, {.on_warning = [&](std::string text) { warnings.push_back(std::move(text)); }}, 1);
    if (!stream) return false;
    require_law(may_be_point_stream(path), "a stream of a file that does not begin like one");
    std::shared_ptr<const PointCloud> whole;
    try {
        whole = read_points(path, {.on_warning = [&](std::string text) { warnings_whole.push_back(std::move(text)); }});
    } catch (const Error& error) {
        throw LawBroken("a stream of a file that cannot be read: " + error.sentence());
    }
    require_law(warnings == warnings_whole, "opening a stream gives other warnings than reading");
    const PointCloud streamed = put_together(*stream);
    require_law(same_points(streamed, *whole), "the stream's points differ from those that are read");
    const BoundingBox box = bounding_box(whole->positions.span());
    require_law(stream->bounds().low == box.low && stream->bounds().high == box.high, "the bounds are not the points'");
    return true;
}

}  // namespace scanmill::test
