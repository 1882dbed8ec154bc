// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/voxel_thin.hpp"

#include <algorithm>
#include <vector>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/bounds.hpp"
#include "voxel_thin/thin_pieces.hpp"
#include "voxel_thin/tolerance_thin.hpp"

namespace scanmill {

namespace {

/// Bounds of all points in one pass that also notices a NaN or an infinity; a second one finds the words for it.
BoundingBox required_bounds(std::span<const Vec3> positions, Context& context) {
    constexpr std::size_t chunk = 1 << 18;
    std::vector<FiniteBounds> parts((positions.size() + chunk - 1) / chunk);
    for_each_chunk(context.threads(), positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        parts[begin / chunk] = finite_bounds(positions.subspan(begin, end - begin));
    });
    FiniteBounds all;
    for (const FiniteBounds& part : parts) all.add(part);
    if (!all.finite) require_finite(positions);
    return all.box;
}

/// A piece fits a processor's own cache.
constexpr std::size_t piece_size = std::size_t(1) << 16;

voxel::PointPieces pieces_of(std::span<const Vec3> positions) {
    voxel::PointPieces pieces;
    for (std::size_t row = 0; row < positions.size(); row += piece_size) pieces.begin.push_back(row);
    pieces.begin.push_back(positions.size());
    pieces.read = [positions](std::size_t piece, Array<Vec3>&) {
        return positions.subspan(piece * piece_size, std::min(piece_size, positions.size() - piece * piece_size));
    };
    return pieces;
}

}  // namespace

VoxelThinResult voxel_thin(const PointCloud& cloud, const VoxelThinParams& params, Context& context) {
    voxel::require_sound(cloud.size(), params);
    const std::span<const Vec3> positions = cloud.positions.span();
    const BoundingBox box = required_bounds(positions, context);
    const voxel::PointPieces pieces = pieces_of(positions);
    if (!params.bin_size) return voxel::thin_within_tolerance(cloud, pieces, box, params, context);
    return voxel::thin(
        pieces, box, params, [&](std::span<const u32> rows) { return gather(cloud, rows); }, context);
}

}  // namespace scanmill
