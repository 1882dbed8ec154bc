// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The loops along which an oriented mesh ends, and which of them go round it and which round a hole in it.
///
/// A loop passes its sides as their triangles do: the surface lies on the left, seen from outside. Sides are numbered
/// as in geometry/sides.hpp.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Every boundary side is in exactly one loop; where a mesh touches itself in a vertex a loop stays with its fan of
/// triangles. By the lowest side, which comes first.
///
/// Pre: `opposite` by half_edges::opposites. Cost: linear in the sides, and in the triangles round the boundary's
/// vertices.
std::vector<Array<u32>> boundary_loops(const TriangleMesh& mesh, std::span<const u32> opposite);

struct LoopShape {
    double length = 0;
    /// Inside the loop as projected along the mean normal of its facets; positive when passed counter-clockwise.
    double area = 0;
    /// False when the area does not tell an outer boundary from a hole: where the mean of the facets' unit normals,
    /// weighted by the sides' lengths, is shorter than a tenth (the rim of a cylinder), or the area less than a
    /// thousandth of the squared length.
    bool clear = false;
};

/// Pre: a closed sequence of sides; `normals` as by facet_normals. The result's last bits depend on which side is
/// first.
LoopShape loop_shape(const TriangleMesh& mesh, std::span<const u32> loop, std::span<const Vec3> normals);

/// Whether each loop is an outer boundary of its piece of the mesh, or else a hole: by the sign of its area where that
/// is clear; where not, the longest of all loops of a piece is outer, of equally long ones (to a billionth) the first,
/// and the others are holes.
///
/// Pre: the shapes of all loops of the mesh. Cost: linear in the triangles when a shape is not clear, else in the
/// loops.
std::vector<bool> outer_loops(std::span<const std::span<const u32>> loops, std::span<const LoopShape> shapes,
                              std::span<const u32> opposite);

}  // namespace scanmill
