// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closes an open mesh as a whole, as the boundary of a solid, if its holes cannot be closed one by one.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// The triangle rotated so that its lowest vertex comes first.
Triangle smallest_first(Triangle triangle);

struct ClosingSolid {
    /// Empty if no solid was found.
    std::vector<Triangle> triangles;
    /// For each copy of a vertex, the vertex at the same position. Copies are numbered from #positions on.
    std::vector<u32> copies;
};

/// A closed surface on the mesh's vertices that contains nearly all of its triangles.
///
/// The vertices are tetrahedralised (Delaunay). A triangle of the mesh claims the cell behind it for the inside, and
/// the cell in front of it for the outside. A cell that is claimed for both sides belongs to the side with more area.
/// The space beyond the hull is outside. The other cells are divided so that the boundary has the least area (minimum
/// cut). Triangles from row `given` on are suggestions: they claim nothing, and a tenth of their area counts in the
/// cut.
///
/// Three repairs follow. A face-connected part of either side is left out if no component of the mesh has most of its
/// triangles there. At a vertex where the boundary is not one closed fan, parts of the vertex's cells change sides
/// while this removes surplus parts. If several fans are left at a vertex, each further fan gets its own copy of the
/// vertex at the same position. If a fan passes an edge twice, the cells around this edge are labelled inside, and the
/// repairs start again.
///
/// Returns the boundary, in the orientation of the mesh. Of vertices at one position, the boundary uses the first. It
/// is a closed manifold. It does not intersect itself, because its triangles are facets of one tetrahedralisation.
/// Triangles of the mesh that are not such facets are missing. The result is empty if the vertices are within rounding
/// of a plane, or if the repairs do not end.
///
/// Pre: at least one triangle; finite vertices; `origin` is the frame's. The triangles on the convex hull decide which
/// side is inside. Deterministic: the same bytes for any number of threads. Cost: O(n log n) time for scanned surfaces,
/// and about 2 kB per vertex.
/// Source: the graph of Labatut, Pons, Keriven 2009, "Robust and efficient surface reconstruction from range data",
/// with a mesh in place of lines of sight; maximum flow by Boykov, Kolmogorov 2004.
ClosingSolid closing_solid(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t given,
                           const Vec3& origin, Context& context);

}  // namespace scanmill
