// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/point_stream.hpp"

#include <algorithm>
#include <array>

#include "scanmill/filter/error.hpp"
#include "scanmill/formats/format.hpp"
#include "scanmill/formats/point_stream_kinds.hpp"

namespace scanmill {

namespace {

constexpr std::array<PointStreamKind, 3> kinds{{{"PLY", may_be_ply_stream, open_ply_stream},
                                                {"XYZ", may_be_text_stream, open_text_stream},
                                                {"CSV", may_be_text_stream, open_text_stream}}};

/// nullptr when files of the format are not read piece by piece. Throws Error when it is not known.
const PointStreamKind* kind_of(const std::filesystem::path& path, std::string_view bytes) {
    const auto found = std::ranges::find(kinds, format_of({path, bytes}).name, &PointStreamKind::format);
    return found == kinds.end() ? nullptr : found;
}

}  // namespace

PointStream::~PointStream() = default;

void PointStream::read(std::size_t piece, Array<Vec3>& room) const {
    const FiniteBounds world = read_world(piece, room);
    if (room.size() != pieces_[piece + 1] - pieces_[piece] || !world.are_within(world_.box)) throw_changed();
    if (frame_.origin == Vec3::Zero()) return;
    for (Vec3& p : room) p -= frame_.origin;
}

PointCloud PointStream::gather(std::span<const u32> rows, unsigned threads) const {
    PointCloud cloud = gather_world(rows, threads);
    if (!finite_bounds(cloud.positions.span()).are_within(world_.box)) throw_changed();
    cloud.frame = frame_;
    if (frame_.origin != Vec3::Zero()) cloud.positions = translated(cloud.positions, -frame_.origin);
    return cloud;
}

void PointStream::throw_changed() { throw Error("the scan's file changed while it was read").hint("run it again"); }

void PointStream::choose_origin() {
    frame_.origin = distant_origin(world_.box);
    bounds_.low = world_.box.low - frame_.origin;
    bounds_.high = world_.box.high - frame_.origin;
}

std::unique_ptr<PointStream> open_point_stream(const std::filesystem::path& path, const ReadOptions& options,
                                               unsigned threads, const OnWorldPositions& on_positions) {
    ReadOptions named = options;
    if (options.on_warning)
        named.on_warning = [&](std::string text) { options.on_warning("'" + path.string() + "': " + text); };
    try {
        auto file = std::make_unique<MappedFile>(path, false);
        if (const PointStreamKind* kind = kind_of(path, file->bytes()))
            return kind->open(std::move(file), named, threads, on_positions);
    } catch (const Error&) {
        // Whoever reads the file whole says it, with the file's name.
    }
    return nullptr;
}

bool may_be_point_stream(const std::filesystem::path& path) {
    try {
        const MappedFile file(path, false);
        const PointStreamKind* kind = kind_of(path, file.bytes());
        return kind && kind->may_be(file.bytes());
    } catch (const Error&) {
        return false;
    }
}

}  // namespace scanmill
