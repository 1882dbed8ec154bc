// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The noise of a mesh's vertices, and normals that are reliable in spite of it.
///
/// Noise of standard deviation σ turns the normal of a triangle by about σ / √λ. Here λ is the second largest
/// eigenvalue of the scatter matrix of the corners. It is their sum of squares about the centroid, across the
/// triangle's longest direction. So the angle between triangles that are small beside the noise gives no information
/// about the surface.
///
/// The same formula holds for the plane that fits a larger *neighbourhood* best, with the λ of its vertices. So the
/// error falls as the neighbourhood grows. But if the surface curves within the neighbourhood, the plane is wrong, and
/// a crease would become round. Curving is visible: the vertices are then farther from the plane than the noise
/// explains.

#include <span>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The standard deviation of the vertices' distances from a smooth or flat surface; 0 for a mesh without noise.
///
/// Every half-edge between two triangles gives an error, the smaller of two distances. One is the distance of the two
/// triangles from a common plane. The other is the distance of the start vertex from the quadric that fits the vertices
/// within two edges best. Flat parts beside creases make the first distance vanish, curved parts the second. Noise
/// makes as many convex edges as concave ones. So the result is the smaller of two medians: the median of the convex
/// half of the errors, and the median of the concave half. It is 0 for a convex object, however coarse the mesh is.
///
/// Noise is the same at all scales; the details of an object grow with the neighbourhood. If details cause most of the
/// squared distances from quadrics of three edges, the result is 0. The test compares the lower quartiles of the
/// distances for three and for two edges: their ratio is above √2. On surfaces that the mesh resolves, noise gives a
/// ratio of 1.0 to 1.15. On the models of CGAL's data with more than 500 vertices, the ratio is at least 1.43 where
/// errors exceed the rounding. The result is also 0 for a mesh with few triangles between its creases, and for noise
/// below a billionth of the diagonal, which is rounding.
///
/// Vertices near a boundary, and vertices where a ring of neighbours is not larger than the ring inside it, are not
/// used. In meshes with more than 10,000 vertices, a hash of the position selects 5,000 to 10,000 of them.
///
/// Pre: finite positions; `opposite` is half_edges::opposites(mesh). The same bits for any order of vertices and
/// triangles and any number of threads. Throws Cancelled. Cost: linear; besides the lists of neighbours, about 10 µs
/// for each vertex used.
double vertex_noise(const TriangleMesh& mesh, std::span<const u32> opposite, const Execution& execution);

struct NoisyNormals {
    /// Unit length, one per triangle.
    Array<Vec3> unit;
    /// Triangles whose own normal is not reliable.
    std::size_t unreliable = 0;
    /// Median diameter of the vertices' largest neighbourhoods; 0 without unreliable triangles. Lines on the mesh that
    /// are shorter than this have no reliable direction.
    double reach = 0;
};

/// Returns a normal for every triangle such that the angles between neighbours can be compared with `angle`, in
/// radians. `own` are the normals of facet_normals(). `noise` is the standard deviation σ of the vertices.
///
/// A normal is *reliable* if noise on a plane makes no angle above `angle`: z √2 σ / √λ <= angle, with z = √(2 ln
/// #edges). Among #edges normally distributed numbers, none is expected to exceed z. Reliable normals stay as they are.
/// An unreliable normal is compared with the normals of all neighbourhoods that contain its triangle; the one with the
/// least mean square error is used. The error has two terms, for the n vertices of a neighbourhood and their least
/// eigenvalue λ₃. Noise contributes σ² / λ. Curving contributes max(0, λ₃ - (n - 3) σ²) / λ. At a crease, the best
/// neighbourhood is on one side of the crease. So creases stay sharp, and triangles that bridge a crease join one of
/// its sides. Ties: the lower normal by x, y, z.
///
/// The neighbourhoods of a vertex are nested: the nearest 4, 5, 6 … of the vertices that are connected with it, at most
/// 256. The largest is the first for which the normal would be reliable and a crease of `angle` through its middle
/// would be visible.
///
/// `candidates`: by triangle, whether its normal may be unreliable; empty if all may.
///
/// Pre: finite positions, noise >= 0, angle >= 0. With noise = 0 the result is `own`. The same bits for any number of
/// threads. The bits do not depend on the order of the triangles and vertices either, unless vertices have equal
/// positions. Throws Cancelled. Cost: linear; for a noise of a tenth of the edges' length about 20 µs and 200 bytes per
/// vertex.
NoisyNormals noisy_normals(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> own,
                           double noise, double angle, const Execution& execution,
                           const std::vector<bool>& candidates = {});

}  // namespace scanmill
