// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The feature lines of a mesh: where it ends, where it bends sharply, and where such lines meet or turn.
///
/// An edge is *sharp* when the normals of its two triangles differ by more than `sharp_angle`, or when it is one of the
/// mesh's own sharp edges. A vertex of feature lines is a *corner* when other than two sharp or boundary edges meet in
/// it, or when the line turns there by more than `corner_angle`. Angles within 1e-9 rad of a limit count as equal to
/// it, so not as above it: a prism of 36 sides has no crease at 10 degrees, whatever the rounding.
///
/// Sharp edges are chained into creases from corner to corner. Boundary edges are chained into whole loops, across
/// corners, the surface on their left seen from outside; every loop is an outer boundary or a hole (see
/// geometry/boundary_loops.hpp for the rule).

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill {

struct FeatureParams {
    /// 0 to 180 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// 0 to 180 degrees.
    Angle corner_angle = Angle::degrees(35);
    /// Shorter creases are left out; 0 or more, resolved.
    Length min_length;
};

struct FeatureCounts {
    std::size_t creases = 0;
    std::size_t holes = 0;
    std::size_t boundaries = 0;  ///< outer ones
    std::size_t corners = 0;
    std::size_t ambiguous = 0;  ///< boundary loops whose projected area did not tell what they are
    std::size_t dropped = 0;  ///< creases left out for their length
    std::size_t without_area = 0;  ///< triangles, see geometry/facet_normals.hpp for their normals
};

struct FeatureLines {
    FeatureGraph graph;
    FeatureCounts counts;
};

/// Pre: indices in range. Throws Error for a position of a triangle that is not finite, for an edge in three or more
/// triangles or passed twice in the same direction (naming the first), for a sharp edge of the mesh that no triangle
/// has, and for parameters out of range. Two fans that touch
/// in a vertex are allowed: it is a corner, and a loop stays with its fan.
///
/// Post: vertices of the graph are numbered by their place (x, then y, then z); only those of polylines are there.
/// Polylines: outer boundaries, holes, creases; among these by their first vertex, then their second. A closed one
/// begins at its lowest corner, without corners at its lowest vertex; a closed crease goes to the lower of the two next
/// ones. An open one begins at its lower end. The same bytes for any number of threads and any order of the input's
/// vertices and triangles, unless two vertices of feature lines are at one place (then the mesh's order decides).
///
/// When creases are left out, those that met them are chained anew: no crease of the result is shorter than min_length.
/// Cost: linear, and a sort of the lines' vertices; about 60 bytes per triangle.
/// Source: Wang 2006, chapter 4, for loops, holes and sharp edges; the tests of area and ties are our own.
FeatureLines find_features(const TriangleMesh& mesh, const FeatureParams& params, unsigned threads);

/// One sentence for triangles without area, and one for boundary loops that only their length could classify.
std::vector<std::string> doubts(const FeatureCounts& counts);

}  // namespace scanmill
