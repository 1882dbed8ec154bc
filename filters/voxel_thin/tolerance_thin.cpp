// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/tolerance_thin.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "voxel_thin/octree.hpp"
#include "voxel_thin/surface_columns.hpp"
#include "voxel_thin/thin_pieces.hpp"

namespace scanmill::voxel {

namespace {

NearestRows rows_by_octree(std::span<const Vec3> positions, const LocalBins& local, const Vec3& origin, u32 min_points,
                           Context& context) {
    OctreeChoice choice =
        choose_in_octree(positions, local.place_of_row, local.sizes, origin, local.chosen, min_points, context);
    context.metric("smallest-bin", choice.smallest, Unit::length);
    context.metric("largest-bin", choice.largest, Unit::length);
    return {std::move(choice.kept), std::move(choice.members), std::move(choice.edges), choice.noise,
            choice.basic_voxels};
}

void report(const LocalBins& local, Context& context) {
    double curvature = 0;
    for (const LocalSurface& surface : local.surfaces)
        curvature = std::max(curvature, std::abs(surface.first_curvature));
    if (curvature > 0) context.metric("smallest-radius", 1 / curvature, Unit::length);
    context.metric("flat", static_cast<double>(local.flat));
    context.metric("undetermined", static_cast<double>(local.undetermined));
}

}  // namespace

VoxelThinResult thin_within_tolerance(const PointCloud& cloud, const PointPieces& pieces, const BoundingBox& box,
                                      const VoxelThinParams& params, Context& context) {
    const bool adaptive = params.rule == VoxelThinParams::Rule::adaptive;
    if (adaptive && params.grid_origin)
        throw Error("the adaptive rule makes an octree over the cloud, and has no use for a grid's origin")
            .hint("leave the grid's origin out, or take the rule quantile");
    const std::span<const Vec3> positions = cloud.positions.span();
    const LocalBins local = local_bins(positions, box, params, context);

    VoxelThinResult result;
    result.bin_size = local.chosen;
    result.grid_origin = grid_origin(box, params);
    NearestRows rows = adaptive ? rows_by_octree(positions, local, result.grid_origin, params.min_points, context)
                                : nearest_rows(pieces, grid_over(box, result.grid_origin, local.chosen),
                                               params.min_points, context, true);
    require_some(rows, positions.size(), params.min_points);
    result.points = gather(cloud, rows.kept);
    add_surface_columns(result.points, local, rows.kept, rows.members, context);
    report(local, context);
    finish(result, std::move(rows), positions.size(), context);
    return result;
}

}  // namespace scanmill::voxel
