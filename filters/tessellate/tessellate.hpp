// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Triangles on the zero set of a patch complex, after Bernardini et al. 1997, section 5: watertight, without
/// T-junctions, with the exact normals and with vertices on creases.

#include <functional>
#include <optional>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/patches.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill {

struct TessellateParams {
    /// Segments per edge of the mesh; with max_error the largest number.
    u32 subdivision = 8;
    /// Largest distance between the triangles and the surface, above 0. If absent, all edges get `subdivision`
    /// segments.
    std::optional<Length> max_error;
    /// Returns the segments of an edge of the mesh, given its two vertices. If empty, they follow from the other two
    /// parameters. Any mixture of numbers fits together.
    std::function<unsigned(Edge)> segments = nullptr;
};

/// A grid over every triangle of the mesh is lifted to the surface along lines to the apex on its side. Fans of lines
/// between the two apexes span the gap beside an edge. The samples on an edge depend on the edge alone, so neighbours
/// fit. One sample is where the surface crosses the edge. Beside a sharp edge, the way from face to face has a vertex
/// where the function that holds changes from one triangle's to the other's, exact to rounding. This vertex is in the
/// gap, or above one of the triangles, whose grid then begins there. Where the complex has no tetrahedra beside an
/// edge, a straight line closes the gap between the two faces.
///
/// Where samples coincide, their vertices are joined, so that no triangle has two corners at one position. If that
/// would open a closed mesh, or make a manifold non-manifold, no vertices are joined.
///
/// Vertices: those of the mesh that are used, then edge by edge, then triangle by triangle. Columns:
/// - Vertex `normal`: unit vector along the gradient; zero where the gradient is. On creases it is the mean of both
///   sides' normals, at their ends the mean of the triangles' normals.
/// - Face `patch` (u32): the row of the mesh's triangle. Between edge and crease, it is the triangle whose function
///   holds.
/// - Face `side` (u8): 1 where the surface is outside the mesh or on it.
/// - With sharp edges: face `corner-normals` (9 numbers: three normals, each of the triangle's side). The creases are
///   then `sharp_edges`.
///
/// With max_error, edges get 1, 2, 4, … segments. Triangles get as many rows of points between their base point and
/// their edges. Both grow until the triangles are within max_error of the surface. The distance is measured, not
/// bounded: it is |F| / |grad F| at two points of each edge and at the centre of each triangle. On spheres and tori,
/// random points reached 0.99 max_error. A quarter of max_error doubles the segments. Compared with equilateral
/// triangles of the best size, spheres got 7 to 15 times and tori 10 to 40 times as many triangles. There are two
/// reasons. The segments are powers of two, and lines to an apex make a small angle with the surface near a vertex
/// where the mesh is coarse.
///
/// Where the surface jumps, as beside a crease that leaves its tetrahedra, no number of segments suffices: twice as
/// many do not bring the triangles nearer. With `left`, the result then has `subdivision` segments there, and `left` is
/// the distance that remains; otherwise it is 0. Throws Error if `subdivision` does not suffice, with the distance that
/// remains and an estimate of what suffices. Also throws Error for patches without tetrahedra or with some missing, and
/// for parameters out of range. Cost: linear in the triangles made, about 1 us each.
TriangleMesh tessellate(const PatchComplex& patches, const TessellateParams& params, Execution& execution,
                        double* left = nullptr);

/// The largest distance between a sharp edge of the mesh and the crease beside it, of `segments` - 1 points of every
/// crease; 0 without sharp edges.
double largest_bulge(const PatchComplex& patches, unsigned segments, Execution& execution);

/// The mesh, with vertices at equal positions joined where edges of triangles connect them, and without the triangles
/// that have a repeated vertex then. The first of the joined vertices keeps its columns. The mesh itself if no triangle
/// has two corners at one position, or if a closed mesh would not stay closed. Pre: no edge columns.
TriangleMesh without_equal_corners(const TriangleMesh& mesh);

}  // namespace scanmill
