// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A surface grown over thinned points, triangle by triangle from a seed, that ends where the points end: at borders,
/// holes and sharp edges, which it tells.
///
/// Every edge of the front looks for its *suitable point*: one in the search radius, for which no angle of the new
/// triangle is below `min_angle` and its normal differs from that of every joined triangle by at most
/// `max_normal_angle`; of these the one that leaves no other in the circle through the three.

#include <optional>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct RegionGrowParams {
    enum class Score {
        circumradius,  ///< no other point in the circle through the three: as in a Delaunay triangulation
        midpoint       ///< the thesis: the point nearest the edge's middle
    };
    /// Of every triangle of the first pass; 0 or more, below 60 degrees.
    Angle min_angle = Angle::degrees(10);
    /// Between the normals of a new triangle and each one it joins; above 0, at most 180 degrees.
    Angle max_normal_angle = Angle::degrees(90);
    /// The suitable point is no farther from an end of the edge, and the circle through the triangle has at most a
    /// third of this as radius: larger empty circles are holes. Above 0; nothing: 2 √3 B, B being the point's number in
    /// the column `bin-size`, or where there is none, or the density contradicts it, the bin size that thinning to the
    /// local density would have had (see search_radii.hpp).
    std::optional<Length> search_radius;
    /// Edges whose triangles' normals differ by more are creases. 0 to 180 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// Loops of at most this many edges are closed, and longer ones (up to 100 edges) that hold no circle as large as a
    /// hole, unless `max_normal_angle` is below 90 degrees and they bend by more than 4/3 of it; 0 (as 1 and 2) closes
    /// none, at most 100.
    u32 close_holes = 4;
    Score score = Score::circumradius;
    /// The row of the point that the seed triangle starts at; nothing: the flattest place.
    std::optional<u32> start;
};

struct RegionGrowResult {
    /// Over the points used, in input order with their columns. Its sharp edges are the creases, and the border edges
    /// beyond which the surface goes on in another patch.
    TriangleMesh mesh;
    /// Its borders, holes and creases, with the normals on both sides: beyond a border that is a sharp edge those of
    /// the other patch.
    FeatureGraph features;
    /// Per vertex its row in the cloud, ascending.
    Array<u32> rows;
    /// Per triangle: 0 formed under the given limits, 1 to 3 under relaxed ones, 4 closing a small hole.
    Array<u8> passes;
    std::size_t components = 0;
    /// Boundary loops, and those of them that are holes.
    std::size_t loops = 0, holes = 0;
    /// Of the loops those at parts so thin that the surface may go on there (see thin_parts.hpp).
    std::size_t thin_loops = 0;
    /// Rows without a vertex of their own: repeats of an earlier row, and places that no triangle reached.
    std::size_t duplicates = 0, unused_points = 0;
    /// Border edges beyond which a place of the front was turned down for the angle to the triangle there alone.
    std::size_t patch_edges = 0;
    std::size_t creases = 0, corners = 0, closed_holes = 0;
    /// Grown and taken off again: vertices would have had several fans, or a hole could only be closed in place of
    /// them.
    std::size_t removed_triangles = 0;
    /// Loops whose area does not tell boundaries from holes, and triangles without area, as find_features() counts.
    std::size_t ambiguous_loops = 0, triangles_without_area = 0;
};

/// Grows a surface over the cloud, as many pieces as it takes.
///
/// Points should be thinned: of even density, at least locally. A column `normal` (three numbers per row) is used as it
/// is, sign and all, unless the signs are mixed or few (see given_normals.hpp): then it tells directions and which way
/// the pieces face. A normal that is zero or not finite is replaced by the principal one. Without the column normals
/// are principal directions of the 12 nearest neighbours. A column `bin-size` (a number per row, in the scan's unit;
/// what is not above 0 or not finite counts as unknown) tells the bins of a thinning. Of rows in one place the least
/// bin counts, and the normal first by x, y, z.
///
/// Throws Error with numbers and a way out: fewer than three distinct points, all on one line, a NaN or infinite
/// coordinate, a normal column of another size, a parameter out of range, a start that is no row or starts nothing, a
/// search radius too small for any triangle (or layers so near that none is flat).
///
/// Post: an oriented manifold: every edge in one triangle or in two that pass it in opposite directions, every vertex's
/// triangles one fan. No vertex twice in one place. Triangles round a vertex do not overlap as seen along its normal,
/// but for those of pass 4, which bend by up to 172 degrees. No triangle in doubt, nor one that closes a hole, passes
/// through those that are near it. Angles of triangles of pass 0 keep the limits; later passes relax them (see the
/// page). Pieces that enclose a volume face outwards; so do open ones that bulge, flat ones face up. With a normal
/// column they face as it says, where three quarters of it agree. Ties: equal scores (to 1e-9) by place, along a
/// space-filling curve through the cloud's box. So the mesh depends neither on the order of the points, up to
/// numbering, nor on the number of threads.
///
/// Cost: O(n log n) time where the nearest 16 places decide, about 450 bytes per point beside the result. An edge where
/// they do not, or that finds nothing, asks the places within its search radius that are still open, and if one of them
/// could do looks at all m there, up to four times: O(m log m) each, and as often again as places are turned down for
/// what the front or other places do there. So a radius of many spacings costs O(n m log m) on noisy scans; leave it to
/// `auto` there. Metrics: see plugin.cpp.
///
/// Warns when more than half a percent of the places stay unused, when most points lie too dense for their `bin-size`,
/// of normals whose signs are mixed or end the surface, of loops at thin parts, and of what find_features() could not
/// tell. Source: Wang 2006, chapter 4, made robust; the choice by empty circles after Delaunay.
RegionGrowResult region_grow(const PointCloud& cloud, const RegionGrowParams& params, Context& context);

}  // namespace scanmill
