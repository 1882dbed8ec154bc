// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/voxel_thin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/robust_box.hpp"
#include "scanmill/filter/inputs.hpp"
#include "voxel_thin/local_sizes.hpp"
#include "voxel_thin/octree.hpp"
#include "voxel_thin/voxel_grid.hpp"

namespace scanmill {

namespace {

using namespace voxel;

/// Throws Error for everything that is refused without regard to the coordinates.
void require_valid(std::size_t points, const VoxelThinParams& params) {
    require_points(points, "thinning needs at least 1");
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

/// Returns the box of all points, found in one parallel pass, and the box without stray points. Throws Error for
/// coordinates that are not finite.
RobustBox required_bounds(std::span<const Vec3> positions, Context& context) {
    constexpr std::size_t chunk = 1 << 18;
    std::vector<FiniteBounds> parts((positions.size() + chunk - 1) / chunk);
    for_each_chunk(context.threads(), positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        parts[begin / chunk] = finite_bounds(positions.subspan(begin, end - begin));
    });
    FiniteBounds all;
    for (const FiniteBounds& part : parts) all.add(part);
    if (!all.finite) require_finite(positions);  // counts the coordinates that are not finite
    return robust_box(positions, all.box);
}

/// Number of points in a chunk. A chunk fits the cache of one core.
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

Vec3 grid_origin(const RobustBox& box, const VoxelThinParams& params) {
    return params.grid_origin.value_or(box.robust.low.array() - params.margin.value());
}

void require_kept(const KeptRows& rows, std::size_t points, u32 min_points) {
    if (!rows.kept.empty()) return;
    throw Error("{} in {} with fewer than {} points each; no point would be kept",
                points == 1 ? "the only point lies" : fmt::format("all {} points lie", points),
                count_text(rows.voxels, "voxel", "voxels"), min_points)
        .hint("lower min-points, or enlarge the voxels");
}

/// Whether the column has one number per row, all finite and above 0.
bool are_sizes(const Column& column, std::size_t rows) {
    if (column.components() != 1 || column.rows() != rows) return false;
    for (std::size_t row = 0; row < rows; ++row)
        if (const double size = column.number(row); !(size > 0 && std::isfinite(size))) return false;
    return true;
}

/// Adds `bin-size` (float64): per kept point the edge of its voxel. `edges` has one edge per point, or is empty if all
/// are `grid_edge`. If the scan has a column `bin-size` of one finite number above 0 per point, its larger values stay,
/// with a warning. Points that were thinned before thus keep the spacing of the larger voxels.
void add_bin_sizes(PointCloud& thinned, std::span<const double> edges, double grid_edge, Context& context) {
    Array<double> sizes(thinned.size());
    if (edges.empty())
        std::ranges::fill(sizes, grid_edge);
    else
        std::ranges::copy(edges, sizes.begin());
    std::size_t older = 0;
    if (const Column* before = thinned.columns.find("bin-size"); before && are_sizes(*before, sizes.size()))
        for (std::size_t row = 0; row < sizes.size(); ++row)
            if (const double size = before->number(row); size > sizes[row]) {
                sizes[row] = size;
                ++older;
            }
    if (older > 0)
        context.warn(fmt::format("{} of {} {} thinned with larger voxels before; {} `bin-size` stays", older,
                                 count_text(sizes.size(), "kept point", "kept points"), by_count(older, "was", "were"),
                                 by_count(older, "its", "their")));
    add_column(thinned.columns, Column("bin-size", 1, Buffer<double>(std::move(sizes))).with_length_exponent(1),
               context);
}

/// Adds `curvature-1`, `curvature-2`, `fit-error`, `local-bin-size` (float64) and `stands-for` (uint32). Columns of
/// these names that the scan had are replaced, with a warning. `kept` are the points' rows in the input. `members` are
/// the numbers of points in their voxels.
void add_surface_columns(PointCloud& thinned, const LocalSizes& local, std::span<const u32> kept,
                         std::span<const u32> members, Context& context) {
    Array<double> first(kept.size()), second(kept.size()), error(kept.size()), size(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const u32 point = local.point_of_row[kept[i]];
        const LocalSurface& surface = local.surfaces[point];
        // The outward direction is not known: the larger curvature is positive, the other one negative on saddles.
        const double sign = surface.first_curvature < 0 ? -1 : 1;
        first[i] = sign * surface.first_curvature;
        second[i] = sign * surface.second_curvature;
        error[i] = surface.fit_error;
        size[i] = local.sizes[point];
    }
    for (Column& column :
         std::array{Column("curvature-1", 1, Buffer<double>(std::move(first))).with_length_exponent(-1),
                    Column("curvature-2", 1, Buffer<double>(std::move(second))).with_length_exponent(-1),
                    Column("fit-error", 1, Buffer<double>(std::move(error))).with_length_exponent(1),
                    Column("local-bin-size", 1, Buffer<double>(std::move(size))).with_length_exponent(1),
                    Column("stands-for", 1, Buffer<u32>(Array<u32>(members.begin(), members.end())))})
        add_column(thinned.columns, std::move(column), context);
}

/// Doubts the result if voxels are about as large as the scan.
void doubt_few(const VoxelThinResult& result, std::size_t points, Context& context) {
    constexpr std::size_t few = 100, many = 10'000;
    if (result.kept.size() < few && points >= many)
        context.doubt(fmt::format(
            "{} of {} points stay: voxels of {:.4g} {} are about as large as the scan, or points far from all others "
            "determine `%diag`; use smaller voxels, or outlier-removal before",
            result.kept.size(), points, result.bin_size, symbol(result.points.frame.unit)));
}

/// Every n-th point, taken while the points are read.
class SpreadSample {
public:
    explicit SpreadSample(const PointChunks& points)
        : points_(points),
          step_(points.size() / most + 1),
          taken_((points.size() + step_ - 1) / step_) {}

    /// Returns the same points in chunks. Reading them fills the sample. Valid as long as this sample.
    PointChunks chunks() {
        return {points_.begin, [this](std::size_t chunk, Array<Vec3>& buffer) {
                    const std::span<const Vec3> positions = points_.read(chunk, buffer);
                    const std::size_t begin = points_.begin[chunk];
                    for (std::size_t row = (begin + step_ - 1) / step_ * step_; row < begin + positions.size();
                         row += step_)
                        taken_[row / step_] = positions[row - begin];
                    return positions;
                }};
    }
    std::span<const Vec3> points() const { return taken_; }

private:
    static constexpr std::size_t most = 10'000;
    const PointChunks& points_;
    std::size_t step_;
    Array<Vec3> taken_;
};

/// Doubts the result if some voxels hold far more points than the others: parts of the scan are then too small for
/// them.
void doubt_crowded(const VoxelGrid& grid, std::span<const Vec3> sample, std::size_t kept, LengthUnit unit,
                   Context& context) {
    constexpr double crowded = 100, least = 0.01, doubtful = 0.1;
    using Voxel = std::array<double, 3>;
    std::vector<Voxel> voxels;
    for (const Vec3& p : sample) {
        const Vec3 voxel = ((p - grid.origin) / grid.size).array().floor();
        voxels.push_back({voxel.x(), voxel.y(), voxel.z()});
    }
    std::ranges::sort(voxels);
    const double all = static_cast<double>(voxels.size());
    const double limit = all * std::max(least, crowded / static_cast<double>(kept));
    std::size_t points = 0, count = 0;
    for (auto begin = voxels.begin(); begin != voxels.end();) {
        const auto end = std::upper_bound(begin, voxels.end(), *begin);
        if (static_cast<double>(end - begin) > limit) {
            points += static_cast<std::size_t>(end - begin);
            ++count;
        }
        begin = end;
    }
    if (const double share = static_cast<double>(points) / all; share > doubtful)
        context.doubt(
            fmt::format("{:.0f} % of the points are in {} of {:.4g} {}, and only one point of each stays: a part of "
                        "the scan is tiny beside the rest; use smaller voxels, and if one view is in metres and "
                        "another in millimetres, convert one first",
                        100 * share, count_text(count, "voxel", "voxels"), grid.size, symbol(unit)));
}

/// Moves the rows into the result, adds the column `bin-size` and reports the metrics of every thinning.
void finish(VoxelThinResult& result, KeptRows rows, std::size_t points, Context& context) {
    add_bin_sizes(result.points, rows.edges, result.bin_size, context);
    result.kept = std::move(rows.kept);
    result.noise = rows.noise;
    result.removed = points - result.kept.size();
    doubt_few(result, points, context);
    context.metric("bin-size", result.bin_size, Unit::length);
    context.metric("kept", static_cast<double>(result.kept.size()));
    context.metric("removed", static_cast<double>(result.removed));
    context.metric("noise", static_cast<double>(result.noise));
    context.progress(1);
}

/// Thins with a given voxel size. `gather` returns the points of ascending rows.
VoxelThinResult thin_by_grid(const PointChunks& points, const RobustBox& box, const VoxelThinParams& params,
                             const std::function<PointCloud(std::span<const u32>)>& gather, Context& context) {
    const VoxelGrid grid = grid_over(box, grid_origin(box, params), params.bin_size->value());
    SpreadSample sample(points);
    KeptRows rows = nearest_to_centres(sample.chunks(), grid, params.min_points, context);
    require_kept(rows, points.size(), params.min_points);

    VoxelThinResult result;
    result.bin_size = grid.size;
    result.grid_origin = grid.origin;
    result.points = gather(rows.kept);
    finish(result, std::move(rows), points.size(), context);
    doubt_crowded(grid, sample.points(), result.kept.size(), result.points.frame.unit, context);
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

VoxelThinResult thin_within_tolerance(const PointCloud& cloud, const PointChunks& chunks, const RobustBox& box,
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
    const RobustBox box = required_bounds(positions, context);
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
        chunks, scan.robust_box(), params,
        [&](std::span<const u32> rows) { return scan.gather(rows, context.threads()); }, context);
}

}  // namespace scanmill
