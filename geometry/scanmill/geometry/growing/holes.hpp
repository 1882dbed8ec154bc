// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closing loops that growth left open although they are no holes: loops of few edges, and loops that are too narrow.

#include <limits>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/growing/intersections.hpp"

namespace scanmill::growing {

inline constexpr double any_length = std::numeric_limits<double>::infinity();

/// Limits of the triangles that close a hole.
struct TriangulationLimits {
    /// Largest enclosing radius of a triangle; infinite: any size.
    double largest_radius;
    /// Least cosine between the normals of triangles that share an edge.
    double dihedral_cosine;
    /// Edges of the triangulation other than those of the loop are shorter than this.
    double longest_edge = any_length;
};

inline constexpr double any_dihedral = -2;

/// Whether a triangulation within the limits exists that repeats no edge, whatever it intersects.
bool can_be_triangulated(const Surface& surface, const std::vector<u32>& corners, const TriangulationLimits& limits);

/// The triangles of least total area that close the loop of `corners` (each once, counter-clockwise as the triangles
/// will be). Empty when no triangulation was found that keeps the limits, repeats no edge of the surface, and
/// intersects neither the surface nor itself. Ties: the one that joins the first corners. Parts of the loop are
/// solved first and separately, so a triangulation whose parts are not optimal is not found.
///
/// `near` is working memory. Cost: at most corners³ / 6 triangles; those that would lower the area are tested against
/// the surface near the loop.
std::vector<Triangle> triangulate_hole(const Surface& surface, NearTriangles& near, const std::vector<u32>& corners,
                                       const TriangulationLimits& limits);

/// Closes every loop of at most `most_edges` boundary edges with the triangles of least total area, unless one would
/// fold back on a joined triangle by more than 150 degrees (so a single triangle keeps its boundary), repeat an edge,
/// intersect others, or would need a new edge that is not shorter than `longest_edge`. Where several fans meet in a
/// vertex, a loop continues with the next fan around it. Returns the number of closed loops. Cost: linear in the
/// triangles, most_edges² per boundary edge, and most_edges³ per loop, which is solved once whether it can be closed or
/// not.
std::size_t close_small_holes(Surface& surface, std::size_t most_edges, const Execution& execution,
                              double longest_edge = any_length);

struct NarrowHoles {
    std::size_t closed = 0;
    /// Triangles removed because a loop could be closed only in place of them.
    std::size_t replaced = 0;
};

struct NarrowHoleLimits {
    /// In the largest search radius of a loop's points, as growth uses the larger one of an edge.
    double largest_radius;
    /// Loops of at most this many edges are closed whatever their size.
    std::size_t most_edges;
    /// Largest dihedral deviation, in radians, within the triangulation of a longer loop, between it and the surface,
    /// and between any two triangles around the loop. From 172 degrees on tips are closed.
    double largest_dihedral;
    /// New edges, also those of loops of at most `most_edges` edges, are shorter than this.
    double longest_edge = any_length;
};

/// Closes every loop that has a triangulation whose enclosing radii are at most `largest_radius`. No point of it is
/// farther than that from a vertex, so the loop contains no larger empty circle: it is too narrow to be a hole,
/// whatever the number of its edges, unless the surface ends at a sharp edge there. Such loops are left at tips,
/// creases and folds, where the boundary arrives from several sides and no single triangle continues it.
///
/// The triangulation has least area and no dihedral deviation above 172 degrees; it intersects neither the surface nor
/// itself. If there is none, one triangle at a loop of at most 30 edges may be replaced, or two at a loop of at most
/// 12: the first ones, from the loop's lowest point on, for which there is one. Loops of more than 100 edges stay open,
/// and loops where the surface faces away from the triangulation, by more than 120 degrees on average, or by more than
/// 78 if the loop is longer than four radii: the surface ends there, as at thin walls, channels and narrow strips.
///
/// Pre: every vertex has one fan. Cost: linear in the points; edges³ per loop, up to 30 times as much where one
/// triangle may be replaced and 156 times where two, and the intersection tests.
NarrowHoles close_narrow_holes(Surface& surface, const NarrowHoleLimits& limits, const Execution& execution);

}  // namespace scanmill::growing
