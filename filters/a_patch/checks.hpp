// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks of patches, computed from the tetrahedra alone.

#include "a_patch/weights.hpp"

namespace scanmill::a_patches {

/// Tetrahedra inside out.
std::size_t inverted_tets(const PatchComplex& patches);

/// Edges beside which the surface may have several sheets or a gap, ascending: those with a weight of the wrong sign,
/// and sharp edges where samples show that a line from the mesh to an apex, or to the segment between two apexes, does
/// not meet the surface once, or that the crease leaves the thirds beside the edge.
std::vector<u32> doubtful_edges(const PatchComplex& patches, Execution& execution);

/// Doubtful edges, and weights of the wrong sign over triangles.
std::size_t sign_violations(const PatchComplex& patches, Execution& execution);

/// The largest difference between the gradients on the two sides of a shared triangle, as a share of the larger one, at
/// three points each; not across sharp edges.
double c1_jump(const PatchComplex& patches, Execution& execution);

/// Triangles of the mesh whose parts of the surface meet others than along their borders, as far as a tessellation with
/// 4 segments per edge shows; ascending. Cost: about 0.2 ms per triangle.
std::vector<u32> crossing_triangles(const PatchComplex& patches, Execution& execution);

/// The largest distance of a crease from the sharp edge of the mesh that it follows, of 7 points per edge. `mesh`: see
/// APatchResult.
double largest_bulge(const PatchComplex& patches, const TriangleMesh& mesh, Execution& execution);

}  // namespace scanmill::a_patches
