// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "align/align.hpp"
#include "scanmill/data/robust_box.hpp"

using namespace scanmill;

namespace {

AlignPart part_of(BoundingBox box, const Frame& frame) {
    if (!box.empty()) box = {box.low + frame.origin, box.high + frame.origin};
    return {box, frame.name};
}

std::optional<AlignPart> part_at(const Inputs& inputs) {
    if (const auto* cloud = inputs.find<PointCloud>("part"))
        return part_of(robust_box(cloud->positions.span()).robust, cloud->frame);
    if (const auto* mesh = inputs.find<TriangleMesh>("part")) return part_of(surface_box(*mesh), mesh->frame);
    return {};
}

}  // namespace

SCANMILL_FILTER() {
    using P = AlignParams;
    return Declare<P>("align", 4)
        .summary("Finds the rigid motion that carries points onto corresponding points.")
        .source("Kabsch 1978; Umeyama 1991; Wang 2006, chapter 5")
        .ties("A `first-corner` that is equally near to two corners is refused.")
        .not_finite("Refused, with their number and the first of them.")
        .in<PointCloud>("source", "The points that are moved, such as the corners of a plate in a scan.")
        .in<PointCloud>("target", "The corresponding points, such as the same corners measured by a machine.")
        .in<PointCloud, TriangleMesh>(
            "part", "The part that will be moved, in the source's frame; for `error-at-part`.", optional)
        .out<Transforms>("transform",
                         "From the frame of the source to that of the target; it never scales. Contains the `rms`.")
        .choice("scale", &P::scale,
                {{"none", P::Scale::none, "The scale is not checked, and the metric `scale` is not computed."},
                 {"report", P::Scale::report,
                  "The metric `scale` is the size of the target relative to the source. The result is doubtful if this "
                  "scale differs from 1 by more than 0.0001 and leaves less than a third of the residuals (with three "
                  "pairs, less than a tenth)."}},
                "Whether the scale that would fit best is reported, as a check of the units; the transform does not "
                "contain it.")
        .choice("correspondence", &P::correspondence,
                {{"rows", P::Correspondence::rows, "Row i of the source belongs to row i of the target."},
                 {"rectangle", P::Correspondence::rectangle,
                  "The source and the target each have the four corners of a rectangle, in any order; needs "
                  "`first-corner`."}},
                "Decides which source and target points belong together.")
        .param("first-corner", &P::first_corner,
               "x, y, z of a rough position in the source, near the corner that belongs to the first target point.",
               size(3))
        .param(
            "up", &P::up,
            "For `rectangle`: a direction away from the upper side of a plate whose points have no normals, in the "
            "source and in the target. Without it, the rows of a source that go around the plate are counter-clockwise "
            "seen from above; other plates face (0, 0, 1).",
            size(3))
        .metric("rms", Unit::length, "Root mean square distance of the target points from their moved partners.",
                headline, smaller_is_better)
        .metric("largest-residual", Unit::length,
                "Distance of the target point that stays farthest from its moved partner.", headline, smaller_is_better)
        .metric("residual", Unit::length, "Distance of each of the first 100 target points from its moved partner.",
                numbered, smaller_is_better)
        .metric("error-at-part", Unit::length,
                "Standard error of a moved point, the largest over the corners of the part's bounding box.", headline,
                smaller_is_better)
        .metric("scale", Unit::number, "Size of the target relative to the source: 1 if the units agree.")
        .doubts({"`scale` is `report`, and a scale other than 1 explains the residuals"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            const AlignResult found = align(inputs.get<PointCloud>("source"), inputs.get<PointCloud>("target"),
                                            part_at(inputs), params, context);
            return Outputs().set("transform", Transforms(found.transform));
        });
}
