// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thins a scan with a grid of voxels (cubes). In every occupied voxel, the point nearest the voxel's centre is kept.
///
/// Centroid filters invent points; here the result is a subset of the scan with all columns. Unlike that of a random
/// subset, its density is even. Voxel (i, j, k) of a grid with origin o and edge B holds the points p with i =
/// floor((p.x - o.x) / B) and so on, in double arithmetic. Its centre is o + ((i, j, k) + 1/2) B.
///
/// The edge is given, or derived from the largest distance that a triangulation of the kept points may have from the
/// scanned surface. The curvature at every point allows an edge length, and this allows a voxel size (local_sizes.hpp).
///
/// Source: Wang 2006, chapter 3. Departures from it:
/// - Wang uses the coefficients a, b, c of the quadric a u² + b u v + c v² as its second derivatives, which are 2a, b,
///   2c. His voxels are √2 too large. `Derivatives::thesis` does so.
/// - Wang uses √3 voxel edges as the largest distance of points in voxels that share a corner. That is the distance of
///   the voxels' centres; points can be 2 √3 edges apart. `Guarantee::centres` uses √3: voxels are twice as large.
/// - Wang's M1 + 2 M2 + M3 depends on the directions of u and v. Here they are the principal directions, where M2 is 0
///   and the sum is smallest.
/// - Wang's plane z = a x + b y + c fails on upright surfaces. Here the plane is a total least squares fit. With
///   `origin: centroid`, the quadric has linear terms, too. Without them, the curvature at a scan's boundary is wrong
///   by more than a tenth.
/// - Wang takes the smallest size of all points, so one noisy neighbourhood decides for the whole scan. The default is
///   a quantile.
///
/// The distance between scan and triangulated result was measured with 20 random scans of each shape. It was at most
/// 0.21 of the tolerance on spheres, 0.39 on cylinders, 0.32 on tori, and 0.31 on ellipsoids of 4 : 1 : 1 with the
/// adaptive rule.

#include <optional>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/fit/local_surface.hpp"

namespace scanmill {

struct VoxelThinParams {
    /// Edge of a voxel, above 0. If absent, it is derived from the tolerance with the parameters down to `guarantee`.
    std::optional<Length> bin_size;
    /// Largest distance between the scanned surface and a triangulation of the kept points, above 0.
    Length tolerance = Length::percent_of_diagonal(0.1);
    enum class Rule {
        minimum,  ///< the smallest size that any point allows, as in the thesis
        quantile,  ///< the size that all points but a small share allow
        adaptive  ///< an octree: every leaf is as large as its points allow
    };
    Rule rule = Rule::quantile;
    /// Share of the points with known curvature, those with the smallest sizes, whose sizes are ignored; 0 is the same
    /// as `minimum`.
    Ratio quantile = Ratio::percent(1);
    /// Number of nearest other points that determine the curvature at a point: from 6 to 1000.
    u32 neighbours = 25;
    LocalSurfaceParams::Origin origin = LocalSurfaceParams::Origin::centroid;
    enum class Derivatives {
        exact,  ///< M1 = 2 |a|, M2 = |b|, M3 = 2 |c| for a u² + b u v + c v²
        thesis  ///< |a|, |b|, |c|: voxels up to √2 larger, errors up to twice the tolerance
    };
    Derivatives derivatives = Derivatives::exact;
    enum class Guarantee {
        centres,  ///< centres of adjacent voxels are at most the allowed edge apart, as in the thesis
        points  ///< any two points in adjacent voxels are at most this edge apart: voxels are half as large
    };
    Guarantee guarantee = Guarantee::points;
    /// Voxels with fewer points are noise: none of their points is kept. 1 keeps all voxels. With the adaptive rule,
    /// the points in basic voxels, of edge VoxelThinResult::bin_size, are counted, before any voxel is divided or
    /// joined.
    u32 min_points = 1;
    /// The grid's origin is the low corner of the robust box (see robust_box.hpp) minus this along every axis; 0 or
    /// more.
    Length margin;
    /// For programs: the grid's origin, in the cloud's frame; `margin` is then ignored. Thinning a result again in the
    /// same grid changes nothing. Not allowed with the adaptive rule.
    std::optional<Vec3> grid_origin;
};

struct VoxelThinResult {
    /// The kept points in input order with all columns. The last column is `bin-size`: the edge of the point's voxel,
    /// in an octree of its leaf. If the voxel size was derived, these columns precede it: `curvature-1` (the curvature
    /// of larger magnitude, positive), `curvature-2` (negative on saddles), `fit-error` (mean distance of the
    /// neighbours from the fitted quadric), `local-bin-size` (the size that the point allows) and `stands-for` (number
    /// of points in its voxel). All of them replace older columns of the same names, with a warning. There is one
    /// exception. If the scan has a column `bin-size` of one finite number above 0 per point, its larger values stay,
    /// because the points are spaced by those voxels.
    PointCloud points;
    /// Rows of the kept points in the input, ascending.
    Array<u32> kept;
    Vec3 grid_origin;
    /// Edge of a voxel, given or derived. The leaves of an octree have this edge times a power of two.
    double bin_size = 0;
    /// Points that are not kept: kept + removed = input.
    std::size_t removed = 0;
    /// Removed points whose voxel (in an octree the basic voxel) had fewer than min_points.
    std::size_t noise = 0;
};

/// Keeps in every occupied voxel the point whose squared distance to the centre, in double, is smallest; ties: the
/// lowest row. A duplicate counts as a point.
///
/// The tolerance holds where the scan shows the surface's curvature. Noise and edges between faces look more curved:
/// `minimum` follows them, `quantile` ignores a share of them. Kept points of adjacent voxels are at most 2 √3 voxel
/// edges apart, and so are the corners of a triangle without kept points in its smallest circumsphere.
///
/// Stray points (see robust_box.hpp) do not affect the grid's origin or a derived size, and are kept like other
/// points.
///
/// Throws Error for
/// - an empty cloud, or a NaN or infinite coordinate;
/// - a bin size not above 0, a negative margin, or min_points 0;
/// - more than 2^21 voxels along an axis of the robust box (with the smallest size that fits), a grid origin or a stray
///   point more than 2^31 voxels away, or more than 2^63 voxels in all;
/// - a cloud of which every point is noise;
/// - if the size is derived: a tolerance not above 0 or not below the robust box's diagonal, a quantile outside of [0,
///   1], fewer than 6 or more than 1000 neighbours, no more distinct points than neighbours, or only neighbourhoods
///   near lines;
/// - with the adaptive rule: a given bin size or grid origin.
///
/// Doubts its result if fewer than 100 of at least 10,000 points stay. With a given bin size, also doubts it if more
/// than a tenth of the points are in crowded voxels. Such a voxel holds more than 1 % of the points and a hundred times
/// as many as the average voxel. At most 10,000 points, spread evenly over the rows, are counted. Warns if more than 1
/// % of the points have no determined curvature, and about replaced columns.
///
/// Deterministic: the same bytes for any number of threads; without ties the same set for any order of the points.
/// Cost: O(n) time; beside the result 24 to 72 bytes per occupied voxel and at most 50 MB. A derived size takes about 2
/// microseconds and 170 bytes more per point. Metrics: `bin-size`, `kept`, `removed`, `noise`; for a derived size also
/// `smallest-radius`, `flat` and `undetermined`, for an octree `smallest-bin` and `largest-bin`.
VoxelThinResult voxel_thin(const PointCloud& cloud, const VoxelThinParams& params, Context& context);

/// Thins a file that is read in chunks and never in memory as a whole. The result is the same, bit for bit, and so are
/// metrics and refusals. The bin size must be given. The file is read once for its bounds (when the stream is opened),
/// once for the voxels, and a third time at the kept rows.
///
/// Lengths are resolved against scan.robust_box(). Cost: beside the result 24 to 72 bytes per occupied voxel, an eighth
/// of a byte per point, and 56 bytes (72 if the grid has 2^32 voxels or more) per point of 16 chunks, thus at most 76
/// MB. Each thread also maps pages of the file: those of a chunk, or 4 MB while the kept rows are gathered.
VoxelThinResult voxel_thin(const PointStream& scan, const VoxelThinParams& params, Context& context);

}  // namespace scanmill
