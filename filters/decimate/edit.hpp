// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A planned change of the mesh: the removal of a vertex, or the flip of an edge.

#include <vector>

#include "decimate/errors.hpp"
#include "scanmill/geometry/mesh/editable_mesh.hpp"

namespace scanmill::decimating {

struct Edit {
    /// The vertex to remove, or the half-edge to flip.
    u32 element = EditableMesh::none;
    bool is_flip = false;
    bool is_possible = false;
    /// The rows of the old triangles. For a flip: the row of the half-edge, then that of its opposite.
    std::vector<u32> old_rows;
    /// The new triangles, by their vertices and by the positions of these in the ring. A flip lists its triangles in
    /// the order of EditableMesh::flip().
    std::vector<Triangle> triangles;
    std::vector<EditableMesh::RingTriangle> ring_triangles;
    std::vector<SignedErrors> errors;  ///< by triangle
    /// Numbers of the points that the old triangles represent; for each of them, the index of the new triangle.
    std::vector<u32> points, owners;

    void clear(u32 new_element, bool flips) {
        element = new_element;
        is_flip = flips;
        is_possible = false;
        old_rows.clear();
        triangles.clear();
        ring_triangles.clear();
        errors.clear();
        points.clear();
        owners.clear();
    }
};

}  // namespace scanmill::decimating
