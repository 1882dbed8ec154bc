// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Adds vertices to a mesh with long edges: each long edge is split at its midpoint, the longest first. The surface
/// does not change.

#include <array>
#include <functional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::updating {

/// Default limit of the number of points that resampled() adds.
inline constexpr std::size_t most_added = 50'000'000;

/// The progress that resampled() reports, as fractions of the whole filter.
inline constexpr double resampling_begin = 0.2, resampling_end = 0.3;

struct Resampled {
    TriangleMesh mesh;
    std::size_t added = 0;  ///< number of new vertices
};

/// Splits edges until no edge longer than `longest` is in a triangle that counts. Splitting an edge splits its one or
/// two triangles.
///
/// `counts` is called with the corners of a triangle that has a long edge; halves of triangles are judged anew. It must
/// depend on the corners only. If it is empty, all triangles count.
///
/// Pre:  finite vertices. Triangles with a repeated vertex, and two triangles with the same three vertices, stay as
///       they are. Throws Error if `longest` is not above 0, or if more than `most` points would be added: at the start
///       if all triangles count and the areas or edge lengths prove it, else when the limit is reached. If there is
///       something to split, throws Error where half_edges::opposites() does: edges have at most two triangles,
///       oriented consistently.
/// Post: without `counts`, no edge is longer than `longest`. If there is nothing to split, the result shares all memory
///       with `mesh`. Else the old vertices keep their rows, and the new ones follow in the order of the splits. A
///       split triangle keeps its row for the half with the lower vertex row of the split edge; the other half is
///       appended, first that of the triangle that passes the edge from the lower row to the higher one.
///       Vertex columns of floating-point numbers get the mean of both ends, `normal` scaled to unit length; lists,
///       columns of integers, and the normal between opposite normals are those of the lower row. Halves have the face
///       columns of their triangle. Both halves of a sharp edge are sharp. In `edges`, the parts of a split edge
///       replace it, in order from its first vertex to its second one, each with a copy of its row.
/// Ties: among equally long edges, the one with the lower vertex rows is first, by its lower row and then by its higher
///       one. Lengths are compared as squares of doubles. The result does not depend on the number of threads.
/// Cost: one pass if no edge is long; else O(n log n) in the number n of long edges, and a pass that finds the
///       neighbours. About 150 bytes per new vertex and 30 per triangle.
/// Source: Rosenberg, Stenger 1975, "A lower bound on the angles of triangles constructed by bisecting the longest
///       side": if all triangles count, no part of a triangle has an angle below half of the triangle's least one.
Resampled resampled(const TriangleMesh& mesh, double longest,
                    const std::function<bool(const std::array<Vec3, 3>&)>& counts, Context& context,
                    std::size_t most = most_added);

}  // namespace scanmill::updating
