// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decimation within a distance: removes vertices while the input mesh and the result stay within `max_error` of each
/// other, in both directions.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/distance/certified_hausdorff.hpp"

namespace scanmill {

enum class DecimateMode {
    direct,  ///< measures errors to the input surface, and to the data points if there are any
    accumulated  ///< as in the paper: keeps two error bounds per triangle, which grow with every removal
};

struct DecimateParams {
    /// Largest distance between input and result; 0 or more. The certificate cannot prove less than 1e-10 of the mesh's
    /// diagonal.
    Length max_error = Length::percent_of_diagonal(0.1);
    /// Replace max_error where the input is outside or inside the result, respectively. The certificate proves the
    /// larger of the two limits. The smaller limit applies to removals only. A removal takes the side of a point from
    /// the triangle that represents the point. On rough surfaces another triangle may be nearer, and the point may be
    /// on the other side of that triangle.
    std::optional<Length> outside, inside;
    DecimateMode mode = DecimateMode::direct;
    /// An edge is sharp if the normals of its triangles differ by more than this angle. 20 to 75 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// A vertex where a feature line turns by more than this angle is a corner. 0 to 180 degrees.
    Angle corner_angle = Angle::degrees(35);
    /// Standard deviation of the vertices' distances from the surface; 0 or more. If absent, it is estimated, see
    /// CreaseParams.
    std::optional<Length> noise;
    /// Largest angle between the normal of a new triangle and the mean normal of those it replaces. 0 to 89 degrees.
    Angle normal_deviation = Angle::degrees(60);
    /// Least angle of a new triangle. If a replaced triangle has a smaller angle, that smaller angle is the limit.
    /// Where the surface is flat to 0.1 degrees, 5 degrees suffice. 0 to 30 degrees.
    Angle min_angle = Angle::degrees(15);
    /// A vertex with more edges than this is not removed, and no vertex gets more. 6 to 64.
    u32 max_valence = 25;
    /// Removal stops once at most this many triangles are left; 0: only the other limits stop it.
    u64 target_triangles = 0;
    /// Whether edges are flipped, within the same limits, to raise the least angles of the triangles.
    bool final_flips = true;
};

/// The column `class` of vertices. If several classes apply, the first of corner, boundary, crease counts.
enum class VertexClass : u8 {
    smooth,  ///< without feature edges
    crease,  ///< between two sharp edges of one line
    corner,  ///< an end, a fork or a turn of feature lines, or the apex of a cone
    boundary  ///< between two boundary edges of one line
};

struct DecimateResult {
    /// Vertices and triangles in input order. Vertex columns of the input and `class`; face columns `corner-normals`,
    /// `error-outside`, `error-inside`; the sharp edges.
    TriangleMesh mesh;
    /// Bounds of the distance between the input and the result, computed independently of the errors that limited the
    /// removals.
    CertifiedHausdorff certificate;
    std::size_t removed = 0, flips = 0;
    /// `creases`: number of lines of sharp edges, from corner to corner or closed. `corners`: number of vertices of
    /// class corner.
    std::size_t creases = 0, corners = 0;
    /// Largest distance of a data point to the result; absent without data points.
    std::optional<double> points_max;
    /// Numbers of data points farther than max_error from the result (`points_beyond`) and from the input
    /// (`points_left_out`).
    std::size_t points_beyond = 0, points_left_out = 0;
};

/// Removes the vertices with the flattest surroundings first, and triangulates the holes, until no removal is possible.
///
/// Pre:  a 2-manifold, closed or open, of any number of components, consistently oriented, finite. Triangles without
///       area are allowed. EditableMesh lists what is refused. Throws Error with numbers and a hint otherwise.
///       `points`, if not null, are data points beside the vertices, in the mesh's frame.
/// Post: vertices of the result are vertices of the input, bit for bit. Boundary loops, components and genus stay the
///       same. Each surface is within max_error of the other (the larger one of outside and inside). `certificate`
///       proves this; if it cannot, an Error is thrown. In mode direct, data points are within max_error too, except
///       those that were farther from the input. Every further removal would violate a limit.
///       A line of sharp or boundary edges becomes a line between some of its vertices, and the old line is within
///       max_error of the new one. Corners stay. Roughness does not count as a feature: see creases.hpp. The new
///       triangles intersect only triangles that the replaced ones intersected.
/// Ties: among equal estimates, the vertex with the lower number is removed first. Among equally good triangulations,
/// the first is taken.
/// Bytes do not depend on the number of threads.
/// Cost: O(n log n) time; about 40 µs per removed vertex with one thread. About 340 bytes per triangle, including the
/// input.
/// Metrics and warnings: see plugin.cpp.
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 4, for removal, classes and accumulated errors. The direct
/// errors and the certificate are our own.
DecimateResult decimate(const TriangleMesh& mesh, const PointCloud* points, const DecimateParams& params,
                        Context& context);

}  // namespace scanmill
