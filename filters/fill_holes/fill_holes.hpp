// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closes the holes of a mesh with triangles that continue the surface around them, and marks what was added.
///
/// Source: Liepa 2003, "Filling holes in meshes", for triangulation and refinement; Botsch, Kobbelt 2004, "An intuitive
/// framework for real-time freeform modeling", for fairing; as CGAL's Polygon_mesh_processing does them.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct FillHolesParams {
    /// Loops with more boundary edges stay open; at least 3. Empty: any number.
    std::optional<u32> max_edges;
    /// Loops that are longer stay open; above 0. Empty: any length.
    std::optional<Length> max_length;
    /// Moves the new vertices so that the new triangles continue the surface without a crease. Otherwise the vertices
    /// stay in the triangles that span the loop.
    bool fair = true;
    /// Closes the surface as a whole if loops stay open otherwise, unless a limit left others open.
    bool together = true;
};

struct FillHolesResult {
    /// The input's vertices and triangles in their rows, then the new ones, loop by loop. Sharp edges and edge
    /// columns are the input's.
    TriangleMesh mesh;
    /// Loops closed; loops that a limit left open; loops that could not be triangulated.
    std::size_t filled = 0, beyond_limits = 0, failed = 0;
    /// Loops of `filled` whose faired triangulation would have met the surface, so that a plainer one was used.
    std::size_t plain = 0;
    /// Loops of `filled` that were closed together, as the boundary of a solid; triangles of the input that this
    /// replaced.
    std::size_t together = 0, replaced = 0;
    /// Total area of the hole triangulations.
    double area = 0;
    /// Length of the longest filled loop; 0 without one.
    double longest = 0;
};

/// Fills every boundary loop within the limits, also the outer boundary of an open surface.
///
/// Loops. The boundary continues in the same fan of triangles; at a vertex with several fans it continues in the next
/// one, in order of their half-edges. Where it comes back to a vertex, the part between is a loop of its own. So holes
/// that touch in a vertex are separate holes. Limits include their bounds: a loop of exactly `max_edges` edges, or
/// exactly `max_length` long, is filled.
///
/// Triangulation. CGAL chooses among the triangles of the Delaunay tetrahedralisation of the loop's vertices (among all
/// triangles if these do not suffice and the loop has at most 200 vertices). It minimises the largest angle to
/// neighbours, then the area. Triangles are then divided until their edges are about as long as those around the loop,
/// and with `fair` the new vertices are moved to continue the surface with equal tangents. No triangulation repeats an
/// edge of the mesh. One that intersects the mesh, itself or another one (see triangles_intersect.hpp; vertices of
/// the mesh at one position count as one), or repeats an edge of another one, is replaced by the triangulation before
/// fairing, then by that before division, then, for a loop of at most 100 edges, by the triangles of least total
/// area that do not intersect the mesh. If that also conflicts, the loop stays open. If two triangulations conflict
/// with each other, only one is replaced: the one with more edges, or the later one.
///
/// Together. If loops stay open and no limit left others open, the surface with its new triangles is closed as a whole:
/// see closing_solid.hpp. That closes rings, holes with islands, and loops that cross themselves. It replaces some
/// triangles of the input by others on the same vertices, and leaves out surfaces inside the solid. If this is not
/// possible, as on flat sheets, or if more than half of the area would be new, these loops stay open and the rest
/// is as without `together`.
///
/// Columns. A new vertex has the values of the loop's vertex from which it is reached over the fewest edges (ties: the
/// first along the loop). A new triangle has those of the triangle at the loop's edge that starts at the first such
/// vertex of its corners. Exceptions: the vertex column `normal` is
/// the vertex's normal on the new surface, and the face column `corner-normals` repeats the triangle's own. The face
/// column `filled` and the vertex column `filled` (uint8) are 1 for new ones; where the input has such a column, its
/// marks stay. A column `filled` of another type is replaced, with a warning.
///
/// Pre:  at least one triangle; finite vertices; at most two triangles at an edge, oriented consistently; no triangle
///       with a repeated vertex. Throws Error naming the first offender otherwise, and for parameters out of range.
/// Post: no vertex of the input is moved or removed, and no triangle unless loops are closed together; then the mesh is
///       closed and does not intersect itself. Every other filled loop is closed by a disc that intersects nothing.
/// Doubts its result if loops are closed together, if a filled loop is longer than the diagonal of the mesh's box, if
/// more than 5 % of the area is filled, and if a loop stays open that no limit excludes. Warns of boundary edges at
/// equal positions.
///
/// Deterministic: the same bytes for any number of threads. Cost: linear in the triangles and about 1 µs for each of
/// them if there is a loop; triangulating n vertices takes about n² time. Closing together: O(n log n) time and about
/// 2 kB per vertex, for all vertices.
/// Metrics: `filled`, `left`, `added-triangles`, `added-points`, `area`, `share`, `longest`, `plain`, `together`,
/// `replaced-triangles`, `failed`.
FillHolesResult fill_holes(const TriangleMesh& mesh, const FillHolesParams& params, Context& context);

}  // namespace scanmill
