// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks of patches, computed from the tetrahedra alone.

#include "a_patch/weights.hpp"

namespace scanmill::a_patches {

/// Number of tetrahedra that are inside out.
std::size_t inverted_tets(const PatchComplex& patches);

/// Edges beside which the surface may have several sheets or a gap; ascending. Such an edge has a weight of the wrong
/// sign, or it is sharp and samples show one of two defects:
/// - A line from the mesh to an apex, or to the segment between two apexes, does not meet the surface exactly once.
/// - The crease leaves the thirds of the triangles beside the edge.
std::vector<u32> doubtful_edges(const PatchComplex& patches, Execution& execution);

/// Number of doubtful edges, plus the number of weights over triangles with a wrong sign.
std::size_t sign_violations(const PatchComplex& patches, Execution& execution);

/// The largest difference between the gradients on the two sides of a triangle that tetrahedra share, relative to the
/// longer gradient. It is measured at three points per triangle, not across sharp edges.
double c1_jump(const PatchComplex& patches, Execution& execution);

/// Triangles of the mesh whose parts of the surface intersect other parts, in a tessellation with 4 segments per edge;
/// ascending. Cost: about 0.2 ms per triangle.
std::vector<u32> crossing_triangles(const PatchComplex& patches, Execution& execution);

/// The largest distance between a crease and the mesh's sharp edge that it follows, at 7 points per edge. `mesh`: see
/// APatchResult.
double largest_bulge(const PatchComplex& patches, const TriangleMesh& mesh, Execution& execution);

}  // namespace scanmill::a_patches
