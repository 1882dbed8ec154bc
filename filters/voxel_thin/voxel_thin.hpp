// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thinning by a grid of cubes: of the points in every occupied bin the one nearest the bin's centre stays.
///
/// Unlike centroid filters (which invent points) what is left is a subset of the scan, with every column; unlike a
/// random subset its density is even. Bin (i, j, k) of a grid with origin o and bin size B holds the points p with
/// i = floor((p.x - o.x) / B) and so on, in double arithmetic; its centre is o + ((i, j, k) + 1/2) B.
///
/// The bin size is given, or derived from the largest distance that a triangulation of the kept points may have from
/// the scanned surface: every neighbourhood's curvature allows an edge length, that a bin size (see local_bins.hpp).

#include <optional>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/fit/local_surface.hpp"

namespace scanmill {

struct VoxelThinParams {
    /// Edge of a bin, above 0; absent: derived from the tolerance, by all that follows up to `guarantee`.
    std::optional<Length> bin_size;
    /// Largest distance between the scanned surface and a triangulation of the kept points, above 0.
    Length tolerance = Length::percent_of_diagonal(0.1);
    enum class Rule {
        minimum,   ///< the least size that any place allows: the thesis's
        quantile,  ///< the size that all but this share of the places allow
        adaptive   ///< an octree: every leaf as large as its points allow
    };
    Rule rule = Rule::quantile;
    /// Of the places that determine a size; 0 means the same as `minimum`.
    Ratio quantile = Ratio::percent(1);
    /// Nearest other places that show the surface around one: from 6 to 1000.
    u32 neighbours = 25;
    LocalSurfaceParams::Origin origin = LocalSurfaceParams::Origin::centroid;
    enum class Derivatives {
        exact,  ///< M1 = 2 |a|, M2 = |b|, M3 = 2 |c| for a u² + b u v + c v²
        thesis  ///< |a|, |b|, |c|: bins up to √2 larger, errors up to twice the tolerance
    };
    Derivatives derivatives = Derivatives::exact;
    enum class Guarantee {
        centres,  ///< centres of bins that touch are at most the allowed edge apart: the thesis's
        points    ///< so are any two points in them: bins half as large
    };
    Guarantee guarantee = Guarantee::points;
    /// Bins with fewer points are noise: none of their points is kept. 1 keeps all bins. With the adaptive rule these
    /// are the basic voxels, of edge VoxelThinResult::bin_size, whatever the leaves are.
    u32 min_points = 1;
    /// The grid's origin is the bounding box's low corner minus this along every axis; 0 or more.
    Length margin;
    /// For programs: a grid of their own instead, relative to the cloud's frame; then `margin` is not used. Thinning a
    /// result again in the same grid changes nothing. Not with the adaptive rule.
    std::optional<Vec3> grid_origin;
};

struct VoxelThinResult {
    /// The kept points in input order, every column carried along, and last `bin-size`: the edge of the bin that the
    /// point was kept from, in an octree of its leaf. When the bin size was derived, before it also the columns
    /// `curvature-1` (of larger size, positive), `curvature-2` (negative on saddles), `fit-error` (mean distance of
    /// the neighbours to the fitted quadric), `local-bin-size` (what the place allows) and `stands-for` (how many
    /// points share its bin). An older column of such a name gives way, told; but a `bin-size` of one finite number
    /// above 0 per point stays where it is larger, for the points lie as those bins left them.
    PointCloud points;
    /// Their rows in the input, ascending.
    Array<u32> kept;
    Vec3 grid_origin;
    /// Edge of a bin, given or derived; of an octree the edge that its leaves have times a power of two.
    double bin_size = 0;
    /// Points that gave way to another one of their bin, or that were noise: kept + removed = input.
    std::size_t removed = 0;
    /// The removed points whose bins (of an octree the basic voxels) had fewer than min_points.
    std::size_t noise = 0;
};

/// Keeps in every occupied bin the point whose squared distance to the centre, in double, is least; of equal ones that
/// of the lowest row. A duplicate counts as a point of its bin like any other.
///
/// The tolerance is kept where the scan shows the curvature that the surface has: noise and edges between faces look
/// more curved, which `minimum` obeys and `quantile` passes over. Kept points of bins that touch are at most 2 √3 bins
/// apart; so are the corners of a triangle without kept points in its smallest circumsphere.
///
/// Throws Error for an empty cloud, a NaN or infinite coordinate, a bin size not above 0, a negative margin,
/// min_points 0, more than 2^21 bins along an axis (naming the smallest size that fits), a grid origin more than 2^31
/// bins away, and when every point was noise. To derive a bin size, also for a tolerance not above 0 or not below the
/// cloud's diagonal, a quantile outside of [0, 1], fewer than 6 neighbours or more than 1000 asked for, no more
/// distinct places than neighbours, and when all neighbourhoods lie near lines. For the adaptive rule with a bin size
/// or a grid of one's own. Warns when more than 1 % of the places show no surface, and of columns that give way to new
/// ones. Deterministic: the same bytes for any number of threads; without ties, the same set for any order of the
/// input. Cost: O(n) time; beside the result 24 to 72 bytes per occupied bin and at most 50 MB. A derived size takes
/// some 2 microseconds and 170 bytes more per point. Metrics: `bin-size`, `kept`, `removed`, `noise`; of a derived size
/// see tolerance_thin.hpp. Source: Wang 2006, chapter 3; where this departs from it, README.md says why.
VoxelThinResult voxel_thin(const PointCloud& cloud, const VoxelThinParams& params, Context& context);

}  // namespace scanmill
