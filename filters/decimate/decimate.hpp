// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decimation within a distance: removes vertices while no point of the input mesh is farther than `max_error` from the
/// result, and no point of the result farther from the input.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/distance/certified_hausdorff.hpp"

namespace scanmill {

enum class DecimateMode {
    direct,  ///< errors are measured to the input surface, and to the data points if there are any
    accumulated  ///< the paper: two bounds per triangle, which grow with every removal
};

struct DecimateParams {
    /// Largest distance between input and result; 0 or more. Below 1e-10 of the mesh's diagonal it counts as that.
    Length max_error = Length::percent_of_diagonal(0.1);
    /// Replace max_error: `outside` where the input is outside the result, `inside` where it is inside. The certificate
    /// proves the larger one. The smaller one limits the removal, judged by the side of a point at its own triangle; on
    /// rough surfaces another triangle may be nearer and have the point on its other side.
    std::optional<Length> outside, inside;
    DecimateMode mode = DecimateMode::direct;
    /// Edges whose triangles' normals differ by more are sharp. 20 to 75 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// A feature line that turns by more has a corner there. 0 to 180 degrees.
    Angle corner_angle = Angle::degrees(35);
    /// Largest angle between the normal of a new triangle and the mean normal of those it replaces. 0 to 89 degrees.
    Angle normal_deviation = Angle::degrees(60);
    /// No new triangle has a smaller angle, unless one of those it replaces has; where the surface is flat to 0.1
    /// degrees, 5 degrees suffice. 0 to 30 degrees.
    Angle min_angle = Angle::degrees(15);
    /// Vertices with more edges are not removed, and none gets more. 6 to 64.
    u32 max_valence = 25;
    /// Removal stops once at most this many triangles are left; 0: only the errors stop it.
    u64 target_triangles = 0;
    /// Whether edges are flipped in the end, within the same limits, to raise the triangles' least angles.
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
    /// Bounds of the distance between the input and the result, computed independently of the errors that steered.
    CertifiedHausdorff certificate;
    std::size_t removed = 0, flips = 0;
    /// Lines of sharp edges, from corner to corner or closed; vertices of class corner.
    std::size_t creases = 0, corners = 0;
    /// For the data points: the largest distance to the result, how many are farther from it than max_error, and how
    /// many were that far from the input. Absent without points.
    std::optional<double> points_max;
    std::size_t points_beyond = 0, points_left_out = 0;
};

/// Removes vertices, the flattest surroundings first, and triangulates the holes, until no more is possible.
///
/// Pre:  a 2-manifold, closed or open, of any number of components, consistently oriented, finite; see EditableMesh for
///       what is refused. Throws Error with numbers and a hint otherwise. Triangles without area stay. `points`, if not
///       null, are data points beside the vertices, in the mesh's frame.
/// Post: vertices of the result are vertices of the input, bit for bit. Same topology: boundary loops, components,
///       genus. No point of either surface is farther from the other than max_error (the larger one of outside and
///       inside), proven by `certificate`; otherwise Error. In mode direct also no data point, except those that were
///       farther from the input. No removal is left that keeps the limits.
///       Lines of sharp edges and boundaries stay lines between vertices of theirs, with no part of the input's lines
///       farther than max_error; corners stay. Roughness is no feature: see feature_network.hpp.
///       The new triangles intersect only what the triangles they replace intersected.
/// Ties: among equal estimates the lower vertex number; among equally good triangulations the first.
/// Bytes do not depend on the number of threads.
/// Cost: O(n log n) time; about 40 µs per removed vertex with one thread. About 340 bytes per triangle, the input's own
/// included.
/// Metrics and warnings: see plugin.cpp.
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 4, for removal, classes and accumulated errors. The direct
/// errors and the certificate are our own.
DecimateResult decimate(const TriangleMesh& mesh, const PointCloud* points, const DecimateParams& params,
                        Context& context);

}  // namespace scanmill
