// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "inspect/inspect.hpp"

using namespace scanmill;

namespace {

using P = InspectParams;
using Filter = Declare<P>;

/// Declares the numbers that the whole nominal and each part have.
void declare_numbers(Filter& filter) {
    filter
        .metric("points", Unit::count,
                "Points of the scan; of a mesh, its vertices in triangles. With @2, @3 and so on, the points nearest "
                "to a part.",
                numbered)
        .metric("counted", Unit::count,
                "Points in the statistics: all without those undecided, beyond borders, too far and cut.", numbered)
        .metric("min", Unit::length, "Least deviation.", numbered, headline)
        .metric("max", Unit::length, "Largest deviation.", numbered, headline)
        .metric("mean", Unit::length, "Mean deviation.", numbered)
        .metric("rms", Unit::length, "Root of the mean squared deviation.", numbered, smaller_is_better)
        .metric("standard-deviation", Unit::length,
                "Root of the mean squared difference from the mean; the divisor is the number of points.", numbered,
                smaller_is_better)
        .metric("mean-above", Unit::length, "Mean of the deviations above 0.", numbered)
        .metric("mean-below", Unit::length, "Mean of the deviations below 0.", numbered)
        .metric("in-tolerance", Unit::ratio,
                "Share of the counted points within the tolerance, ends included. With @2, @3 and so on, that of a "
                "part.",
                numbered, headline, larger_is_better)
        .metric("above", Unit::ratio, "Share of the counted points above the tolerance.", numbered, smaller_is_better)
        .metric("below", Unit::ratio, "Share of the counted points below the tolerance.", numbered, smaller_is_better)
        .metric("p1", Unit::length, "Least deviation that at least 1 % of all do not exceed.", numbered)
        .metric("p5", Unit::length, "Least deviation that at least 5 % of all do not exceed.", numbered)
        .metric("p50", Unit::length, "Least deviation that at least 50 % of all do not exceed.", numbered)
        .metric("p95", Unit::length, "Least deviation that at least 95 % of all do not exceed.", numbered)
        .metric("p99", Unit::length, "Least deviation that at least 99 % of all do not exceed.", numbered);
}

Filter declaration() {
    Filter filter("inspect", 1);
    filter.summary("Compares a scan with its nominal mesh: signed deviations, a verdict by tolerance, a heat map.")
        .source("Baerentzen, Aanaes 2005, Signed distance computation using the angle weighted pseudonormal")
        .ties(
            "Of equally near triangles, the one with the lowest row counts. Of equal deviations, the point with the "
            "lowest row gets the label first.")
        .not_finite("Refused; the message gives their number and the first one.")
        .in<PointCloud, TriangleMesh>("scan", "The measured part: points, or a mesh whose vertices are measured.")
        .in<TriangleMesh>("nominal", "The surface that the part should have, in the frame and unit of the scan.")
        .in<Transforms>("transform", "The motion that aligned the scan; not applied, only its rms is reported.",
                        optional, by_name)
        .out<Metrics>("metrics", "All metrics, lengths in the unit of the scan.")
        .out_like("deviation", "scan",
                  "The scan with the columns `deviation` (NaN for points without one), `label` (0 without), `part` "
                  "and `colour`.",
                  by_name)
        .out<TriangleMesh>("on-nominal",
                           "The nominal with shorter edges and the vertex columns `deviation` (mean of the nearby "
                           "points, NaN without any) and `colour`.",
                           by_name)
        .adds({"deviation", "label", "part", "colour", "scan-colour"})
        .param("tolerance", &P::tolerance, "Lowest and highest allowed deviation, such as [-0.05 mm, 0.1 mm].",
               required, size(2))
        .choice("borders", &P::borders,
                {{"include", P::Borders::include, "These points count like all others."},
                 {"exclude", P::Borders::exclude, "These points are left out and counted in beyond-borders."}},
                "Whether points count whose nearest point is on the border of an open nominal, and which are not "
                "above or below the surface there.")
        .param("sigma", &P::sigma,
               "Points farther than this many standard deviations from the mean are cut from the statistics, once.",
               above(0), word("none"))
        .param("max-distance", &P::max_distance,
               "Points farther from the nominal are too far to belong to it. `auto` is 10 times the larger amount of "
               "the tolerance; if points are farther, at least 3 spacings of the scan.",
               above(0), word("auto"))
        .param("chord-error", &P::chord_error,
               "Largest distance of the nominal from the CAD surface, known from its export; compared with the "
               "tolerance.",
               at_least(0))
        .choice("by", &P::by,
                {{"none", P::By::none, "Numbers for the whole nominal only."},
                 {"components", P::By::components, "Also numbers for each connected component of the nominal."},
                 {"patches", P::By::patches,
                  "Also numbers for each part of the nominal between its sharp edges (40 degrees)."}},
                "The parts of the nominal that have numbers of their own, from @2 on.")
        .param("labels", &P::labels, "Number of points that get a label, the largest absolute deviation first.",
               at_most(1000))
        .param("label-distance", &P::label_distance, "Least distance between two labels.", at_least(0))
        .param("bins", &P::bins, "Number of equal bins of the histogram between range-low and range-high.", at_least(1),
               at_most(10000));
    declare_numbers(filter);
    filter.metric("undecided", Unit::count, "Points left out because their sign is undecided.", smaller_is_better)
        .metric("beyond-borders", Unit::count,
                "Points left out because they are beyond the border of the nominal; 0 if borders are included.")
        .metric("too-far", Unit::count, "Points left out because they are farther than max-distance.",
                smaller_is_better)
        .metric("cut", Unit::count, "Points cut from the statistics by sigma.", smaller_is_better)
        .metric("parts", Unit::count, "Parts of the nominal; 0 for by: none.")
        .metric("tolerance-low", Unit::length, "Lowest deviation in tolerance.")
        .metric("tolerance-high", Unit::length, "Highest deviation in tolerance.")
        .metric("chord-error", Unit::length, "Largest distance of the nominal from the CAD surface, as given.")
        .metric("max-distance", Unit::length, "Largest distance at which a point is counted.")
        .metric("range-low", Unit::length, "Low end of histogram and colours: twice that of the tolerance, usually.")
        .metric("range-high", Unit::length, "High end of histogram and colours: twice that of the tolerance, usually.")
        .metric("histogram", Unit::ratio,
                "Shares of the counted points in equal bins from range-low to range-high. The first and the last bin "
                "also count what is outside.",
                numbered)
        .metric("label", Unit::length, "Deviation of each labelled point.", numbered)
        .metric("label-x", Unit::length, "World coordinate x of each labelled point.", numbered)
        .metric("label-y", Unit::length, "World coordinate y of each labelled point.", numbered)
        .metric("label-z", Unit::length, "World coordinate z of each labelled point.", numbered)
        .metric("aligned", Unit::boolean, "Whether a transform was given; if not, the scan is compared as in its file.")
        .metric("alignment-rms", Unit::length, "Distance that the alignment left, from the transform.",
                smaller_is_better)
        .metric("diagonal", Unit::length, "Diagonal of the bounding box of the nominal.");
    filter.inspects({.part = "scan",
                     .nominal = "nominal",
                     .outputs = {"on-nominal", "deviation"},
                     .column = "deviation",
                     .tolerance = {"tolerance-low", "tolerance-high"},
                     .range = {"range-low", "range-high"},
                     .histogram = "histogram",
                     .label = {"label", "label-x", "label-y", "label-z"},
                     .numbers = {"in-tolerance", "above", "below", "min", "max", "mean", "rms", "standard-deviation",
                                 "p1", "p50", "p99", "points"}});
    filter.doubts({"more than 50 % of the points are too far from the nominal to count, or have no sure sign",
                   "the nominal is inside out, or its triangles face different sides"});
    filter.run([](const Inputs& inputs, const P& params, Context& context) {
        const auto& nominal = inputs.get<TriangleMesh>("nominal");
        const auto* transforms = inputs.find<Transforms>("transform");
        Outputs outputs;
        const auto inspect_and_set = [&](const auto& scan) {
            const Inspection inspected = inspect(scan, nominal, transforms, params, context);
            const Metrics metrics = metrics_of(inspected);
            for (const Metric& metric : metrics.values) context.metric(metric.name, metric.value, metric.unit);
            outputs.set("metrics", metrics)
                .set("deviation", deviation_of(scan, inspected, context))
                .set("on-nominal", inspected.on_nominal);
        };
        if (const auto* cloud = inputs.find<PointCloud>("scan"))
            inspect_and_set(*cloud);
        else
            inspect_and_set(inputs.get<TriangleMesh>("scan"));
        return outputs;
    });
    return filter;
}

}  // namespace

SCANMILL_FILTER() { return declaration(); }
