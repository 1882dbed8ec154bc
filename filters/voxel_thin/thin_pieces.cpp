// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/thin_pieces.hpp"

#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "voxel_thin/added_columns.hpp"

namespace scanmill::voxel {

void require_sound(std::size_t points, const VoxelThinParams& params) {
    if (points == 0)
        throw Error("the cloud has no points; thinning needs at least one")
            .hint("`scanmill info` tells what a file holds");
    if (points > ~u32(0)) throw Error("the cloud has {} points; at most {} can be numbered", points, ~u32(0));
    if (params.bin_size) {
        const double size = params.bin_size->value();
        if (!(size > 0) || !std::isfinite(size)) throw Error("the bin size is {} u; it must be above 0", size);
        if (params.rule == VoxelThinParams::Rule::adaptive)
            throw Error("the adaptive rule was asked for beside a bin size of {} u, and there is only one size then",
                        size)
                .hint("leave the bin size at auto, or the rule out");
    }
    const double margin = params.margin.value();
    if (!(margin >= 0) || !std::isfinite(margin)) throw Error("the margin is {} u; it must be 0 or more", margin);
    if (params.min_points == 0) throw Error("min-points is 0; an occupied bin has at least 1 point");
    if (params.grid_origin && !params.grid_origin->allFinite()) throw Error("the grid's origin is not finite");
}

VoxelThinResult thin(const PointPieces& points, const BoundingBox& box, const VoxelThinParams& params,
                     const std::function<PointCloud(std::span<const u32>)>& gather, Context& context) {
    if (!params.bin_size)
        throw Error("a bin size that follows from the tolerance needs all points in memory")
            .hint("give a bin-size, or read the scan as a whole");
    const BinGrid grid = grid_over(box, grid_origin(box, params), params.bin_size->value());
    NearestRows nearest = nearest_rows(points, grid, params.min_points, context);
    require_some(nearest, points.points(), params.min_points);

    VoxelThinResult result;
    result.bin_size = grid.size;
    result.grid_origin = grid.origin;
    result.points = gather(nearest.kept);
    finish(result, std::move(nearest), points.points(), context);
    return result;
}

Vec3 grid_origin(const BoundingBox& box, const VoxelThinParams& params) {
    return params.grid_origin.value_or(box.low.array() - params.margin.value());
}

void require_some(const NearestRows& rows, std::size_t points, u32 min_points) {
    if (!rows.kept.empty()) return;
    throw Error("{} in {} with fewer than {} points each; nothing would be left",
                points == 1 ? "the only point lies" : fmt::format("all {} points lie", points),
                counted(rows.bins, "bin", "bins"), min_points)
        .hint("lower min-points or enlarge the bins");
}

void finish(VoxelThinResult& result, NearestRows rows, std::size_t points, Context& context) {
    add_bin_sizes(result.points, rows.edges, result.bin_size, context);
    result.kept = std::move(rows.kept);
    result.noise = rows.noise;
    result.removed = points - result.kept.size();
    context.metric("bin-size", result.bin_size, Unit::length);
    context.metric("kept", static_cast<double>(result.kept.size()));
    context.metric("removed", static_cast<double>(result.removed));
    context.metric("noise", static_cast<double>(result.noise));
    context.progress(1);
}

}  // namespace scanmill::voxel
