// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The boundary loops of an oriented mesh: outer boundaries and holes.
///
/// A loop is a closed sequence of half-edges (see half_edges.hpp). Seen from outside, the surface is on their left.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Every boundary half-edge is in exactly one loop. Where several fans of triangles meet in a vertex, a loop stays with
/// its fan. Every loop starts with its lowest half-edge; loops are sorted by their first half-edge.
///
/// Pre: `opposite` is half_edges::opposites(mesh). Cost: linear in the half-edges and in the triangles around boundary
/// vertices.
std::vector<Array<u32>> boundary_loops(const TriangleMesh& mesh, std::span<const u32> opposite);

struct LoopShape {
    double length = 0;
    /// Area of the loop projected along the mean normal of its facets; positive if counter-clockwise.
    double area = 0;
    /// False if the area does not decide between outer boundary and hole. One reason is a mean normal shorter than a
    /// tenth, as for a loop around a cylinder: the mean of the facets' unit normals, weighted by the lengths of the
    /// half-edges. The other reason is an area below a thousandth of the squared length.
    bool clear = false;
};

/// Pre: `normals` are the result of facet_normals(). The last bits of the result depend on which half-edge is first.
LoopShape loop_shape(const TriangleMesh& mesh, std::span<const u32> loop, std::span<const Vec3> normals);

/// Whether each loop is an outer boundary of its connected component; all other loops are holes. The sign of a clear
/// area decides. A loop without a clear area is outer if it is the longest loop of its component. Among equally long
/// loops (relative tolerance 1e-9) the first counts as the longest.
///
/// Pre: `loops` are all loops of the mesh; `shapes` are their shapes. Cost: linear in the loops; linear in the
/// triangles if a shape is not clear.
std::vector<bool> outer_loops(std::span<const std::span<const u32>> loops, std::span<const LoopShape> shapes,
                              std::span<const u32> opposite);

}  // namespace scanmill
