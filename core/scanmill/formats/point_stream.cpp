// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/point_stream.hpp"

#include <algorithm>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/parallel.hpp"
#include "scanmill/formats/format.hpp"
#include "scanmill/formats/point_stream_kinds.hpp"

namespace scanmill {

PointStream::~PointStream() = default;

void PointStream::read(std::size_t piece, Array<Vec3>& room) const {
    read_world(piece, room);
    if (frame_.origin == Vec3::Zero()) return;
    for (Vec3& p : room) p -= frame_.origin;
}

PointCloud PointStream::gather(std::span<const u32> rows, unsigned threads) const {
    PointCloud cloud = gather_world(rows, threads);
    cloud.frame = frame_;
    if (frame_.origin != Vec3::Zero()) cloud.positions = translated(cloud.positions, -frame_.origin);
    return cloud;
}

PieceBounds::PieceBounds(std::span<const Vec3> positions) {
    Vec3 zero = Vec3::Zero();  // unless some x * 0 is NaN
    for (const Vec3& p : positions) {
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
        zero += p * 0.0;
    }
    finite = zero == Vec3::Zero();
}

bool PointStream::look_over(unsigned threads) {
    const std::size_t count = pieces_.size() - 1;
    std::vector<PieceBounds> found(count, PieceBounds({}));
    for_each_chunk(threads, count, pieces_at_once, [&](std::size_t begin, std::size_t end) {
        Array<Vec3> room;
        for (std::size_t piece = begin; piece < end; ++piece) {
            read_world(piece, room);
            found[piece] = PieceBounds(room);
        }
    });
    for (const PieceBounds& piece : found) {
        bounds_.low = bounds_.low.cwiseMin(piece.box.low);
        bounds_.high = bounds_.high.cwiseMax(piece.box.high);
    }
    frame_.origin = distant_origin(bounds_);
    bounds_.low -= frame_.origin;
    bounds_.high -= frame_.origin;
    return std::ranges::all_of(found, &PieceBounds::finite);
}

std::unique_ptr<PointStream> open_point_stream(const std::filesystem::path& path, const ReadOptions& options,
                                               unsigned threads) {
    ReadOptions named = options;
    if (options.on_warning)
        named.on_warning = [&](std::string text) { options.on_warning("'" + path.string() + "': " + text); };
    try {
        auto file = std::make_unique<MappedFile>(path, false);
        const std::string& format = format_of({path, file->bytes()}).name;
        if (format == "PLY") return open_ply_stream(std::move(file), named, threads);
        if (format == "XYZ" || format == "CSV") return open_text_stream(std::move(file), named, threads);
    } catch (const Error&) {
        // Whoever reads the file whole says it, with the file's name.
    }
    return nullptr;
}

}  // namespace scanmill
