// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/streamed_thin.hpp"

#include "voxel_thin/thin_pieces.hpp"

namespace scanmill {

VoxelThinResult voxel_thin(const PointStream& scan, const VoxelThinParams& params, Context& context) {
    voxel::require_sound(scan.size(), params);
    voxel::PointPieces pieces{scan.pieces(), [&](std::size_t piece, Array<Vec3>& room) -> std::span<const Vec3> {
                                  scan.read(piece, room);
                                  return room;
                              }};
    return voxel::thin(
        pieces, scan.bounds(), params, [&](std::span<const u32> rows) { return scan.gather(rows, context.threads()); },
        context);
}

}  // namespace scanmill
