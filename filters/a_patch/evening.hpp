// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes the triangles of a light mesh more even, so that a smooth surface over them does not wrinkle.

#include <span>

#include "a_patch/hull.hpp"
#include "scanmill/data/point_tree.hpp"

namespace scanmill::a_patches {

/// By vertex: whether it may move. A vertex at a sharp edge, at the boundary, or without a normal may not.
std::vector<bool> free_vertices(const PatchMesh& mesh);

/// Flips smooth edges whose two opposite angles have a sum above 180 degrees, the largest sums first (ties: by their
/// vertices), until there are none that may be flipped, at most in 12 passes. An edge stays in these cases:
/// - One of its ends would have fewer than four triangles, or the new edge exists already.
/// - A corner of its two triangles is fixed.
/// - The new triangles are folded: their normals differ by more than 60 degrees, or by more than 73 degrees from the
///   normals at their corners.
/// - A curve with the normals at its ends deviates more from the new edge than four times as much as from the old one,
///   and more than `most_sag`.
/// Returns the number of flips. Cost: O(n log n) per pass.
std::size_t flip_edges(PatchMesh& mesh, const std::vector<bool>& is_fixed, double most_sag);

/// Flips edges, then moves every free vertex half of the way to the middle of its triangles and back to the nearest
/// points; twice. The triangles' centroids are weighted by the square roots of the areas. A vertex stays if one of its
/// triangles would turn by more than 60 degrees, or to more than 73 degrees from the normal at one of its corners, or
/// if no point is within a mean edge of it. A moved vertex has the normal that the mesh had there. Returns the number
/// of flips. Pre: at least one point.
std::size_t make_even(PatchMesh& mesh, const std::vector<bool>& is_free, const std::vector<bool>& is_fixed,
                      const PointTree& points, double most_sag, Execution& execution);

}  // namespace scanmill::a_patches
