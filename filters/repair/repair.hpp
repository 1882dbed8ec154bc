// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes an oriented 2-manifold, closed or with boundary, from any triangles. Joins cuts, orients neighbours equally,
/// splits edges and vertices where several surfaces meet, and drops triangles without area and small components.
///
/// Source: Gueziec, Taubin, Lazarus, Horn 2001, "Cutting and stitching: converting sets of polygons to manifold
/// surfaces", as CGAL's Polygon_mesh_processing::orient_polygon_soup does it.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct RepairParams {
    /// Vertices on the boundary at most this far apart are joined; 0 or more. Vertices at one position are joined in
    /// any case, on the boundary or not.
    Length stitch = Length(0.0);
    /// Connected components with less than this share of the area are removed, from 0 to 1.
    Ratio min_component = Ratio::percent(0);
};

struct RepairResult {
    TriangleMesh mesh;
    std::size_t stitched = 0;  ///< vertices joined to another one
    std::size_t repeated_vertex = 0;  ///< triangles removed because two of their corners are one vertex
    std::size_t duplicates = 0;  ///< triangles removed because an earlier one has the same three vertices
    std::size_t without_area = 0;  ///< removed triangles of three collinear vertices, at the boundary
    std::size_t small = 0;  ///< triangles removed with their component
    std::size_t flipped = 0;  ///< triangles of three collinear vertices replaced by a flip of their longest edge
    std::size_t oriented = 0;  ///< triangles that were reversed
    std::size_t split_edges = 0;  ///< edges that had three or more triangles
    std::size_t split_vertices = 0;  ///< copies of vertices, made where several surfaces met
    std::size_t removed_components = 0;  ///< below min_component
    std::size_t unused_points = 0;  ///< vertices that are in no triangle of the result
    bool was_closed = false;  ///< every edge had two triangles or more, after stitching
    std::size_t left_without_area = 0;  ///< triangles of three collinear vertices that stay
};

/// 1. Stitch. Vertices at one position become the one with the lowest row. With `stitch` above 0, vertices on the
///    boundary (at an edge with one triangle) are then visited in order of rows. Each joins the nearest visited vertex
///    that stayed, if that is at most `stitch` away; ties: the lower row. Otherwise it stays, with its position and its
///    values.
/// 2. Triangles with a repeated vertex are removed. Of triangles with the same three vertices, in any order, only the
///    first stays.
/// 3. Orient and split (CGAL). Triangles at an edge with two triangles are oriented equally, starting from the first
///    triangle. Edges with three or more triangles are borders, and so are edges where equal orientation is impossible
///    (as on a Moebius strip). There, vertices get copies so that every vertex has one fan of triangles. Copies are at
///    the same position. Then each closed component faces outwards, or inwards if it bounds a cavity (see sides.hpp).
///    An open component takes the orientation that more of its area had, in a tie that of its first triangle. A closed
///    component without volume does the same.
/// 4. Triangles of three exactly collinear vertices are replaced: the longest edge is flipped. At the boundary they are
///    removed, and vertices at which they joined two fans are split. A triangle whose flip would repeat an existing
///    edge stays, with a warning.
/// 5. Connected components with less than `min_component` of the area are removed; those at the limit stay.
///
/// Columns. Vertices, triangles and edges keep their values and their order. Copies of vertices come last, with the
/// values of the original. A flip swaps area between two triangles; both keep their values. Only the face column
/// `corner-normals` follows the corners: reversing a triangle reverses its normals, and after a flip they are the
/// triangle's own normal. Sharp edges and rows of edge columns stay while their edge exists. If a split makes two edges
/// of one, both are sharp and the first has the row.
///
/// Pre:  at least one triangle; finite vertices. Throws Error otherwise, for parameters out of range, and if no
///       triangle is left.
/// Post: at most two triangles at an edge, oriented equally; one fan at a vertex; no triangle with a repeated vertex;
///       no unused vertex. A second run with the same parameters and `min_component` 0 changes no triangle, except that
///       it joins and splits the same vertices again.
/// Doubts its result if more than 5 % of the area is removed (duplicates do not count), or if a mesh without boundary
/// has a boundary afterwards.
///
/// Deterministic: serial, the same bytes on every machine. Cost: O(n log n) time, about 500 bytes per triangle. An
/// oriented manifold that needs no repair is returned in linear time, without a copy.
/// Metrics: `oriented`, `stitched`, `split-vertices`, `split-edges`, `removed-triangles`, `removed-components`,
/// `removed-points`, `flipped`, `components`, `boundary-loops`.
RepairResult repair(const TriangleMesh& mesh, const RepairParams& params, Context& context);

}  // namespace scanmill
