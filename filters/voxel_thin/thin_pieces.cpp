// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/thin_pieces.hpp"

#include <cmath>

#include "scanmill/filter/error.hpp"

namespace scanmill::voxel {

void require_sound(std::size_t points, const VoxelThinParams& params) {
    if (points == 0) throw Error("the cloud has no points; thinning needs at least one");
    if (points > ~u32(0)) throw Error("the cloud has {} points; at most {} can be numbered", points, ~u32(0));
    const double size = params.bin_size.value();
    if (!(size > 0) || !std::isfinite(size)) throw Error("the bin size is {} u; it must be above 0", size);
    const double margin = params.margin.value();
    if (!(margin >= 0) || !std::isfinite(margin)) throw Error("the margin is {} u; it must be 0 or more", margin);
    if (params.min_points == 0) throw Error("min-points is 0; an occupied bin has at least 1 point");
    if (params.grid_origin && !params.grid_origin->allFinite()) throw Error("the grid's origin is not finite");
}

VoxelThinResult thin(const PointPieces& points, const BoundingBox& box, const VoxelThinParams& params,
                     const std::function<PointCloud(std::span<const u32>)>& gather, Context& context) {
    const Vec3 origin = params.grid_origin.value_or(box.low.array() - params.margin.value());
    const BinGrid grid = grid_over(box, origin, params.bin_size.value());
    NearestRows nearest = nearest_rows(points, grid, params.min_points, context);

    VoxelThinResult result;
    result.grid_origin = grid.origin;
    result.kept = std::move(nearest.kept);
    result.noise = nearest.noise;
    if (result.kept.empty())
        throw Error("all {} points lie in {} bins with fewer than {} points each; nothing would be left",
                    points.points(), nearest.bins, params.min_points)
            .hint("lower min-points or enlarge the bins");
    result.removed = points.points() - result.kept.size();
    result.points = gather(result.kept);

    context.metric("kept", static_cast<double>(result.kept.size()));
    context.metric("removed", static_cast<double>(result.removed));
    context.metric("noise", static_cast<double>(result.noise));
    context.progress(1);
    return result;
}

}  // namespace scanmill::voxel
