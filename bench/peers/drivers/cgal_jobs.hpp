// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// CGAL's jobs, one source file each: its headers take long to compile.

#include "answer.hpp"

namespace peers {

/// Delaunay_triangulation_3; with "parallel", that of Parallel_tag in "threads" threads.
Json delaunay(const RawInput& input, const Json& request);
/// Regular_triangulation_3 of the points with their weights.
Json regular(const RawInput& input, const Json& request);
/// Fixed_alpha_shape_3 at the radius "alpha".
Json fixed_alpha_shape(const RawInput& input, const Json& request);
/// Alpha_shape_3 and find_optimal_alpha(1).
Json optimal_alpha_shape(const RawInput& input, const Json& request);
/// advancing_front_surface_reconstruction, its tetrahedralisation included.
Json advancing_front(const RawInput& input, const Json& request);
/// AABB_tree of the triangles of `mesh`, asked for every point's distance.
Json distances(const RawInput& mesh, const RawInput& points, const Json& request);

}  // namespace peers
