// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "probe_planner/probe_planner.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = ProbePlannerParams;
    return Declare<P>("probe-planner", 4)
        .summary("Plans where and from which direction a touch probe measures the edges of a part, and proves it.")
        .source("Wang 2006, chapter 5; both faces in closed form, collisions and order are our own")
        .ties("Of phi and -phi the one towards the left face; of equally near lines and touches the lower one.")
        .not_finite("Refused: the line and segment, or the vertex of the mesh, are named.")
        .in<FeatureGraph>("features",
                          "Lines with the normals on both sides; best region-grow's own, which contains the normals "
                          "beyond patch edges.")
        .made_by("region-grow")
        .in<TriangleMesh>("mesh", "The part, which ball and stylus must not meet elsewhere.")
        .out<ProbePlan>("probes", "A touch for every reference point, with those that cannot be made and why.")
        .param("radius", &P::radius, "Of the probe's ball.", above(0), required)
        .param("scanner-error", &P::scanner_error,
               "The largest distance of a reference point from the true edge: what the scanner errs, and what thinning "
               "and triangulating add, about 0.4 voxels and 1.5 times the distance of scan points. Below `radius`.",
               at_least(0), required)
        .param("spacing", &P::spacing, "Between touches along a line.", above(0))
        .param("approach", &P::approach,
               "The angle from the bisector of the faces, positive towards the face on the left of the line, for all "
               "touches, whether or not it is safe; -90 to 90 deg. `auto` is the smallest safe angle of each touch.",
               at_least(-90), at_most(90), word("auto"))
        .param("retract", &P::retract,
               "How far along the bisector of the faces an approach begins. `auto` is 4 radius + scanner-error + "
               "clearance.",
               above(0), word("auto"))
        .param("clearance", &P::clearance,
               "Between the part, and ball and stylus, on moves from touch to touch. `auto` is the radius.",
               at_least(0), word("auto"))
        .param("stylus-radius", &P::stylus_radius, "Below `radius`; `auto` is 0.6 radius.", above(0), word("auto"))
        .param("stylus-length", &P::stylus_length, "From the ball's centre; `auto` is 20 radius.", above(0),
               word("auto"))
        .param("max-tilt", &P::max_tilt,
               "The largest angle between the machine's axis and the direction from the part to the probe.",
               at_least(0), at_most(180))
        .param("machine-axis", &P::machine_axis, "From the ball along the stylus: x, y, z, of any length.", size(3))
        .choice("features", &P::features,
                {{"all", P::Features::all, "Every line."},
                 {"creases", P::Features::creases, "Sharp edges inside the mesh."},
                 {"holes", P::Features::holes, "Rims of holes."},
                 {"boundaries", P::Features::boundaries, "Outer boundaries."}},
                "The lines that are probed.")
        .param(
            "directions", &P::directions,
            "2: two touches of each reference point from both sides of the bisector, which together measure the edge "
            "exactly. Where the range leaves less than 10 deg between them, or one of them is too tilted, obstructed "
            "or "
            "too narrow, the point gets one touch and counts as `single`.",
            at_least(1), at_most(2))
        .metric("touches", Unit::count, "Touches, with those that cannot be made.", headline)
        .metric("assumed", Unit::count, "Touches beyond whose edge there is no surface: a right angle is assumed.")
        .metric("unreachable", Unit::count, "Touches that cannot be made.", headline, smaller_is_better)
        .metric("too-narrow", Unit::count,
                "Unreachable touches without a safe direction, or in a hole too small for the ball.", smaller_is_better)
        .metric("concave", Unit::count, "Unreachable touches at edges that no ball meets.")
        .metric("obstructed", Unit::count, "Unreachable touches where ball or stylus would meet the part elsewhere.",
                smaller_is_better)
        .metric("too-tilted", Unit::count, "Unreachable touches farther from the machine's axis than max-tilt.",
                smaller_is_better)
        .metric("false-touches", Unit::count,
                "Tried positions of reference points, 1,000 for each touch, for which a face is met before the edge; 0 "
                "unless `approach` is given.",
                headline, smaller_is_better)
        .metric(
            "wrong-contacts", Unit::count,
            "Touches whose ball, moved against the mesh, does not meet it near the reference point first, or rests on "
            "a face, or whose stylus meets the mesh; 0 unless `approach` is given.",
            smaller_is_better)
        .metric("travel", Unit::length, "Length of all moves, approaches included.", headline, smaller_is_better)
        .metric("edge-roughness", Unit::length,
                "How far the lines' vertices are beside smooth curves (95 % quantile); a part of scanner-error.",
                smaller_is_better)
        .metric("paired-lines", Unit::count, "Pairs of lines of two patches along one edge, which is probed once.")
        .metric("single", Unit::count, "Reference points with one touch although two were asked for.",
                smaller_is_better)
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("probes", probe_planner(inputs.get<FeatureGraph>("features"),
                                                         inputs.get<TriangleMesh>("mesh"), params, context)
                                               .plan);
        });
}
