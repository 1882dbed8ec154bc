// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Edge flipping: replaces the two triangles at an edge by the two at the other diagonal of their quadrilateral. An
/// edge is flipped where this improves the triangles and hardly moves the surface.
///
/// Source: Sangveraphunsiri, Srirakulchai 2006, section 4, for the criteria `shorter` and `paper`; Lawson 1977,
/// "Software for C1 surface interpolation", for the criterion `delaunay`.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct EdgeFlipParams {
    enum class Criterion {
        delaunay,  ///< the least of the six angles of the two triangles grows by more than 1e-9 radians
        shorter,   ///< the other diagonal is shorter than the edge by more than a billionth
        /// The other diagonal is shorter, and the normals of the new triangles are more than 90 degrees apart. This
        /// makes folds.
        paper
    };
    Criterion criterion = Criterion::delaunay;
    /// Largest dihedral deviation after a flip; a larger one is allowed if it was there before the flip. 0 to 60
    /// degrees.
    Angle keep_angle = Angle::degrees(20);
    /// Largest distance between the two diagonals, as a share of the shorter one; 0 or more.
    Ratio deviation = Ratio::percent(10);
    /// New edges are shorter than this; above 0. Absent: any length.
    std::optional<Length> max_edge;
    /// Standard deviation of the vertices' distances from the surface; 0 or more. If absent, vertex_noise() estimates
    /// it. Without effect on the criterion `paper`.
    std::optional<Length> noise;
};

/// The edge between a and b became the edge between c and d: triangles (a, b, c) and (b, a, d) became (c, a, d) and
/// (d, b, c).
struct EdgeFlip {
    u32 a, b, c, d;
    bool operator==(const EdgeFlip&) const = default;
};

/// Edges that fulfil the criterion and were not flipped, each counted once, by the first reason in this order.
struct BlockedEdges {
    std::size_t sharp = 0;  ///< the edge is a sharp edge of the mesh, or with noise a crease
    std::size_t connected = 0;  ///< the other diagonal already is an edge
    std::size_t folding = 0;  ///< the new triangles would fold, or exceed keep_angle
    std::size_t deviating = 0;  ///< the diagonals are farther apart than `deviation` allows
    std::size_t too_long = 0;  ///< the other diagonal is not shorter than max_edge

    std::size_t total() const { return sharp + connected + folding + deviating + too_long; }
    bool operator==(const BlockedEdges&) const = default;
};

struct EdgeFlipResult {
    /// The vertices with their columns, the sharp edges and the frame are the input's. Triangles that no flip changed
    /// keep their row. Face columns and edge columns are dropped, with a warning.
    TriangleMesh mesh;
    /// In the order in which they were made.
    Array<EdgeFlip> flips;
    BlockedEdges left;
    /// The least angle of all triangles, in radians; 0 if the vertices of a triangle are collinear.
    double min_angle_before = 0, min_angle_after = 0;
};

/// Flips edges until none can be flipped.
///
/// An edge is flipped if
/// 1. it has two triangles and is not one of the mesh's sharp edges, nor, with noise, a crease of find_creases() at the
///    sharp angle of FeatureParams;
/// 2. the other diagonal is not an edge yet;
/// 3. the two triangles, unfolded into a plane, form a convex quadrilateral: their angles at each end of the edge sum
///    to less than π - 1e-6. Otherwise the other diagonal is outside, and the edge does not count as blocked;
/// 4. the criterion is fulfilled;
/// 5. the new triangles do not fold: their normals are less than 90° from each other, and from the sum of the old
///    normals weighted by area. The largest dihedral deviation at the five edges of the two triangles is at most
///    `keep_angle`, or not larger than before;
/// 6. the distance between the two diagonals, as segments, is at most `deviation` times the length of the shorter one;
/// 7. the other diagonal is shorter than `max_edge`.
/// The criterion `paper` uses the rules 1, 2, 4 and 7 only. The paper has no other rules, and with 3 or 6 it would flip
/// nothing.
///
/// On a mesh with noise, the normals of small triangles do not show how the surface bends. So the second sentence of
/// rule 5 uses the normals of neighbourhoods for the triangles that are unreliable in the input, see noisy_normals.hpp.
/// If at least one of two triangles is unreliable, both triangles after the flip have the mean of their two normals,
/// and are unreliable. A second run estimates noise and normals from the flipped mesh.
///
/// A triangle has no normal if its height is below a billionth of its longest edge. For rule 5, it takes the normal of
/// the other triangle at its longest edge. Edges are examined first in, first out: the longest edges of such triangles
/// first, then all edges in the order of the triangles. An edge is examined again after a triangle at it changed. When
/// no edge is waiting, all edges are examined once more; the filter ends if none of them can be flipped.
///
/// Pre:  at least one triangle; finite vertices; at most two triangles at an edge, oriented consistently; one fan of
///       triangles, open or closed, at a vertex; no triangle with a repeated vertex. Throws Error naming the first
///       offender otherwise. Also throws for sharp edges that no triangle has, and for parameters out of range.
///       Vertices at one position are different vertices, and the mesh is open between them. A warning gives their
///       number.
/// Post: the vertices and the boundary stay, and so do the numbers of edges and triangles. With noise 0, a second run
///       flips nothing. With `delaunay`, every flip makes the sorted list of all angles larger in lexicographic order.
///       With the other criteria, every flip makes the sum of all edge lengths smaller. So the flips end. In a plane
///       mesh, `delaunay` makes a Delaunay triangulation: no vertex is inside the circumcircle of a triangle, within
///       these tolerances.
///       Ties: an edge stays if the other diagonal is equally good. Deterministic: the same bytes on every machine.
/// Cost: linear time in practice; at worst, quadratic in the number of edges. 60 bytes per triangle beside the result,
///       and 16 per flip. The costs of vertex_noise() and, with noise, of find_creases() are added.
/// Metrics: `flips`, `min-angle-before`, `min-angle-after`, `left`. Warns of edges that are left, by reason, and of
/// columns that are dropped.
EdgeFlipResult edge_flip(const TriangleMesh& mesh, const EdgeFlipParams& params, Context& context);

}  // namespace scanmill
