// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The creases of a mesh: those sharp edges that form lines. All filters that need creases use these functions.
///
/// An edge is *sharp* if the normals of its two triangles differ by more than a sharp angle, or if it is one of the
/// mesh's declared sharp edges. On a mesh without error, the sharp edges are the creases. Vertices with errors make two
/// mistakes. Noise turns triangles, so edges in the middle of a face are sharp. And the samples of a surface miss its
/// creases: triangles between samples bridge them, and smoothing the samples makes them round. The turn is then divided
/// among two or three edges side by side, each with less than the sharp angle.
///
/// Both are errors of the vertices' positions, so one method handles both: normals of neighbourhoods for the triangles
/// that are small beside the error, see noisy_normals.hpp. The best neighbourhood of a bridging triangle is on one side
/// of the crease, so the whole turn is at one edge again. What the normals leave to do concerns lines: short gaps, and
/// sharp edges without a line.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct CreaseParams {
    double sharp_angle = 0;  ///< radians; angles that exceed it by at most `angle_tie` count as equal to it
    /// Standard deviation of the vertices' distances from the surface. If absent, it is the larger one of
    /// vertex_noise() and sampling_error().
    std::optional<double> noise;
    /// Lines with a free end that are shorter than this, and faces that are as small, are not features. It is
    /// increased to the size below which the noise hides details.
    double least_size = 0;
};

struct Creases {
    /// By half-edge: whether its edge is on a crease. Equal for opposite half-edges, false on the boundary.
    std::vector<bool> sharp;
    /// Unit normals by which the creases were found. Those of unreliable triangles are of neighbourhoods.
    Array<Vec3> normals;
    Array<Vec3> own_normals;  ///< facet_normals()
    /// Standard deviation of the vertices' distances from the surface, given or by vertex_noise().
    double noise = 0;
    /// Length over which lines have a reliable direction, see NoisyNormals; 0 if all normals are the triangles' own.
    double reach = 0;
    std::size_t unreliable = 0;  ///< triangles that take the normal of a neighbourhood
    std::size_t without_area = 0;  ///< see FacetNormals
};

/// Finds the creases in four steps. If all normals are the triangles' own, only the first and the last one apply.
///
/// 1. *Seeds* are declared sharp edges, and edges where the normals differ by more than the sharp angle.
/// 2. From a free end of a line, edges above half the sharp angle continue it: at each vertex the edge with the largest
///    angle among those that lead forward. The line ends where it meets another one.
/// 3. Free ends that are at most three edges apart are joined along edges if the path continues both lines. The
///    directions may differ by 60 degrees.
/// 4. Details smaller than half the reach of the normals, or than `least_size`, are removed: isolated lines and
/// branches
///    with a free end that are shorter, and faces enclosed by creases that have less than the square of that area. A
///    small face joins the face with the longest common border.
///
/// Pre: finite positions; `opposite` is half_edges::opposites(mesh). Throws Error for a declared sharp edge that is in
/// no triangle, and Cancelled.
/// Ties: the lower position. The result depends neither on the number of threads nor on the order of the vertices and
/// triangles, unless vertices have equal positions.
/// Cost: linear. With noise, the cost of noisy_normals() dominates.
Creases find_creases(const TriangleMesh& mesh, std::span<const u32> opposite, const CreaseParams& params,
                     const Execution& execution);

/// The error of a surface near its creases because it is sampled: a quarter of the median of the vertex column
/// `bin-size`, which voxel-thin writes, and 0 without that column. A chord of length h over a right-angled crease is
/// 0.32 h from it on average.
///
/// On scans of fandisk and anchor with a noise of 0.2 voxels that were smoothed and thinned, a quarter finds 98 % of
/// the length of the model's creases; an eighth finds 58 to 91 %, and a half 84 % with 27 % of false ones.
double sampling_error(const TriangleMesh& mesh);

/// By half-edge: whether its edge is a declared sharp edge and on a line of such edges. Isolated lines and branches
/// with a free end that are shorter than `least_length` are not creases. Boundary vertices are not free ends. Without
/// `least_length`, it is three times the median length of the mesh's edges.
///
/// Pre: as find_creases(). Throws Error for a declared sharp edge that is in no triangle. Cost: linear.
std::vector<bool> declared_creases(const TriangleMesh& mesh, std::span<const u32> opposite,
                                   std::optional<double> least_length = std::nullopt);

}  // namespace scanmill
