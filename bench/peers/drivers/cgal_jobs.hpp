// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// CGAL's jobs. Each has its own source file, because CGAL's headers take long to compile.

#include "answer.hpp"

namespace peers {

/// Delaunay_triangulation_3; with "parallel", the parallel version in "threads" threads.
Json delaunay(const RawInput& input, const Json& request);
/// Regular_triangulation_3 of the weighted points.
Json regular(const RawInput& input, const Json& request);
/// Fixed_alpha_shape_3 at the radius "alpha".
Json fixed_alpha_shape(const RawInput& input, const Json& request);
/// Alpha_shape_3 and find_optimal_alpha(1).
Json optimal_alpha_shape(const RawInput& input, const Json& request);
/// advancing_front_surface_reconstruction, its tetrahedralisation included.
Json advancing_front(const RawInput& input, const Json& request);
/// Distances from all points to `mesh`, by an AABB_tree of its triangles.
Json distances(const RawInput& mesh, const RawInput& points, const Json& request);
/// remove_outliers, which removes the "percent" with the largest mean squared distances.
Json remove_outliers(const RawInput& input, const Json& request);
/// pca_estimate_normals, or with "jet" jet_estimate_normals; with "oriented" then mst_orient_normals.
Json normals(const RawInput& input, const Json& request);
/// jet_smooth_point_set.
Json smooth(const RawInput& input, const Json& request);
/// triangulate_refine_and_fair_hole for every boundary cycle. The time includes the conversion to a Surface_mesh.
Json fill_holes(const RawInput& input, const Json& request);
/// repair_polygon_soup and orient_polygon_soup.
Json repair(const RawInput& input, const Json& request);
/// edge_collapse with Garland and Heckbert's quadrics until "triangles" are left. Writes the mesh "into" raw arrays.
Json decimate(const RawInput& input, const Json& request);

}  // namespace peers
