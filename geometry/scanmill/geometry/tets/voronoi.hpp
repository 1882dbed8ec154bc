// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The Voronoi diagram of the vertices, as the dual of their Delaunay tetrahedralisation: poles, edges and cocones.
///
/// The Voronoi cell of a vertex p is the set of the points that are not nearer to another vertex. Its corners are the
/// circumcentres of the cells at p. Each of its edges is dual to a facet at p: the segment between the circumcentres of
/// the facet's two cells, or for a facet of the hull a ray that leaves the hull at a right angle.
///
/// The positive pole of p is the farthest corner of its Voronoi cell. Near a densely sampled surface, the Voronoi cell
/// is long and thin, and the direction from p to the pole is close to the surface's normal. The cocone of p is the part
/// of the Voronoi cell in directions near the tangent plane: those that make at least the angle 90° - `cone_angle` with
/// the pole's direction and with its opposite.
///
/// Everything here is for points without weights: with them, circumcentres are not the corners of the dual.
///
/// Source: Amenta, Choi, Dey, Leekha 2000 for cocones; Amenta, Bern 1999 for poles; used by Woo, Dey 2005, section 2.

#include <cstdint>
#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/tets/vertex_cells.hpp"

namespace scanmill {

/// The points foot + t normal, for t between `from` and `to`.
struct VoronoiEdge {
    /// The circumcentre of the dual facet. Of the edge's line, it is the point nearest to the facet's corners.
    Vec3 foot;
    Vec3 normal;  ///< unit normal of the dual facet
    double from, to;  ///< equal if both cells share one circumsphere; `to` is infinite for a ray
};

/// The edge dual to the facet opposite to a corner; its normal leaves the cell. For a facet whose corners are collinear
/// to rounding, the circumcentre of the cell, with normal 0. Pre: `centres` are circumcentres().
VoronoiEdge dual_edge(const TetMesh& tets, std::span<const Vec3> centres, u32 cell, int corner);

struct Poles {
    /// By vertex: the unit vector to the positive pole. At the hull the Voronoi cell is unbounded and the positive pole
    /// infinitely far; the vector is then the normalised sum of the outward unit normals of the hull's facets there.
    Array<Vec3> directions;
    /// By vertex: the distance to the nearer of two poles. The negative pole is the farthest corner of the Voronoi cell
    /// on the other side, seen in the direction of the positive one. Infinite if there is neither.
    Array<double> heights;
};

/// Ties: of equally far corners, that of the lower cell. Cost: linear.
Poles poles(const TetMesh& tets, std::span<const Vec3> centres, const VertexCells& cells_at, Execution& execution);

struct Cocone {
    Vec3 apex;
    Vec3 axis;  ///< a unit vector
    double squared_sine;  ///< squared sine of the cone angle, which is below 45 degrees

    /// The cone beyond the cocone that contains a direction: 1 for the one round the axis, -1 for the opposite one, 0
    /// if the direction is in the cocone. A direction on a limit is in the cocone.
    int side(const Vec3& direction) const {
        const double along = direction.dot(axis);
        if (along * along <= squared_sine * direction.squaredNorm()) return 0;
        return along > 0 ? 1 : -1;
    }
    /// Whether a point of the edge lies in the cocone. The cones beyond the cocone are convex, so an edge does not meet
    /// the cocone exactly if both its ends lie in the same one. Pre: the apex is a corner of the dual facet.
    bool meets(const VoronoiEdge& edge) const;
    /// The squared distance from the apex to the point where the edge crosses the tangent plane, which is perpendicular
    /// to the axis; -1 if it does not. Pre: as above.
    double squared_reach(const VoronoiEdge& edge) const;
};

/// By cell: bit 4 i + j is set if the edge dual to the facet opposite to corner i meets the cocone of corner j. The
/// facet's other two corners are then *cocone neighbours* of corner j: their Voronoi cells meet its cocone, because a
/// face of a Voronoi cell meets the cocone exactly if one of the face's edges does. Cost: linear.
Array<std::uint16_t> cocone_hits(const TetMesh& tets, std::span<const Vec3> centres, const Poles& poles,
                                 double cone_angle, Execution& execution);

/// The corner of the cell across the facet opposite to `corner` that is not on this facet. Pre: there is such a cell.
inline int corner_across(const TetMesh& tets, u32 cell, int corner) {
    const std::array<u32, 4>& back = tets.neighbours[tets.neighbours[cell][static_cast<std::size_t>(corner)]];
    return back[0] == cell ? 0 : back[1] == cell ? 1 : back[2] == cell ? 2 : 3;
}

/// Whether the facet opposite to `corner` is counted at this cell: each facet is counted once, at its lower cell.
inline bool owns_facet(const TetMesh& tets, u32 cell, int corner) {
    return tets.neighbours[cell][static_cast<std::size_t>(corner)] > cell;
}

}  // namespace scanmill
