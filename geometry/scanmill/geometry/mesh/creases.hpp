// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The creases of a mesh: those sharp edges that form lines. All filters that need creases use these functions.
///
/// An edge is *sharp* if the normals of its two triangles differ by more than a sharp angle, or if it is one of the
/// mesh's declared sharp edges. On a mesh without noise, the sharp edges are the creases. Noise turns triangles, so
/// edges in the middle of a face become sharp, and edges on a crease become less sharp. Therefore triangles that are
/// small beside the noise take the normals of neighbourhoods, see noisy_normals.hpp. A scan that was smoothed and
/// thinned has an error of the same kind: triangles bridge its creases, so the turn is divided among two or three
/// edges; see sampling_error(). Two errors remain, which concern lines: short gaps, and sharp edges that form no line.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Largest number of edges of a gap in a line that find_creases() closes.
inline constexpr std::size_t most_gap_edges = 3;

struct CreaseParams {
    double sharp_angle = 0;  ///< radians; angles that exceed it by at most `angle_tie` count as equal to it
    /// Standard deviation of the vertices' distances from the surface. If absent, it is vertex_noise(), or without
    /// noise sampling_error().
    std::optional<double> noise;
    /// Lines and branches with a free end that are shorter than this are not creases, and neither are the borders of
    /// faces that are as small. 0: lengths and areas do not matter.
    double least_size = 0;
    /// Whether the declared sharp edges, which must be sorted, are exact, such as measured lines. Then lines that meet
    /// no others than these count as isolated: noise makes them beside an exact line as anywhere else.
    bool exact_declared = false;
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

/// Finds the creases in five steps. Steps 2 to 4 apply only if triangles took normals of neighbourhoods, and step 5
/// only with a least size. So the creases of a mesh without error are its sharp edges.
///
/// 1. *Seeds* are declared sharp edges, and edges where the normals differ by more than the sharp angle.
/// 2. From a free end of a line, edges above half the sharp angle continue it: at each vertex the edge with the largest
///    angle among those that lead forward. The line ends where it meets another one.
/// 3. Free ends that are at most most_gap_edges apart are joined along edges if the path continues both lines. The
///    directions may differ by 60 degrees.
/// 4. Isolated lines that are shorter than the reach of the normals are removed. An isolated line meets neither other
///    lines nor the boundary. With `exact_declared`, lines end where they meet a declared edge, and may meet those.
/// 5. Details below the least size are removed: lines and branches with a free end that are shorter, the shortest
///    first, and faces enclosed by creases with less than the square of it as area. A small face joins the face with
///    the longest common border.
///
/// The sampling error concerns only triangles near a part of a crease whose turn is divided, that is, at most two
/// triangles away from an edge above a quarter of the sharp angle that is not sharp. With noise, all triangles that are
/// too small for it count.
///
/// Pre: finite positions; `opposite` is half_edges::opposites(mesh). Throws Error for a declared sharp edge that is in
/// no triangle, and Cancelled.
/// Ties: the lower position. The result depends neither on the number of threads nor on the order of the vertices and
/// triangles, unless vertices have equal positions.
/// Cost: linear. With noise, the cost of noisy_normals() dominates.
Creases find_creases(const TriangleMesh& mesh, std::span<const u32> opposite, const CreaseParams& params,
                     const Execution& execution);

/// The error of a surface near its creases because it is sampled: a twelfth of the median of the vertex column
/// `bin-size`, which voxel-thin writes, and 0 without that column. The surface is about 0.16 h from a chord of length h
/// that bridges a right-angled crease.
///
/// A larger share finds more of the creases, and takes more of an organic surface's folds for creases. On smoothed and
/// thinned scans of fandisk and anchor, a twelfth finds 95 and 96 % of the length of the models' creases, an eighth 98
/// %, a sixteenth 91 and 95 %. On a scan of the bunny, which has no creases, an eighth finds three times as much as a
/// twelfth.
double sampling_error(const TriangleMesh& mesh);

}  // namespace scanmill
