// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Edge flipping: two triangles at an edge are replaced by the two at the other diagonal of their quadrilateral where
/// that makes better triangles and leaves the surface where it is.
///
/// Source: Sangveraphunsiri, Srirakulchai 2006, section 4, for the criteria `shorter` and `paper`; Lawson 1977,
/// "Software for C1 surface interpolation", for the greatest least angle and its limit, the Delaunay triangulation.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct EdgeFlipParams {
    enum class Criterion {
        delaunay,  ///< the least of the six angles grows by more than 1e-9 radians
        shorter,   ///< the other diagonal is shorter, by more than a billionth
        paper  ///< it is shorter and the normals of the new triangles are more than 90 degrees apart: makes folds
    };
    Criterion criterion = Criterion::delaunay;
    /// A flip may leave a dihedral deviation up to this, or up to the largest one that was there. 0 to 60 degrees.
    Angle keep_angle = Angle::degrees(20);
    /// Largest distance between the two diagonals, as a share of the shorter one; 0 or more.
    Ratio deviation = Ratio::percent(10);
    /// New edges are shorter than this; above 0.
    std::optional<Length> max_edge;
};

/// The edge between a and b became the edge between c and d: triangles (a, b, c) and (b, a, d) became (c, a, d) and
/// (d, b, c).
struct EdgeFlip {
    u32 a, b, c, d;
    bool operator==(const EdgeFlip&) const = default;
};

/// Edges that fulfil the criterion and were not flipped, each counted once, by the first reason in this order.
struct BlockedEdges {
    std::size_t sharp = 0;      ///< they are sharp edges of the mesh
    std::size_t connected = 0;  ///< the other diagonal is an edge already
    std::size_t folding = 0;    ///< the new triangles would fold, or exceed keep_angle
    std::size_t deviating = 0;  ///< the diagonals are farther apart than `deviation` allows
    std::size_t too_long = 0;   ///< the other diagonal is not shorter than max_edge

    std::size_t total() const { return sharp + connected + folding + deviating + too_long; }
    bool operator==(const BlockedEdges&) const = default;
};

struct EdgeFlipResult {
    /// The vertices with their columns, the sharp edges and the frame are the input's. Triangles that no flip changed
    /// keep their row. Without face columns and edge columns, with a warning.
    TriangleMesh mesh;
    /// In order.
    Array<EdgeFlip> flips;
    BlockedEdges left;
    /// The least angle of all triangles, in radians; 0 with a triangle of three collinear vertices.
    double min_angle_before = 0, min_angle_after = 0;
};

/// Flips edges until none can be flipped.
///
/// An edge is flipped if
/// 1. it has two triangles and is not one of the mesh's sharp edges;
/// 2. the other diagonal is not an edge yet;
/// 3. the two triangles, unfolded into a plane, form a convex quadrilateral: their angles at each end of the edge sum
///    to less than π - 1e-6 (otherwise the other diagonal is outside, and the edge does not count as blocked);
/// 4. the criterion is fulfilled;
/// 5. the normals of the new triangles are less than 90° from each other and from the sum of the old ones, weighted by
///    area; and the largest dihedral deviation at the five edges of the two triangles is at most `keep_angle`, or at
///    most what it was before;
/// 6. the two diagonals, as segments, are at most `deviation` times the shorter one apart;
/// 7. the other diagonal is shorter than `max_edge`.
/// The criterion `paper` has the rules 1, 2, 4 and 7 only: the paper has no others, and with 3 or 6 it flips nothing.
///
/// A triangle whose height is below a billionth of its longest edge has no normal. Its longest edge is examined first;
/// for rule 5 it has the normal of the other triangle there. Other edges are examined in the order of the triangles,
/// and again when a triangle at them changed, first in, first out; when none is left, all of them once more.
///
/// Pre:  at least one triangle; finite vertices; at most two triangles at an edge, oriented
///       consistently; one fan of triangles, open or closed, at a vertex; no triangle with a repeated vertex. Throws
///       Error naming the first offender otherwise, for sharp edges that no triangle has, and for parameters out of
///       range.
///       Vertices at one position are different vertices: the mesh is open between them, which a warning counts.
/// Post: same vertices, edges, triangles, boundary and Euler characteristic. A second run flips nothing. With
///       `delaunay` the sorted list of all angles grows with every flip, in lexicographic order, and with the others
///       the sum of all edge lengths falls: so the flips end. In a plane mesh, `delaunay` makes a Delaunay
///       triangulation: no vertex is inside the circumcircle of a triangle, within these tolerances.
///       Ties: an edge with an equal diagonal stays. Deterministic: the same bytes on every machine.
/// Cost: in practice linear, 60 bytes per triangle beside the result and 16 per flip; at worst the square of the number
///       of edges in time.
/// Metrics: `flips`, `min-angle-before`, `min-angle-after`, `left`. Warns of edges that are left, by reason, and of
/// columns that are dropped.
EdgeFlipResult edge_flip(const TriangleMesh& mesh, const EdgeFlipParams& params, Context& context);

}  // namespace scanmill
