// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/voxel_thin.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/bounds.hpp"
#include "voxel_thin/columns.hpp"
#include "voxel_thin/local_sizes.hpp"
#include "voxel_thin/octree.hpp"
#include "voxel_thin/voxel_grid.hpp"

namespace scanmill {

namespace {

using namespace voxel;

/// Throws Error for everything that is refused whatever the coordinates are.
void require_valid(std::size_t points, const VoxelThinParams& params) {
    if (points == 0)
        throw Error("the cloud has no points; thinning needs at least one")
            .hint("`scanmill info` shows what a file contains");
    if (points > ~u32(0)) throw Error("the cloud has {} points; at most {} are supported", points, ~u32(0));
    if (params.bin_size) {
        const double size = params.bin_size->value();
        if (!(size > 0) || !std::isfinite(size)) throw Error("bin-size is {} u; it must be above 0", size);
        if (params.rule == VoxelThinParams::Rule::adaptive)
            throw Error("rule is adaptive, which derives voxel sizes, but bin-size is {} u", size)
                .hint("leave bin-size at auto, or choose another rule");
    }
    const double margin = params.margin.value();
    if (!(margin >= 0) || !std::isfinite(margin)) throw Error("margin is {} u; it must be 0 or more", margin);
    if (params.min_points == 0) throw Error("min-points is 0; an occupied voxel has at least 1 point");
    if (params.grid_origin && !params.grid_origin->allFinite()) throw Error("the grid's origin is not finite");
}

/// Bounds of all points in one parallel pass. Throws Error for coordinates that are not finite.
BoundingBox required_bounds(std::span<const Vec3> positions, Context& context) {
    constexpr std::size_t chunk = 1 << 18;
    std::vector<FiniteBounds> parts((positions.size() + chunk - 1) / chunk);
    for_each_chunk(context.threads(), positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        parts[begin / chunk] = finite_bounds(positions.subspan(begin, end - begin));
    });
    FiniteBounds all;
    for (const FiniteBounds& part : parts) all.add(part);
    if (!all.finite) require_finite(positions);  // counts them for the message
    return all.box;
}

/// Points of a chunk: they fit the cache of one core.
constexpr std::size_t chunk_size = std::size_t(1) << 16;

PointChunks chunks_of(std::span<const Vec3> positions) {
    PointChunks chunks;
    for (std::size_t row = 0; row < positions.size(); row += chunk_size) chunks.begin.push_back(row);
    chunks.begin.push_back(positions.size());
    chunks.read = [positions](std::size_t chunk, Array<Vec3>&) {
        return positions.subspan(chunk * chunk_size, std::min(chunk_size, positions.size() - chunk * chunk_size));
    };
    return chunks;
}

Vec3 grid_origin(const BoundingBox& box, const VoxelThinParams& params) {
    return params.grid_origin.value_or(box.low.array() - params.margin.value());
}

void require_kept(const KeptRows& rows, std::size_t points, u32 min_points) {
    if (!rows.kept.empty()) return;
    throw Error("{} in {} with fewer than {} points each; no point would be kept",
                points == 1 ? "the only point lies" : fmt::format("all {} points lie", points),
                counted(rows.voxels, "voxel", "voxels"), min_points)
        .hint("lower min-points, or enlarge the voxels");
}

/// Moves the rows into the result, adds the column `bin-size` and reports the metrics of every thinning.
void finish(VoxelThinResult& result, KeptRows rows, std::size_t points, Context& context) {
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

/// With a given voxel size. `gather` returns the points of ascending rows.
VoxelThinResult thin_by_grid(const PointChunks& points, const BoundingBox& box, const VoxelThinParams& params,
                             const std::function<PointCloud(std::span<const u32>)>& gather, Context& context) {
    const VoxelGrid grid = grid_over(box, grid_origin(box, params), params.bin_size->value());
    KeptRows rows = nearest_to_centres(points, grid, params.min_points, context);
    require_kept(rows, points.size(), params.min_points);

    VoxelThinResult result;
    result.bin_size = grid.size;
    result.grid_origin = grid.origin;
    result.points = gather(rows.kept);
    finish(result, std::move(rows), points.size(), context);
    return result;
}

KeptRows rows_by_octree(std::span<const Vec3> positions, const LocalSizes& local, const Vec3& origin, u32 min_points,
                        Context& context) {
    OctreeChoice choice =
        choose_in_octree(positions, local.point_of_row, local.sizes, origin, local.chosen, min_points, context);
    context.metric("smallest-bin", choice.smallest, Unit::length);
    context.metric("largest-bin", choice.largest, Unit::length);
    return std::move(choice.rows);
}

void report(const LocalSizes& local, Context& context) {
    double curvature = 0;
    for (const LocalSurface& surface : local.surfaces)
        curvature = std::max(curvature, std::abs(surface.first_curvature));
    if (curvature > 0) context.metric("smallest-radius", 1 / curvature, Unit::length);
    context.metric("flat", static_cast<double>(local.flat));
    context.metric("undetermined", static_cast<double>(local.undetermined));
}

VoxelThinResult thin_within_tolerance(const PointCloud& cloud, const PointChunks& chunks, const BoundingBox& box,
                                      const VoxelThinParams& params, Context& context) {
    const bool adaptive = params.rule == VoxelThinParams::Rule::adaptive;
    if (adaptive && params.grid_origin)
        throw Error("rule is adaptive, whose octree begins at the bounding box, but a grid origin is given")
            .hint("leave out the grid origin, or choose the rule quantile");
    const std::span<const Vec3> positions = cloud.positions.span();
    const LocalSizes local = local_sizes(positions, box, params, context);

    VoxelThinResult result;
    result.bin_size = local.chosen;
    result.grid_origin = grid_origin(box, params);
    KeptRows rows = adaptive ? rows_by_octree(positions, local, result.grid_origin, params.min_points, context)
                             : nearest_to_centres(chunks, grid_over(box, result.grid_origin, local.chosen),
                                                  params.min_points, context, true);
    require_kept(rows, positions.size(), params.min_points);
    result.points = gather(cloud, rows.kept);
    add_surface_columns(result.points, local, rows.kept, rows.members, context);
    report(local, context);
    finish(result, std::move(rows), positions.size(), context);
    return result;
}

}  // namespace

VoxelThinResult voxel_thin(const PointCloud& cloud, const VoxelThinParams& params, Context& context) {
    require_valid(cloud.size(), params);
    const std::span<const Vec3> positions = cloud.positions.span();
    const BoundingBox box = required_bounds(positions, context);
    const PointChunks chunks = chunks_of(positions);
    if (!params.bin_size) return thin_within_tolerance(cloud, chunks, box, params, context);
    return thin_by_grid(
        chunks, box, params, [&](std::span<const u32> rows) { return gather(cloud, rows); }, context);
}

VoxelThinResult voxel_thin(const PointStream& scan, const VoxelThinParams& params, Context& context) {
    require_valid(scan.size(), params);
    if (!params.bin_size)
        throw Error("a voxel size derived from the tolerance needs all points in memory")
            .hint("give a bin-size, or read the whole scan");
    const PointChunks chunks{scan.pieces(), [&](std::size_t chunk, Array<Vec3>& buffer) -> std::span<const Vec3> {
                                 scan.read(chunk, buffer);
                                 return buffer;
                             }};
    return thin_by_grid(
        chunks, scan.bounds(), params, [&](std::span<const u32> rows) { return scan.gather(rows, context.threads()); },
        context);
}

}  // namespace scanmill
