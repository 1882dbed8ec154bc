// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `rebuild: local`: replaces a part of a closed mesh by the surface through new points. All other triangles stay as
/// they are, and the work does not grow with the mesh.
///
/// For each change, or several changes that are near each other:
/// 1. The *collar* consists of the facets that are connected to the removed ones and have a vertex within three
///    spacings of them. The *guard* consists of all other facets within about three spacings of these, whether they
///    are connected or belong to an opposite wall. The spacing is the cloud's or the median edge of the facets beside
///    the removed ones, whichever is larger.
/// 2. A new surface is made as by tight-cocone from the points of the change and the vertices of these facets that are
///    not discarded. The sample ends at the guard, so the hull does not show which side is outside; the facets that
///    remain do. Eight points far away keep the surface off the hull, where it would have no inner cells.
/// 3. An edge is *common* if both surfaces have it. Facets are marked, beginning with the removed ones and with the new
///    facets at new points. Over an edge that is not common, the mark passes to the neighbour in the same surface; over
///    a common one, to the facet of the other surface on the same side of the edge. So the marked facets of both
///    surfaces end up with the same boundary, edge for edge: the seam. The marked facets of the mesh are exchanged for
///    those of the new surface. Marks must stay within the collar; otherwise all steps are repeated with collar and
///    guard twice as wide. Parts of the new surface without a seam are not used.
///
/// Facets of the mesh that the new surface does not have are therefore kept unless they are connected to the change,
/// and a planar quadrangle may have its other diagonal: the mesh need not be a Delaunay surface of its vertices.
///
/// Source: Woo, Dey 2005 for the problem; the method is our own. bench/quality/update-sweep-local.md shows how often it
/// refuses.

#include <optional>
#include <span>
#include <vector>

#include "cocone/cocone.hpp"
#include "mesh_update/model.hpp"

namespace scanmill::updating {

/// The change that one cloud makes.
struct LocalChange {
    /// Rows of facets of the mesh, among them all facets at discarded vertices. Without any, the change has no effect.
    std::vector<u32> removed;
    /// Rows of points.
    std::vector<u32> points;
    /// Median distance of the cloud's points to their nearest neighbours; above 0.
    double spacing = 0;
};

struct LocalRebuild {
    /// Rows of the facets of the mesh that are replaced: the removed ones, and those of the collar where the new
    /// surface differs. Ascending.
    std::vector<u32> replaced;
    /// Vertices of the mesh that were in a replaced facet and are in no triangle any more: the discarded ones, and
    /// those that the new surface leaves out. Ascending.
    std::vector<u32> dropped;
    /// The new triangles. An index below #mesh.positions is a vertex of the mesh; others are rows of points, plus that
    /// number.
    Array<Triangle> triangles;
    /// Points of the changes that are in no triangle.
    std::size_t unused_points = 0;
};

/// Pre:  `mesh` is closed and oriented outwards, `opposite` are its half_edges::opposites(), and `tree` contains its
///       triangles. Positions are finite. `discarded` are vertices of the mesh, ascending. Parameters are in the ranges
///       of cocone().
/// Post: without the replaced facets and with the new triangles, the mesh is closed: each edge has two triangles in
///       opposite directions, and each vertex one fan. No new triangle intersects another one, new or not. The bytes do
///       not depend on the number of threads. Changes that are far from each other give the triangles that each gives
///       alone.
/// Throws Error with the word `seam`, a position and numbers if a change leaves nothing of a component of the mesh, if
/// the marks reach beyond the collar, and if the result would break a promise above. The hint is `rebuild: whole`.
/// Cost: that of delaunay() and cocone() for the points of the changes and around them, and a search in `tree` for each
///       cube of three spacings there. Nothing is linear in the mesh.
LocalRebuild rebuild_locally(const TriangleMesh& mesh, std::span<const u32> opposite, const FacetTree& tree,
                             std::span<const Vec3> points, std::span<const LocalChange> changes,
                             std::span<const u32> discarded, const CoconeParams& params, Context& context);

/// Exchanges facets for those of a given closed surface through vertices of the mesh and points, beginning with the
/// removed ones, as step 3 does. So facets that the surface joins in another way, far from the change, stay. Without a
/// value if the result would break a promise of rebuild_locally(), or if nothing of a component of the mesh would stay.
///
/// `removed`: facets of the mesh, ascending, among them all facets at vertices that are not in the surface by intent.
/// Corners of `surface`: vertices of the mesh, or its number of vertices plus rows of points. Cost: linear in both.
std::optional<LocalRebuild> exchanged(const TriangleMesh& mesh, std::span<const u32> opposite, const FacetTree& tree,
                                      std::span<const Vec3> points, std::span<const u32> removed,
                                      std::span<const Triangle> surface, Context& context);

}  // namespace scanmill::updating
