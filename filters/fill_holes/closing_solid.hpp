// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closes an open mesh as a whole, where its holes cannot be closed one by one: as the boundary of a solid.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// The same triangle with its smallest corner first, in the same direction.
Triangle smallest_first(Triangle triangle);

struct ClosingSolid {
    /// Empty if there is no such solid.
    std::vector<Triangle> triangles;
    /// Copies of vertices, numbered from #positions on: the vertices at whose positions they are.
    std::vector<u32> copies;
};

/// A closed surface on the mesh's vertices that contains nearly all of its triangles.
///
/// The vertices are tetrahedralised (Delaunay). Cells behind a triangle of the mesh are inside, cells in front of one
/// and those beyond the hull are outside; a cell that both claim belongs to the side with more area. Other cells
/// are divided so that the boundary has the least area (minimum cut). Triangles from row `given`
/// on are suggestions: they claim nothing, and a tenth of their area counts. Face-connected parts of
/// either side in which no component of the mesh has most of its triangles are left out. At a vertex where the boundary
/// is not one closed fan, parts of its cells then change sides, as long as such surplus parts disappear; where some are
/// left, every fan gets its own copy of the vertex at the same position. If a fan passes an edge twice, the cells
/// around this edge become inside first.
///
/// Returns the boundary, in the orientation of the mesh; of vertices at one position it uses the first. It is a closed
/// manifold and does not intersect itself, because its triangles are facets of one tetrahedralisation. It lacks the
/// triangles of the mesh that are not such facets. Empty if the vertices are within rounding of a plane, or if
/// that does not help.
///
/// Pre: at least one triangle; finite vertices; `origin` is the frame's. Which side is which is decided by the
/// triangles on the convex hull. Deterministic: the same bytes for any number of threads. Cost: O(n log n) time for
/// scanned surfaces and about 2 kB per vertex.
/// Source: the graph of Labatut, Pons, Keriven 2009, "Robust and efficient surface reconstruction from range data",
/// with a mesh in place of lines of sight; maximum flow by Boykov, Kolmogorov 2004.
ClosingSolid closing_solid(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t given,
                           const Vec3& origin, Context& context);

}  // namespace scanmill
