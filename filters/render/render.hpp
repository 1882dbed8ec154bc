// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Pictures of meshes, points, patches, probes and features, without a display or a graphics card.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/patches.hpp"
#include "scanmill/data/picture.hpp"
#include "scanmill/data/probes.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// Directions from which the camera looks. Front, back, left and right are level; the up axis points up.
enum class CameraView { automatic, front, back, left, right, top, bottom };
enum class UpAxis { automatic, x, y, z };

struct RenderParams {
    /// Columns and rows of the picture, each from 16 to 4096.
    std::vector<u32> size{800, 600};
    /// One view each; several views share the picture.
    std::vector<CameraView> camera{CameraView::automatic};
    /// World coordinates. With an eye, the picture is one perspective view from there, to `look_at` or to the centre.
    std::optional<std::vector<Length>> eye, look_at;
    UpAxis up = UpAxis::automatic;
    /// The column that colours the scene. Without one, the scene has one colour.
    std::optional<std::string> colour;
    /// The values at the ends of the colour scale. Without them, see render().
    std::optional<std::vector<Length>> scale;
    /// The limits of the values. They are marked in the legend, and values within have the lightest colours. Without
    /// `scale`, the colours end at twice the limits.
    std::optional<std::vector<Length>> tolerance;
    bool legend = true;
    /// lines: reflections of parallel dark and bright bands, which show waves and kinks of a surface.
    enum class Style { shaded, lines } style = Style::shaded;
    bool edges = false, boundaries = false, intersections = false, creases = false;
};

using Drawable = std::variant<std::monostate, const TriangleMesh*, const PointCloud*, const FeatureGraph*,
                              const PatchComplex*, const ProbePlan*>;

struct RenderInputs {
    Drawable scene;
    /// Points, features or probes that are drawn on the scene. Of points with a column `label`, those with a label.
    Drawable over;
    /// Sets the camera instead of the scene, so that pictures of different results match.
    Drawable truth;
};

/// Draws the scene by casting rays.
///
/// Views are orthographic, except from an `eye`. The automatic camera looks down by 15, 30 or 50 degrees and chooses,
/// among 72 directions, the one with the largest silhouette; parts seen from behind count a quarter. An earlier
/// direction wins unless a later one is 2 % larger. The automatic up axis is z, unless the object stands on a flat base
/// along y or x that is larger by half.
///
/// Surfaces take the normals of the face column `corner-normals` or the vertex column `normal`. Without them, normals
/// are averaged over the facets around a vertex that are within 40 degrees of the facet. Faces seen from behind are
/// blue-grey. Points are discs that face their `normal`, else the camera; they
/// have 0.7 times the distance to the 6th neighbour as radius, but 0.75 to 3 spacings.
///
/// The automatic scale covers 98 % of the values; if they have both signs, it is symmetrical. Values beyond the ends
/// have the end's colour, NaN is grey. At points and vertices with a column `label` above 0, the value of the coloured
/// column is written.
///
/// Pre: all inputs have one origin. Throws Error for a scene without triangles, points or lines, coordinates that are
/// not finite, a column that does not exist or has more than one number per row and is not a colour, a scale upside
/// down, an eye at the point that it looks at, `look_at` without `eye`, and `eye` with a `camera`.
/// Ties: of equally near triangles or discs, the lowest row is seen.
/// Cost: O(n log n) for the scene, 4 rays (style lines: 9) and 8 short rays per pixel; about 150 bytes per triangle and
/// 80 per pixel. The bytes do not depend on the number of threads or on the processor.
/// Source: Wald, Woop, Benthin, Johnson, Ernst 2014 (Embree); Kaufmann and Klass 1988 (reflection lines).
Picture render(const RenderInputs& inputs, const RenderParams& params, Context& context);

}  // namespace scanmill
