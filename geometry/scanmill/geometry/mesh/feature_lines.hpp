// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The feature lines of a mesh: boundary loops, sharp edges, and the corners where such lines meet or turn.
///
/// An edge is *sharp* if the normals of its two triangles differ by more than `sharp_angle`, or if it is one of the
/// mesh's declared sharp edges. Where the vertices have so much noise that the normal of a triangle is not reliable, it
/// is replaced by that of a neighbourhood, see noisy_normals.hpp. A vertex of feature lines is a *corner* if the number
/// of sharp and boundary edges at it is not two, or if the line turns there by more than `corner_angle`. Angles that
/// exceed a limit by at most 1e-9 rad count as equal to it: a prism with 36 sides has no crease at 10 degrees, whatever
/// the rounding.
///
/// Sharp edges are chained into creases from corner to corner. Boundary edges are chained into whole loops, across
/// corners, with the surface on their left seen from outside. Every loop is an outer boundary or a hole, by
/// outer_loops() in boundary_loops.hpp.

#include <optional>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill {

struct FeatureParams {
    /// 0 to 180 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// 0 to 180 degrees.
    Angle corner_angle = Angle::degrees(35);
    /// Shorter creases are omitted; 0 or more, resolved.
    Length min_length;
    /// Standard deviation of the vertices' distances from the surface; 0 or more, resolved. Absent: vertex_noise().
    std::optional<Length> noise;
};

struct FeatureCounts {
    std::size_t creases = 0;
    std::size_t holes = 0;
    std::size_t boundaries = 0;  ///< outer ones
    std::size_t corners = 0;
    std::size_t ambiguous = 0;  ///< boundary loops whose projected area does not decide their type
    std::size_t dropped = 0;  ///< creases omitted because of their length
    std::size_t without_area = 0;  ///< triangles, see FacetNormals
    std::size_t unreliable = 0;  ///< triangles, see noisy_normals.hpp
};

struct FeatureLines {
    FeatureGraph graph;
    FeatureCounts counts;
    /// Per position of the graph its vertex in the mesh.
    Array<u32> mesh_vertices;
    /// Standard deviation, given or estimated.
    double noise = 0;
};

/// Pre: indices in range. Throws Error for a position of a triangle that is not finite, for an edge in three or more
/// triangles or with two half-edges of the same direction (naming the first), for a declared sharp edge that is in no
/// triangle, and for parameters out of range. Two fans may touch in a vertex: it is a corner, and a loop stays with its
/// fan.
///
/// Post: the graph contains only vertices of polylines, ordered by position (x, then y, then z). Polylines are outer
/// boundaries, then holes, then creases; each type by the first vertex, then the second. A closed polyline starts at
/// its lowest corner, without corners at its lowest vertex; a closed crease continues to the lower neighbour. An open
/// one starts at its lower end. The same bytes for any number of threads and any order of the input's vertices and
/// triangles, unless two vertices of feature lines have equal positions (then the mesh's order decides).
///
/// After short creases are omitted, the creases that met them are chained again: no crease of the result is shorter
/// than min_length. Cost: linear, and a sort of the lines' vertices; about 60 bytes per triangle. If the
/// noise is not given as 0, also that of noisy_normals.hpp. Throws Cancelled.
/// Source: Wang 2006, chapter 4, for loops, holes and sharp edges; area test and tie rules are our own.
FeatureLines find_features(const TriangleMesh& mesh, const FeatureParams& params, const Execution& execution);

/// One sentence for triangles without area, and one for boundary loops classified by their length.
std::vector<std::string> doubts(const FeatureCounts& counts);

}  // namespace scanmill
