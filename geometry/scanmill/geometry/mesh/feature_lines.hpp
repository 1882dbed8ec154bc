// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The feature lines of a mesh: boundary loops, sharp edges, and the corners where such lines meet or turn.
///
/// An edge is *sharp* if the normals of its two triangles differ by more than `sharp_angle`, or if it is one of the
/// mesh's declared sharp edges. Noise of the vertices can make the normal of a triangle unreliable. Such a normal is
/// replaced by the normal of a neighbourhood, and lines are followed and gaps in them closed, see creases.hpp. Where a
/// closed gap has no turn, the normals are those of the nearest edge of the line with a turn. The sampling error of
/// creases.hpp is not used, because lines that are found with it can run beside the sharpest edges of the mesh.
///
/// A vertex of feature lines is a *corner* if the number of sharp and boundary edges at it is not two, or if the line
/// turns there by more than `corner_angle`. Angles that exceed a limit by at most 1e-9 rad count as equal to it. So a
/// prism with 36 sides has no crease at 10 degrees, whatever the rounding.
///
/// Sharp edges are chained into creases from corner to corner. Boundary edges are chained into whole loops, across
/// corners. Seen from outside, the surface is on their left. outer_loops() in boundary_loops.hpp decides whether a loop
/// is an outer boundary or a hole.

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
    /// Creases shorter than this are omitted. 0 or more, resolved.
    Length min_length;
    /// Standard deviation of the vertices' distances from the surface; 0 or more, resolved. If absent, vertex_noise()
    /// estimates it.
    std::optional<Length> noise;
    /// Whether the declared sharp edges are exact, see CreaseParams.
    bool exact_declared = false;
};

struct FeatureCounts {
    std::size_t creases = 0;
    std::size_t holes = 0;
    std::size_t boundaries = 0;  ///< outer boundaries
    std::size_t corners = 0;
    std::size_t ambiguous = 0;  ///< boundary loops whose projected area does not decide their type
    std::size_t dropped = 0;  ///< creases omitted because of their length
    std::size_t without_area = 0;  ///< triangles without area, see FacetNormals
    std::size_t unreliable = 0;  ///< triangles with an unreliable normal, see noisy_normals.hpp
};

struct FeatureLines {
    FeatureGraph graph;
    FeatureCounts counts;
    /// For each position of the graph, its vertex in the mesh.
    Array<u32> mesh_vertices;
    /// Standard deviation of the vertices' distances from the surface, given or estimated.
    double noise = 0;
};

/// Finds boundary loops, creases and corners; the file comment defines them. Where two fans of triangles touch in a
/// vertex, the vertex is a corner, and a loop stays with its fan. After short creases are omitted, the creases that met
/// them are chained again. So no crease of the result is shorter than min_length.
///
/// Pre: indices in range. Throws Error for a position of a triangle that is not finite, for a declared sharp edge that
/// is in no triangle, and for parameters out of range. Throws Error for an edge in three or more triangles or with two
/// half-edges of the same direction, naming the first. Throws Cancelled.
///
/// Post: the graph contains only vertices of polylines, ordered by position (x, then y, then z). Polylines are outer
/// boundaries, then holes, then creases. Each type is sorted by the first vertex, then by the second. A closed polyline
/// starts at its lowest corner or, without corners, at its lowest vertex. A closed crease continues to the lower
/// neighbour. An open polyline starts at its lower end. The bytes do not depend on the number of threads. They do not
/// depend on the order of the input's vertices and triangles either. There is one exception: if two vertices of feature
/// lines have equal positions, the mesh's order decides.
///
/// Cost: linear, and a sort of the lines' vertices; about 60 bytes per triangle. The cost of noisy_normals.hpp is
/// added, unless the given noise is 0.
/// Source: Wang 2006, chapter 4, for loops, holes and sharp edges; area test and tie rules are our own.
FeatureLines find_features(const TriangleMesh& mesh, const FeatureParams& params, const Execution& execution);

/// Returns one sentence for triangles without area, and one for boundary loops classified by their length.
std::vector<std::string> doubts(const FeatureCounts& counts);

}  // namespace scanmill
