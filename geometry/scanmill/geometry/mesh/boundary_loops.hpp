// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The boundary loops of an oriented mesh: outer boundaries and holes.
///
/// A loop is a closed sequence of half-edges (see half_edges.hpp), with the surface on their left seen from outside.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Every boundary half-edge is in exactly one loop; where a mesh touches itself in a vertex, a loop stays with its fan
/// of triangles. Every loop starts with its lowest half-edge; loops ascend by it.
///
/// Pre: `opposite` by half_edges::opposites(). Cost: linear in the half-edges and in the triangles around boundary
/// vertices.
std::vector<Array<u32>> boundary_loops(const TriangleMesh& mesh, std::span<const u32> opposite);

struct LoopShape {
    double length = 0;
    /// Area of the loop projected along the mean normal of its facets; positive if counter-clockwise.
    double area = 0;
    /// False if the area does not decide between outer boundary and hole: the mean of the facets' unit normals,
    /// weighted by the lengths of the half-edges, is shorter than a tenth (a loop around a cylinder), or the area is
    /// below a thousandth of the squared length.
    bool clear = false;
};

/// Pre: `normals` by facet_normals(). The last bits of the result depend on which half-edge is first.
LoopShape loop_shape(const TriangleMesh& mesh, std::span<const u32> loop, std::span<const Vec3> normals);

/// Whether each loop is an outer boundary of its connected component; the others are holes. The sign of a clear area
/// decides. A loop without a clear area is outer if it is the longest of its component's loops; among equally long ones
/// (to a billionth) the first.
///
/// Pre: the shapes of all loops of the mesh. Cost: linear in the triangles if a shape is not clear, else in the loops.
std::vector<bool> outer_loops(std::span<const std::span<const u32>> loops, std::span<const LoopShape> shapes,
                              std::span<const u32> opposite);

}  // namespace scanmill
