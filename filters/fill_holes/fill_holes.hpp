// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closes the holes of a mesh with triangles that continue the surface around them, and marks the new vertices and
/// triangles.
///
/// Source: Liepa 2003, "Filling holes in meshes", for triangulation and refinement; Botsch, Kobbelt 2004, "An intuitive
/// framework for real-time freeform modeling", for fairing. Both are done by CGAL's Polygon_mesh_processing.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct FillHolesParams {
    /// The loops that are outer boundaries, which stay open. A loop closed flat adds its flat area to the surface: half
    /// the length of the sum of p x q over its edges pq. Its share is this area divided by the area of the mesh.
    /// - Outer::keep: all loops with a share of at least `large_share`.
    /// - Outer::automatic: the same, if one loop has a share of at least `outer_share`; otherwise none.
    /// - Outer::fill: none.
    enum class Outer { automatic, keep, fill };
    static constexpr double outer_share = 0.4, large_share = 0.02;
    Outer outer = Outer::automatic;
    /// Fills outer boundaries, too, and throws Error if a loop stays open.
    bool must_close = false;
    /// Loops with more boundary edges stay open; at least 3. Empty: any number.
    std::optional<u32> max_edges;
    /// Loops longer than this stay open; above 0. Empty: any length.
    std::optional<Length> max_length;
    /// Moves the new vertices so that the new triangles continue the surface without a crease. Otherwise the vertices
    /// stay in the triangles that span the loop.
    bool fair = true;
    /// If loops cannot be closed one by one, closes the surface as a whole, unless a limit leaves other loops open.
    bool together = true;
    /// Turns closed components that face inwards.
    bool outwards = true;
};

struct FillHolesResult {
    /// The input's vertices and triangles in their rows, then the new ones, loop by loop. Sharp edges and edge
    /// columns are the input's.
    TriangleMesh mesh;
    /// Numbers of loops that were closed, that a limit left open, and that could not be triangulated.
    std::size_t filled = 0, beyond_limits = 0, failed = 0;
    /// Number of outer boundaries that stay open.
    std::size_t outer = 0;
    /// Number of filled loops with a plainer triangulation, because the faired one would have intersected something.
    std::size_t plain = 0;
    /// Number of filled loops that were closed together, as the boundary of a solid. Number of input triangles that
    /// this replaced.
    std::size_t together = 0, replaced = 0;
    /// Total area of the hole triangulations.
    double area = 0;
    /// Length of the longest filled loop; 0 if no loop is filled.
    double longest = 0;
};

/// Fills every boundary loop within the limits that is no outer boundary.
///
/// Outer boundaries. A flat sheet has a share of 1, a hemisphere of 1/2, a cube without its base of 1/5, and face masks
/// of 0.55 to 0.8. The unseen base of a standing figure and the cut through a neck have 0.1 to 0.2: they cannot be told
/// apart, and Outer::automatic closes both. Outer::keep leaves both open. Holes that a scanner left are far below 0.02.
///
/// Loops. The boundary continues in the same fan of triangles. At a vertex with several fans it continues in the next
/// one, in order of their half-edges. Where the boundary comes back to a vertex, the part between is a loop of its own.
/// So holes that touch in a vertex are separate holes. A loop of exactly `max_edges` edges, or exactly `max_length`
/// long, is filled.
///
/// Triangulation. CGAL chooses among the triangles of the Delaunay tetrahedralisation of the loop's vertices. If these
/// do not suffice and the loop has at most 200 vertices, it chooses among all triangles. It minimises the largest angle
/// to neighbours, then the area. Triangles are then divided until their edges are about as long as those around the
/// loop. With `fair`, the new vertices are moved to continue the surface with equal tangents.
///
/// Conflicts. A triangulation must not intersect the mesh, itself or another triangulation (see
/// triangles_intersect.hpp; vertices of the mesh at one position count as one). It must not repeat an edge of the mesh
/// or of another triangulation. A triangulation that does is replaced by the next one in this order: the one before
/// fairing; the one before division; for a loop of at most 100 edges, the triangles of least total area that do not
/// intersect the mesh. If all of them fail, the loop stays open. If two triangulations conflict with each other, only
/// the one with more edges is replaced, or else the later one.
///
/// Together. If loops stay open, although no limit excludes any loop, the surface with its new triangles is closed as a
/// whole: see closing_solid.hpp. This closes rings, holes with islands, and loops that cross themselves. It replaces
/// some triangles of the input by others on the same vertices, and leaves out surfaces inside the solid. These loops
/// stay open if that is not possible, as on flat sheets, or if more than half of the area would be new.
///
/// Columns. A new vertex has the values of the loop's vertex from which it is reached over the fewest edges (ties: the
/// first along the loop). So each corner of a new triangle belongs to one vertex of the loop. The first of these three
/// vertices along the loop starts a loop edge, and the new triangle has the values of the triangle at that edge.
///
/// Exceptions: the vertex column `normal` has the vertex's normal on the new surface, and the face column
/// `corner-normals` has the triangle's own normal three times. The face column `filled` and the vertex column `filled`
/// (uint8) are 1 for new rows. Marks in such columns of the input stay. A column `filled` of another type is replaced,
/// with a warning.
///
/// Pre:  at least one triangle; finite vertices; at most two triangles at an edge, oriented consistently; no triangle
///       with a repeated vertex. Throws Error naming the first offender otherwise, and for parameters out of range.
/// Post: no vertex of the input is moved or removed. Triangles of the input are removed only if loops are closed
///       together; then the mesh is closed and does not intersect itself. Every other filled loop is closed by a disc
///       that intersects nothing.
///       Closed components face outwards, or inwards round a cavity (see sides.hpp); a warning counts the triangles
///       that were turned.
/// Warns of outer boundaries that Outer::automatic leaves open.
/// Doubts its result in five cases: loops are closed together; a filled loop is longer than the diagonal of the mesh's
/// box; more than 5 % of the area is filled; a loop stays open that no limit excludes; a handle passes through filled
/// faces or is hardly the object's (see handles.hpp). Warns of boundary edges at equal positions.
///
/// Deterministic: the same bytes for any number of threads. Cost: linear in the triangles, about 1 µs for each if there
/// is a loop. Triangulating n vertices takes about n² time. Closing together takes O(n log n) time and about 2 kB per
/// vertex, for all vertices.
/// Metrics: `filled`, `left`, `outer`, `largest-share`, `added-triangles`, `added-points`, `area`, `share`, `longest`,
/// `plain`, `together`, `replaced-triangles`, `failed`.
FillHolesResult fill_holes(const TriangleMesh& mesh, const FillHolesParams& params, Context& context);

}  // namespace scanmill
