// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The noise of a mesh's vertices, and normals that are reliable in spite of it.
///
/// Noise of standard deviation σ turns the normal of a triangle by about σ / √λ, where λ is the second largest
/// eigenvalue of the scatter matrix of its corners: their sum of squares about the centroid, across the triangle's
/// longest direction. So an angle between triangles that are small beside the noise gives no information about the
/// surface. The same holds for the plane that fits a larger *neighbourhood* best, with the λ of its vertices, so the
/// error falls as the neighbourhood grows; but if the surface curves within it, the plane is wrong, and a crease would
/// become round. Curving is visible, as the vertices are then farther from the plane than the noise explains.

#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The standard deviation of the vertices' distances from a smooth or flat surface; 0 for a mesh without noise.
///
/// Every half-edge gives an error: how far its triangle and the opposite one are from a plane, or how far the vertex
/// where it starts is from the quadric that fits the vertices within two edges best, whichever is smaller. Flat parts
/// beside creases make the first vanish, curved parts the second. Noise makes as many convex edges as concave ones. So
/// the result is the smaller of two medians, of the convex half of the errors and of the concave half: 0 for a convex
/// object, however coarse it is.
///
/// Noise is the same at all scales; the details of an object grow with the neighbourhood. The result is therefore 0 if
/// details make most of the squared distances from quadrics of three edges: if their lower quartile is more than √2
/// times that of two edges. With noise it is 1.0 to 1.15 times as large on surfaces that the mesh resolves; on the
/// models of CGAL's data with more than 500 vertices it is 1.43 times and more, where errors exceed the rounding. A
/// mesh with few triangles between its creases also counts as one without noise, as does one with less than a billionth
/// of the diagonal: rounding.
///
/// Vertices near a boundary, and where rings of neighbours do not widen, are not used. In meshes with more than 10,000
/// vertices, 5,000 to 10,000 are used, chosen by position.
///
/// Pre: finite positions; `opposite` by half_edges::opposites(). The same bits for any order of vertices and triangles
/// and any number of threads. Throws Cancelled. Cost: linear; beside that of the neighbours about 10 µs for each vertex
/// used.
double vertex_noise(const TriangleMesh& mesh, std::span<const u32> opposite, const Execution& execution);

struct NoisyNormals {
    /// Unit length, one per triangle.
    Array<Vec3> unit;
    /// Triangles whose own normal is not reliable.
    std::size_t unreliable = 0;
    /// Median diameter of the vertices' largest neighbourhoods, 0 without unreliable triangles: shorter lines on the
    /// mesh have no reliable direction.
    double reach = 0;
};

/// For every triangle a normal with which its angles to its neighbours can be compared with `angle`, in radians. `own`:
/// by facet_normals(). `noise`: the standard deviation σ of the vertices.
///
/// A normal is *reliable* if noise on a plane makes no angle above `angle`: z √2 σ / √λ <= angle, with
/// z = √(2 ln #edges), which none of #edges normally distributed numbers exceeds. Reliable normals stay as they are.
/// Others become the normal of a neighbourhood that contains the triangle, or stay, whichever has the least mean square
/// error: σ² / λ by noise, plus (λ₃ - (n - 3) σ²) / λ, but at least 0, by curving, for the n vertices of the
/// neighbourhood and their least eigenvalue λ₃. At a crease that is a neighbourhood on one side of it, so creases stay
/// sharp, and triangles that bridge a crease join one of its sides. Ties: the lower normal by x, y, z.
///
/// The neighbourhoods of a vertex contain 4 and more of the nearest vertices that are connected with it, one more each
/// time, up to the first for which the normal would be reliable and a crease of `angle` through its middle visible, but
/// at most 256.
///
/// Pre: finite positions, noise >= 0, angle >= 0. Without noise the result is `own`. The same bits for any number of
/// threads and any order of the triangles and vertices, unless vertices have equal positions. Throws Cancelled. Cost:
/// linear; for a noise of a tenth of the edges' length about 20 µs and 200 bytes per vertex.
NoisyNormals noisy_normals(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> own,
                           double noise, double angle, const Execution& execution);

}  // namespace scanmill
