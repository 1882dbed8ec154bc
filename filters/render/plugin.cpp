// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "render/render.hpp"

using namespace scanmill;

namespace {

Drawable drawable_at(const Inputs& inputs, std::string_view port) {
    if (const auto* mesh = inputs.find<TriangleMesh>(port)) return mesh;
    if (const auto* points = inputs.find<PointCloud>(port)) return points;
    if (const auto* features = inputs.find<FeatureGraph>(port)) return features;
    if (const auto* patches = inputs.find<PatchComplex>(port)) return patches;
    if (const auto* probes = inputs.find<ProbePlan>(port)) return probes;
    return {};
}

}  // namespace

SCANMILL_FILTER() {
    using P = RenderParams;
    return Declare<P>("render", 1)
        .summary("Draws a picture of a mesh, points, features, patches or probes, without a display.")
        .source("Wald, Woop, Benthin, Johnson, Ernst 2014; Kaufmann, Klass 1988")
        .ties("Of equally near triangles or points, the one with the lowest row is seen.")
        .not_finite(
            "Refused in coordinates; the message gives their number and the first one. NaN in the coloured "
            "column is grey.")
        .in<TriangleMesh, PointCloud, FeatureGraph, PatchComplex, ProbePlan>(
            "scene", "What the picture shows; without `in`, the last geometric value before the step.")
        .in<PointCloud, FeatureGraph, ProbePlan>(
            "over",
            "Drawn on the scene: points as dots, features as lines, probes with their approaches. Of points with a "
            "column `label`, only those with a label above 0.",
            optional)
        .in<TriangleMesh, PointCloud>(
            "truth",
            "Sets the camera instead of the scene, so that pictures of different results match. It may have another "
            "unit.",
            optional)
        .out<Picture>("picture", "The picture; PNG files hold its caption as description.")
        .param("size", &P::size, "Columns and rows of the picture in pixels.", size(2), at_least(16), at_most(4096))
        .choices("camera", &P::camera,
                 {{"auto", CameraView::automatic,
                   "From above, in the direction that shows the largest silhouette; surfaces seen from behind count a "
                   "quarter."},
                  {"front", CameraView::front, "Level, from -y if z is up, from +z if y or x is up."},
                  {"back", CameraView::back, "Level, from the opposite of `front`."},
                  {"left", CameraView::left, "Level, from the left of `front`."},
                  {"right", CameraView::right, "Level, from the right of `front`."},
                  {"top", CameraView::top, "From above."},
                  {"bottom", CameraView::bottom, "From below."}},
                 "Directions of view. Several views share the picture; all are orthographic.")
        .param("eye", &P::eye,
               "x, y, z of a camera in world coordinates: one perspective view from there instead of `camera`.",
               word("none"), size(3))
        .param("look-at", &P::look_at, "x, y, z of the point in the middle of the view from `eye`; else the centre.",
               word("none"), size(3))
        .choice("up", &P::up,
                {{"auto", UpAxis::automatic,
                  "z, unless the object stands on a flat base along y or x that is larger by half."},
                 {"x", UpAxis::x, "The x axis points up."},
                 {"y", UpAxis::y, "The y axis points up."},
                 {"z", UpAxis::z, "The z axis points up."}},
                "The axis that points up in the picture.")
        .param("colour", &P::colour,
               "The column that colours a mesh or points: one number per row, or the colours of a scan.", word("none"))
        .param("scale", &P::scale,
               "The values at the lower and upper end of the colours, written as lengths for every column. `auto` "
               "covers 98 % of the values, symmetrically if they have both signs.",
               word("auto"), size(2))
        .param("tolerance", &P::tolerance,
               "Lower and upper limit of the values: marked in the legend; values within have the lightest colours. "
               "Without `scale`, the colours end at twice the limits.",
               word("none"), size(2))
        .param("legend", &P::legend, "Whether the colours of numbers are explained beside the scene.")
        .choice("style", &P::style,
                {{"shaded", P::Style::shaded, "Matt surfaces in light from the upper left, with ambient occlusion."},
                 {"lines", P::Style::lines,
                  "Surfaces reflect dark and bright bands. Waves and kinks of a surface bend and break the bands."}},
                "The look of surfaces.")
        .param("edges", &P::edges, "Whether the edges of the triangles are drawn.")
        .param("boundaries", &P::boundaries, "Whether boundary edges of a mesh are drawn, in orange.")
        .param("intersections", &P::intersections,
               "Whether triangles that intersect others are drawn in magenta; takes about 1 us per triangle of a good "
               "mesh.")
        .param("creases", &P::creases,
               "Whether the mesh's sharp edges are drawn; without any, edges of more than 40 degrees.")
        .draws(DrawSpec{"scene", "truth", "size", "colour", "scale", "tolerance"})
        .doubts({"the picture shows nothing"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("picture", render({drawable_at(inputs, "scene"), drawable_at(inputs, "over"),
                                                    drawable_at(inputs, "truth")},
                                                   params, context));
        });
}
