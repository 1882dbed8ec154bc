// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closes boundary loops that growth left open although they are no holes: loops of few edges and narrow loops.

#include <limits>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/growing/intersections.hpp"

namespace scanmill::growing {

inline constexpr double any_length = std::numeric_limits<double>::infinity();

/// Limits of the triangles that close a hole.
struct TriangulationLimits {
    /// Largest enclosing radius of a triangle; infinity means no limit.
    double largest_radius;
    /// Least cosine between the normals of triangles that share an edge.
    double dihedral_cosine;
    /// Limit of the length of new edges: they must be shorter. Edges of the loop may have any length.
    double longest_edge = any_length;
};

inline constexpr double any_dihedral = -2;

/// Whether a triangulation within the limits exists that repeats no edge of the surface. The triangulation may
/// intersect other triangles.
bool can_be_triangulated(const Surface& surface, const std::vector<u32>& corners, const TriangulationLimits& limits);

/// Returns the triangles of least total area that close the loop of `corners`. Corners are distinct and have the
/// counter-clockwise order of the new triangles. The result is empty if no triangulation was found that keeps the
/// limits, repeats no edge of the surface, and intersects neither the surface nor itself. Ties: the triangulation that
/// joins the first corners. Parts of the loop are solved first and separately, so a triangulation whose parts are not
/// optimal is not found.
///
/// `near` is working memory. Cost: at most corners³ / 6 triangles. Triangles that would lower the area are tested
/// against the surface near the loop.
std::vector<Triangle> triangulate_hole(const Surface& surface, NearTriangles& near, const std::vector<u32>& corners,
                                       const TriangulationLimits& limits);

/// Closes loops of at most `most_edges` boundary edges with the triangles of least total area. New triangles must not
/// repeat an edge, intersect other triangles, or fold back on an adjacent triangle by more than 150 degrees. New edges
/// must be shorter than `longest_edge`. If there are no such triangles, the loop stays open. So the boundary of a
/// single triangle stays open. Where several fans meet in a vertex, a loop continues with the next fan around the
/// vertex. Returns the number of closed loops. Cost: linear in the triangles, most_edges² per boundary edge, and
/// most_edges³ per loop. Each loop is solved once, whether or not it can be closed.
std::size_t close_small_holes(Surface& surface, std::size_t most_edges, const Execution& execution,
                              double longest_edge = any_length);

struct NarrowHoles {
    std::size_t closed = 0;
    /// Number of triangles that were replaced, because otherwise their loop could not be closed.
    std::size_t replaced = 0;
};

struct NarrowHoleLimits {
    /// Largest enclosing radius of a new triangle, as a multiple of the largest search radius of the loop's points.
    /// Growth likewise uses the larger search radius of an edge's two points.
    double largest_radius;
    /// Loops of at most this many edges are closed whatever their size.
    std::size_t most_edges;
    /// Largest dihedral deviation, in radians, for loops of more than `most_edges` edges. The limit applies within the
    /// triangulation, between it and the surface, and between any two triangles around the loop. With 172 degrees or
    /// more, tips are closed.
    double largest_dihedral;
    /// New edges of all loops are shorter than this.
    double longest_edge = any_length;
};

/// Closes every loop that has a triangulation whose enclosing radii are at most `largest_radius`. No point of such a
/// triangulation is farther than this radius from a vertex, so the loop contains no larger empty circle. The loop is
/// therefore too narrow to be a hole, whatever the number of its edges, unless the surface ends at a sharp edge. Growth
/// leaves such loops at tips, creases and folds: the boundary arrives there from several sides, and no single triangle
/// continues it.
///
/// The triangulation has least area and no dihedral deviation above 172 degrees. It intersects neither the surface nor
/// itself. If there is none, one triangle at a loop of at most 30 edges may be replaced, or two triangles at a loop of
/// at most 12. Triangles are tried in order from the loop's lowest point on; the first success is used.
///
/// Loops of more than 100 edges stay open. A loop also stays open if the surface around it faces away from the
/// triangulation by more than 120 degrees on average. The limit is 78 degrees for loops longer than four radii. In both
/// cases the surface ends at the loop, as at thin walls, channels and narrow strips.
///
/// Pre: every vertex has one fan. Cost: linear in the points, edges³ per loop, and the intersection tests. Where one
/// triangle may be replaced, a loop costs up to 30 times as much; where two may be replaced, up to 156 times.
NarrowHoles close_narrow_holes(Surface& surface, const NarrowHoleLimits& limits, const Execution& execution);

}  // namespace scanmill::growing
