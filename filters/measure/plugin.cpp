// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "measure/measure.hpp"
#include "measure/measured_metrics.hpp"

using namespace scanmill;

namespace {

using Filter = Declare<MeasureParams>;

/// The numbers of one side, `suffix`: "-to-truth" …, told of as `from_where`.
void declare_distances(Filter& filter, const std::string& suffix, const std::string& from_where) {
    const auto metric = [&](const char* name, const char* what) {
        filter.metric(name + suffix, Unit::length, std::string(what) + " " + from_where + ".");
    };
    metric("mean", "Mean distance");
    metric("mean-spread", "Standard error of the mean that sampling leaves, of the distances");
    metric("rms", "Root of the mean squared distance");
    metric("p50", "Half of the distances are not larger,");
    metric("p90", "90 % of the distances are not larger,");
    metric("p95", "95 % of the distances are not larger,");
    metric("p99", "99 % of the distances are not larger,");
    metric("max", "Largest distance at a sample or a vertex,");
}

/// What is true of one mesh; `prefix`: "" or "truth-".
void declare_mesh(Filter& filter, const std::string& prefix, const std::string& of) {
    const auto metric = [&](const char* name, Unit unit, const std::string& what) {
        filter.metric(prefix + name, unit, what + " " + of + ".");
    };
    metric("area", Unit::area, "Sum of the triangles' areas");
    metric("volume", Unit::volume, "Enclosed volume, negative when inside out, only if it is closed,");
    metric("vertices", Unit::count, "Vertices in a triangle");
    metric("unused-vertices", Unit::count, "Vertices in no triangle");
    metric("triangles", Unit::count, "Number of triangles");
    metric("components", Unit::count, "Pieces connected through edges");
    metric("genus", Unit::count, "Handles, holes counted as filled, only if it is an oriented manifold,");
    metric("euler", Unit::count, "Vertices less edges plus triangles");
    metric("closed", Unit::boolean, "Whether it is a closed, oriented manifold,");
    metric("boundary-loops", Unit::count, "Connected pieces of the boundary");
    metric("boundary-edges", Unit::count, "Edges in one triangle");
    metric("nonmanifold-edges", Unit::count, "Edges in more than two triangles");
    metric("nonmanifold-vertices", Unit::count, "Vertices whose triangles are not one fan,");
    metric("misoriented-edges", Unit::count, "Edges that two triangles pass in the same direction,");
    metric("collinear-triangles", Unit::count, "Triangles whose corners lie on one line,");
    metric("min-angle", Unit::angle, "Smallest angle of a triangle");
    metric("min-angle-p5", Unit::angle, "Of the triangles' smallest angles the 5 % quantile,");
    metric("min-angle-p50", Unit::angle, "Of the triangles' smallest angles the median,");
    metric("aspect-ratio-p50", Unit::number, "Longest edge over 2 sqrt(3) inradii, 1 when equilateral: the median");
    metric("aspect-ratio-p95", Unit::number, "Of the same ratios the 95 % quantile,");
    metric("aspect-ratio-max", Unit::number, "Of the same ratios the largest,");
}

Filter declaration() {
    using P = MeasureParams;
    Filter filter("measure", 1);
    filter.summary("Tells how far a mesh is from the truth, both ways, and how good a mesh it is.")
        .source("Aspert, Santa-Cruz, Ebrahimi 2002; Knapitsch et al. 2017 for precision and recall")
        .ties("Of equally near triangles the first gives the normal.")
        .not_finite("Refused, with their number and the first of them.")
        .in<TriangleMesh>("mesh", "What is measured.")
        .in<TriangleMesh, PointCloud>("truth", "What it should be: a surface, or points on it.")
        .out<Metrics>("metrics", "Everything that was measured, lengths in the unit of the mesh.")
        .param("samples", &P::samples, "Points spread over the area of each mesh; of a cloud all points are taken.",
               at_least(fewest_samples))
        .param("thresholds", &P::thresholds, "Distances that count as near, for precision and recall.", above(0))
        .param("self-intersections", &P::self_intersections, "Whether pairs of intersecting triangles are counted.")
        .param("same-frame", &P::same_frame,
               "Whether unit and frame are known to be equal: sizes and places that say otherwise only warn then.")
        .choice("borders", &P::borders,
                {{"include", P::Borders::include, "They count like all others."},
                 {"exclude", P::Borders::exclude, "They are left out and counted: the mesh ends before them."}},
                "Points of a cloud whose nearest point on the mesh lies on a border of it.")
        .param("certify", &P::certify,
               "Whether the Hausdorff distance is bounded from both sides; truth is a mesh then.")
        .param("gap", &P::gap, "The bounds are brought this close: their difference over the upper one.", above(0),
               below(1))
        .param("most-cuts", &P::most_cuts, "Pieces cut before the bounds are given as they are by then.", at_least(1))
        .metric("hausdorff", Unit::length, "Largest distance at a sample or a vertex, either way.", headline)
        .metric("chamfer", Unit::length, "Half the sum of the two sides' mean distances.")
        .metric("f-score", Unit::ratio, "2 P R / (P + R) of precision P and recall R at the threshold.", headline,
                numbered)
        .metric("precision", Unit::ratio, "Share of the mesh's samples within the threshold of the truth.", numbered)
        .metric("recall", Unit::ratio, "Share of the truth's samples within the threshold of the mesh.", numbered)
        .metric("threshold", Unit::length,
                "The distance that f-score, precision and recall are for, in the order of `thresholds`.", numbered);
    declare_distances(filter, "", "over both sides with equal weight");
    declare_distances(filter, "-to-truth", "from the mesh to the truth");
    declare_distances(filter, "-from-truth", "from the truth to the mesh");
    declare_distances(filter, "-to-points", "from the mesh to the nearest point, where the truth is points");
    filter
        .metric("beyond-borders", Unit::count,
                "Points left out because what is nearest to them is a border of the mesh.")
        .metric("normal-consistency", Unit::number, "Mean cosine between normals at samples and at what is nearest.")
        .metric("normal-consistency-unsigned", Unit::number, "Mean of the same cosines without their signs.")
        .metric("without-normal", Unit::count, "Samples left out of these, nearest to triangles without a normal.")
        .metric("hausdorff-lower", Unit::length, "The Hausdorff distance is not smaller, when it is certified.")
        .metric("hausdorff-upper", Unit::length, "The Hausdorff distance is not larger, when it is certified.")
        .metric("certified", Unit::boolean, "Whether the two bounds are as close as `gap` asks.")
        .metric("cuts", Unit::count, "Pieces that were cut for the bounds.")
        .metric("diagonal", Unit::length, "Diagonal of the bounding box of the mesh.")
        .metric("self-intersections", Unit::count, "Pairs of triangles of the mesh that intersect, touching included.");
    declare_mesh(filter, "", "of the mesh");
    declare_mesh(filter, "truth-", "of the truth");
    filter.run([](const Inputs& inputs, const P& params, Context& context) {
        const auto& mesh = inputs.get<TriangleMesh>("mesh");
        const auto* surface = inputs.find<TriangleMesh>("truth");
        const Metrics metrics = metrics_of(surface ? measure(mesh, *surface, params, context)
                                                   : measure(mesh, inputs.get<PointCloud>("truth"), params, context));
        for (const Metric& metric : metrics.values) context.metric(metric.name, metric.value, metric.unit);
        return Outputs().set("metrics", metrics);
    });
    return filter;
}

}  // namespace

SCANMILL_FILTER() { return declaration(); }
