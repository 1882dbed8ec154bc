// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Adds vertices to a mesh with long edges: each long edge is split at its midpoint, the longest first. Where the
/// surface is flat, edges of thin triangles are flipped, so that the vertices are evenly spread. The surface does not
/// change.

#include <array>
#include <functional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::updating {

/// Default limit of the number of points that resampled() adds.
inline constexpr std::size_t most_added = 50'000'000;

/// The progress that resampled() reports, as fractions of the whole filter.
inline constexpr double resampling_begin = 0.2, resampling_end = 0.3;

/// Sine of the least angle below which a triangle is thin (14.5°). Right triangles with sides 1 : 3, and thus most
/// boxes, stay as bisection makes them.
inline constexpr double thin_sine = 0.25;

struct Resampled {
    TriangleMesh mesh;
    std::size_t added = 0;  ///< number of new vertices
};

/// Splits edges until no edge longer than `longest` is in a triangle that counts. Splitting an edge splits its one or
/// two triangles. After every split, edges are flipped until none is left that may and has to be: after the first
/// split, the edges of triangles with a long edge (if all triangles count, all edges), then those around the change.
///
/// An edge may be flipped if it is not declared (in `sharp_edges` or `edges`), and both its triangles count, face the
/// same way and are in one plane: the old and the new edge are at most 1e-9 of the old one apart, or at most the
/// rounding of single precision if all coordinates of `mesh` have it. It has to be flipped if one of the triangles is
/// thin, and each is inside the other one's circumcircle by more than rounding.
///
/// A side that may not be flipped is split before a longer one that may if the third side of their triangle is shorter
/// than half of `longest`: in a strip between two creases, no vertex is added between those on the creases.
///
/// `counts` is called with the corners of a triangle that has a long edge or an edge that would be flipped; parts of
/// triangles are judged anew. It must depend on the corners only. If it is empty, all triangles count.
///
/// Pre:  finite vertices. Triangles with a repeated vertex, and two triangles with the same three vertices, stay as
///       they are. Triangles that overlap in one plane may become ones that share an edge with two others. Throws Error
///       if `longest` is not above 0, or if more than `most` points would be added: at the start if all triangles count
///       and the area or the edges that may not be flipped prove it, else when the limit is reached. If there is
///       something to split, throws Error where half_edges::opposites() does: edges have at most two triangles,
///       oriented consistently.
/// Post: without `counts`, no edge is longer than `longest`. If there is nothing to split, the result shares all memory
///       with `mesh`. Else at least one vertex is added, the old vertices keep their rows, and the new ones follow in
///       the order of the splits. A split triangle keeps its row for the half with the lower vertex row of the split
///       edge; the other half is appended, first that of the triangle that passes the edge from the lower row to the
///       higher one. The triangles at a flipped edge take the two rows of the old ones.
///       Vertex columns of floating-point numbers get the mean of both ends, `normal` scaled to unit length; lists,
///       columns of integers, and the normal between opposite normals are those of the lower row. Triangles have the
///       face columns of the old triangle that their row comes from by splits. Both halves of a sharp edge are sharp.
///       In `edges`, the parts of a split edge replace it, in order from its first vertex to its second one, each with
///       a copy of its row.
/// Ties: among equally long edges, the one with the lower vertex rows is first, by its lower row and then by its higher
///       one. Lengths are compared as squares of doubles. Which of several edges is flipped first depends on the order
///       of the rows. The result does not depend on the number of threads.
/// Cost: one pass if no edge is long; else O(n log n) in the number n of long edges if a split causes few flips, and
///       two passes that find the neighbours and the flips. About 150 bytes per new vertex and 30 per triangle.
/// Source: Rivara 1984, "Algorithms for refining triangular grids suitable for adaptive and multigrid techniques", the
///       longest edges; Lawson 1977, "Software for C1 surface interpolation", the flips. Rosenberg, Stenger 1975, "A
///       lower bound on the angles of triangles constructed by bisecting the longest side": without flips, and if all
///       triangles count, no part of a triangle has an angle below half of the triangle's least one.
Resampled resampled(const TriangleMesh& mesh, double longest,
                    const std::function<bool(const std::array<Vec3, 3>&)>& counts, Context& context,
                    std::size_t most = most_added);

}  // namespace scanmill::updating
