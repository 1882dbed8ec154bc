// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decimation within a distance: removes vertices while no point of the input mesh is farther than `max_error` from the
/// result, and no point of the result farther from the input.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct DecimateParams {
    enum class Mode {
        direct,  ///< distances are measured to the input surface, and to the data points if there are any
        accumulated  ///< the paper: two bounds per triangle, which grow with every removal
    };
    /// Largest distance between input and result.
    Length max_error = Length::percent_of_diagonal(0.1);
    /// In place of max_error for the parts of the input outside the result, and inside it.
    std::optional<Length> outside, inside;
    Mode mode = Mode::direct;
    /// Edges whose triangles' normals differ by more are sharp. 20 to 75 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// A feature line that turns by more has a corner there.
    Angle corner_angle = Angle::degrees(35);
    /// The normal of a new triangle differs by at most this from the mean normal of the triangles it replaces.
    Angle normal_deviation = Angle::degrees(60);
    /// No new triangle has a smaller angle, unless one of those it replaces had.
    Angle min_angle = Angle::degrees(5);
    /// Vertices with more edges are neither removed nor made.
    u32 max_valence = 25;
    /// Removal ends with at most so many triangles; 0: no such limit.
    u64 target_triangles = 0;
    /// Whether edges are flipped in the end to raise the least angles.
    bool final_flips = true;
};

enum class VertexClass : u8 { smooth, crease, corner, boundary };

struct DecimateResult {
    TriangleMesh mesh;
    std::size_t removed = 0;
};

DecimateResult decimate(const TriangleMesh& mesh, const PointCloud* points, const DecimateParams& params,
                        Context& context);

}  // namespace scanmill
