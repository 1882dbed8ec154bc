// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "probe_planner/probe_planner.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = ProbePlannerParams;
    return Declare<P>("probe-planner", 5)
        .summary(
            "Plans where and from which direction a touch probe measures the edges of a part, and checks the plan by "
            "simulation.")
        .source("Wang 2006, chapter 5; both faces in closed form, collisions and order are our own")
        .ties(
            "The angle towards the left face is tried before its opposite. Among equally near lines or touches, the "
            "one with the lower row counts.")
        .not_finite("Refused; the message names the line and segment, or the vertex of the mesh.")
        .in<FeatureGraph>("features",
                          "Lines with the normals on both sides. The features of region-grow are best, since they "
                          "contain the normals beyond patch edges.")
        .made_by("region-grow")
        .in<TriangleMesh>("mesh", "The part. Ball and stylus must not meet it away from the touched edge.")
        .out<ProbePlan>("probes", "The touches of every reference point. A touch that cannot be made has a reason.")
        .param("radius", &P::radius, "Radius of the probe's ball.", above(0), required)
        .param("scanner-error", &P::scanner_error,
               "The largest distance of a reference point from the true edge. It is the scanner's error plus what "
               "thinning (about 0.4 voxels) and triangulation (about 1.5 times the distance of scan points) add. It "
               "must be below `radius`.",
               at_least(0), required)
        .param("spacing", &P::spacing, "Distance between touches along a line.", above(0))
        .param(
            "approach", &P::approach,
            "Angle of all approaches from the bisector of the faces, whether or not it is safe; from -90 to 90 deg, "
            "positive towards the face on the left of the line. With `auto`, each touch has its smallest safe angle.",
            at_least(-90), at_most(90), word("auto"))
        .param("retract", &P::retract,
               "Distance from the edge, along the bisector of the faces, at which an approach begins. `auto` is 4 "
               "radius + scanner-error + clearance.",
               above(0), word("auto"))
        .param("clearance", &P::clearance,
               "Least distance of ball and stylus from the part on moves between touches. `auto` is the radius.",
               at_least(0), word("auto"))
        .param("stylus-radius", &P::stylus_radius, "Radius of the stylus, below `radius`; `auto` is 0.6 radius.",
               above(0), word("auto"))
        .param("stylus-length", &P::stylus_length, "Length of the stylus from the ball's centre; `auto` is 20 radius.",
               above(0), word("auto"))
        .param("max-tilt", &P::max_tilt,
               "The largest angle between the machine's axis and the direction from the part to the probe.",
               at_least(0), at_most(180))
        .param("machine-axis", &P::machine_axis, "Direction from the ball along the stylus: x, y, z, of any length.",
               size(3))
        .choice("features", &P::features,
                {{"all", P::Features::all, "Every line."},
                 {"creases", P::Features::creases, "Sharp edges inside the mesh."},
                 {"holes", P::Features::holes, "Boundary loops of holes."},
                 {"boundaries", P::Features::boundaries, "Outer boundaries."}},
                "The lines that are probed.")
        .param(
            "directions", &P::directions,
            "Number of touches of each reference point. Two touches come from both sides of the bisector and together "
            "measure the edge exactly. A point gets only one touch and counts as `single` if the safe range leaves "
            "less than 10 deg between the two, or if one of them is too tilted, obstructed or too narrow.",
            at_least(1), at_most(2))
        .param("dmis-header", &P::dmis_header,
               "A text file with the statements before the first touch of a DMIS program of the plan, in place of the "
               "default ones. {radius}, {diameter}, {unit}, {approach}, {retract}, {search} and {clearance} in it are "
               "replaced.",
               word("none"))
        .choice(
            "dmis-goto", &P::dmis_goto,
            {{"plain", DmisGoto::plain, "Moves as GOTO/x,y,z."}, {"cart", DmisGoto::cart, "Moves as GOTO/CART,x,y,z."}},
            "The spelling of moves in a DMIS program of the plan.")
        .param("dmis-decimals", &P::dmis_decimals,
               "Decimals of coordinates in a DMIS program of the plan. `auto` is 4, or as many as keep 1e-4 of the "
               "radius.",
               at_most(DmisOptions::most_decimals), word("auto"))
        .metric("touches", Unit::count, "Touches, including those that cannot be made.", headline)
        .metric("assumed", Unit::count,
                "Touches at an edge with a surface on one side only; a right angle is assumed there.")
        .metric("unreachable", Unit::count, "Touches that cannot be made.", headline, smaller_is_better)
        .metric("too-narrow", Unit::count,
                "Unreachable touches without a safe direction, or in a hole too small for the ball.", smaller_is_better)
        .metric("concave", Unit::count, "Unreachable touches at concave edges, which no ball can meet.")
        .metric("obstructed", Unit::count, "Unreachable touches where ball or stylus would meet the part elsewhere.",
                smaller_is_better)
        .metric("too-tilted", Unit::count, "Unreachable touches farther from the machine's axis than max-tilt.",
                smaller_is_better)
        .metric("false-touches", Unit::count,
                "Tried positions of reference points, 1,000 for each touch, for which the ball meets a face before the "
                "edge; 0 unless `approach` is given.",
                headline, smaller_is_better)
        .metric("wrong-contacts", Unit::count,
                "Touches with a wrong contact in a simulated move: the ball first meets the mesh away from the "
                "reference point or rests on a face, or the stylus meets the mesh; 0 unless `approach` is given.",
                smaller_is_better)
        .metric("travel", Unit::length, "Length of all moves, approaches included.", headline, smaller_is_better)
        .metric("edge-roughness", Unit::length,
                "Distance of the lines' vertices from smooth curves (95 % quantile); a part of scanner-error.",
                smaller_is_better)
        .metric(
            "left-out-creases", Unit::count,
            "Creases that were left out: one side of bevels narrower than twice scanner-error, and shorter branches.")
        .metric("paired-lines", Unit::count, "Pairs of lines of two patches along one edge, which is probed once.")
        .metric("single", Unit::count, "Reference points with one touch although two were asked for.",
                smaller_is_better)
        .doubts({"no touch can be made"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("probes", probe_planner(inputs.get<FeatureGraph>("features"),
                                                         inputs.get<TriangleMesh>("mesh"), params, context)
                                               .plan);
        });
}
