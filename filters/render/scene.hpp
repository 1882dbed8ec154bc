// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a picture shows, reduced to triangles, discs, lines and dots with colours.

#include <optional>
#include <string>
#include <vector>

#include "render/ray_caster.hpp"
#include "render/render.hpp"
#include "scanmill/geometry/colour/colour_scale.hpp"

namespace scanmill {

/// A line or dot is drawn over the surface, unless the surface hides it. Widths and radii are in pixels of a picture
/// with 600 rows.
struct DrawnLine {
    Vec3 from, to;
    Colour colour;
    double width;
};
struct DrawnDot {
    Vec3 position;
    Colour colour;
    double radius;
    std::string label;  ///< empty for none
};

/// The colours of a column: numbers on a scale, or red, green and blue.
struct DrawnColumn {
    std::string name;
    bool by_face = false;    ///< one row per triangle; otherwise one per vertex or point
    Array<double> values;    ///< empty if the column holds colours
    Array<Colour> colours;   ///< empty if the column holds numbers
    ColourScale scale;
    std::string unit;        ///< empty if the numbers are not lengths
    bool has_gaps = false;   ///< some values are NaN
};

struct DrawnScene {
    TriangleMesh mesh;  ///< without triangles for scenes of points or lines
    Array<Disc> discs;
    Array<u32> disc_rows;  ///< the point of each disc
    double disc_radius = 0;  ///< the median of the discs' radii
    std::optional<DrawnColumn> column;
    /// One per triangle, nonzero if it intersects another; empty unless wanted.
    std::vector<u8> intersecting;
    std::vector<DrawnLine> lines;
    std::vector<DrawnDot> dots;
    std::string summary;  ///< "69,451 triangles"

    bool has_surface() const { return !mesh.triangles.empty() || !discs.empty(); }
    /// Positions that the camera should show.
    Array<Vec3> extent() const;
};

/// Throws Error for a scene without anything to draw, NaN in coordinates, and a column that does not exist or has
/// lists.
DrawnScene make_scene(const RenderInputs& inputs, const RenderParams& params, Context& context);

}  // namespace scanmill
