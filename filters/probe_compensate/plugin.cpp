// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "probe_compensate/probe_compensate.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = ProbeCompensateParams;
    return Declare<P>("probe-compensate", 2)
        .summary("Makes points and lines of the edges from the touches of a measuring machine.")
        .source("Wang 2006, chapter 5, for the touches")
        .ties(
            "If a touch has several pairs of rows with approaches equally far apart, the pair whose rows come first is "
            "used. Touches exactly two spacings apart have a gap between them.")
        .not_finite("Refused; the message gives their number and the first one, or the column and the row.")
        .adds({"touch", "feature", "approach", "uncertainty"})
        .in<PointCloud>("points",
                        "Measured touches with the column `approach`, from the part to the probe; if they exist, the "
                        "columns `touch`, `feature` and `uncertainty` are used.")
        .made_by("virtual-probe")
        .in<ProbePlan>("plan",
                       "The plan of the touches: it has the `feature` of each `touch`, which a machine's results lack.",
                       optional, by_name)
        .out<PointCloud>("points", "Points of the edges: one of each pair of touches, one of every other touch.")
        .out<FeatureGraph>("features", "The touched lines of each `feature`, without normals.")
        .param("radius", &P::radius, "Radius of the probe's ball.", above(0), required)
        .choice("reported", &P::reported,
                {{"contact", P::Reported::contact,
                  "The ball's centre, moved by the radius against the approach: the machine compensates by itself."},
                 {"centre", P::Reported::centre, "The ball's centre."}},
                "What the positions of the touches are.")
        .param("scanner-error", &P::scanner_error,
               "Largest distance of a reference point from the true edge; single touches are so uncertain.",
               at_least(0))
        .choice(
            "tangent", &P::tangent,
            {{"line", P::Tangent::line,
              "The direction of the circle through a pair and its neighbours in the line, where these are pairs and "
              "the line has no corner; else the cross product of the approaches."},
             {"approaches", P::Tangent::approaches, "The cross product of the approaches."}},
            "The direction of the edge at a pair.")
        .param("spacing", &P::spacing,
               "Distance of touches along a line; lines end where touches are twice as far apart. `auto` is the median "
               "of each feature.",
               above(0), word("auto"))
        .param("noise", &P::noise,
               "Standard deviation of the machine's error in each coordinate, where the touches have no column "
               "`uncertainty`.",
               at_least(0))
        .param("chord-error", &P::chord_error,
               "Lines follow circles through neighbouring pairs; this is the largest distance of their chords from the "
               "circles. `auto` is 0.5 % of the median distance of touches.",
               above(0), word("auto"))
        .metric("points", Unit::count, "Points that were made.", headline)
        .metric("paired", Unit::count, "Points made of two touches, which fix the edge.", headline, larger_is_better)
        .metric("single", Unit::count, "Points made of one touch, which measures the edge along its approach only.",
                headline, smaller_is_better)
        .metric("unused", Unit::count, "Touches that were left out because others of their number make the pair.")
        .metric("curved", Unit::count, "Pairs whose tangent is that of the line.")
        .metric("lines", Unit::count, "Touched lines.")
        .metric("lone", Unit::count, "Touched points that are too far from their neighbours for a line.",
                smaller_is_better)
        .metric("repeated", Unit::count,
                "Touched points that were left out of a line, because another point of the same place is in it.")
        .doubts({"the normals at the contacts of the median pair are less than half, or more than 1.5 times, as far "
                 "apart as its approaches"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            const PointCloud& touches = inputs.get<PointCloud>("points");
            const auto* plan = inputs.find<ProbePlan>("plan");
            ProbeCompensateResult result =
                probe_compensate(plan ? with_features(touches, *plan) : touches, params, context);
            return Outputs().set("points", std::move(result.points)).set("features", std::move(result.features));
        });
}
