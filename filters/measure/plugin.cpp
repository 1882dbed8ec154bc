// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "measure/measure.hpp"

using namespace scanmill;

namespace {

using Filter = Declare<MeasureParams>;

/// Declares the metrics of one direction. `suffix`: "-to-truth" …; `from_where`: description of the direction.
void declare_distances(Filter& filter, const std::string& suffix, const std::string& from_where) {
    const auto metric = [&](const char* name, const char* what) {
        filter.metric(name + suffix, Unit::length, std::string(what) + " " + from_where + ".", smaller_is_better);
    };
    metric("mean", "Mean distance");
    filter.metric("mean-spread" + suffix, Unit::length, "Standard error of the mean distance " + from_where + ".");
    metric("rms", "Root of the mean squared distance");
    metric("p50", "Median of the distances");
    metric("p90", "90 % quantile of the distances");
    metric("p95", "95 % quantile of the distances");
    metric("p99", "99 % quantile of the distances");
    metric("max", "Largest distance at a sample or a vertex,");
}

/// Declares the metrics of one mesh by itself. `prefix`: "" or "truth-". No value of the truth is better than another.
void declare_mesh(Filter& filter, const std::string& prefix, const std::string& of) {
    const auto metric = [&](const char* name, Unit unit, const std::string& what,
                            std::same_as<MetricOption> auto... better) {
        prefix.empty() ? filter.metric(name, unit, what + " " + of + ".", better...)
                       : filter.metric(prefix + name, unit, what + " " + of + ".");
    };
    metric("area", Unit::area, "Sum of the triangles' areas");
    metric("volume", Unit::volume, "Enclosed volume (negative if inside out, only if closed)");
    metric("vertices", Unit::count, "Vertices in a triangle");
    metric("unused-vertices", Unit::count, "Vertices in no triangle", smaller_is_better);
    metric("triangles", Unit::count, "Number of triangles");
    metric("components", Unit::count, "Components connected through edges");
    metric("genus", Unit::count, "Number of handles after filling holes (only for an oriented manifold)");
    metric("euler", Unit::count, "Vertices minus edges plus triangles");
    metric("closed", Unit::boolean, "Closedness (1 for a closed, oriented manifold, else 0)", larger_is_better);
    metric("boundary-loops", Unit::count, "Connected components of the boundary");
    metric("boundary-edges", Unit::count, "Edges in one triangle", smaller_is_better);
    metric("nonmanifold-edges", Unit::count, "Edges in more than two triangles", smaller_is_better);
    metric("nonmanifold-vertices", Unit::count, "Vertices whose triangles do not form one fan,", smaller_is_better);
    metric("misoriented-edges", Unit::count, "Edges with the same direction in two triangles", smaller_is_better);
    metric("collinear-triangles", Unit::count, "Collinear triangles", smaller_is_better);
    metric("min-angle", Unit::angle, "Smallest angle of a triangle", larger_is_better);
    metric("min-angle-p5", Unit::angle, "5 % quantile of the triangles' smallest angles", larger_is_better);
    metric("min-angle-p50", Unit::angle, "Median of the triangles' smallest angles", larger_is_better);
    metric("aspect-ratio-p50", Unit::number,
           "Median aspect ratio (longest edge over 2 sqrt(3) inradii, 1 if equilateral) of the triangles",
           smaller_is_better);
    metric("aspect-ratio-p95", Unit::number, "95 % quantile of the triangles' aspect ratios", smaller_is_better);
    metric("aspect-ratio-max", Unit::number, "Largest aspect ratio of a triangle", smaller_is_better);
}

Filter declaration() {
    using P = MeasureParams;
    Filter filter("measure", 3);
    filter
        .summary("Measures the distance between a mesh and its truth, in both directions, and the quality of the mesh.")
        .source("Aspert, Santa-Cruz, Ebrahimi 2002; Knapitsch et al. 2017 for precision and recall")
        .ties("Of equally near triangles, the first gives the normal.")
        .not_finite("Refused; the message gives their number and the first one.")
        .in<TriangleMesh>("mesh", "The mesh to measure.")
        .in<TriangleMesh, PointCloud>("truth", "The surface that the mesh should have, or points on that surface.")
        .out<Metrics>("metrics", "All metrics, lengths in the unit of the mesh.")
        .out<TriangleMesh>("deviation",
                           "The mesh with the vertex column `distance-to-truth`, negative inside a truth that is a "
                           "closed mesh.",
                           by_name)
        .measures(MeasureSpec{"mesh", "truth", "deviation", "distance-to-truth"})
        .adds({"distance-to-truth"})
        .param("samples", &P::samples,
               "Number of points spread over the area of each mesh. Of a cloud, all points are used.",
               at_least(fewest_samples))
        .param("thresholds", &P::thresholds, "Distances that count as near for precision and recall.", above(0))
        .param("self-intersections", &P::self_intersections, "Whether pairs of intersecting triangles are counted.")
        .param("same-frame", &P::same_frame,
               "Asserts that unit and frame are equal. Sizes and positions that suggest otherwise then only cause a "
               "warning.")
        .choice("borders", &P::borders,
                {{"include", P::Borders::include, "These points count like all others."},
                 {"exclude", P::Borders::exclude, "These points are left out and counted in beyond-borders."}},
                "Whether points of a cloud count if their nearest point on the mesh is on its boundary.")
        .param("certify", &P::certify, "Computes certified bounds of the Hausdorff distance; needs a mesh as truth.")
        .param("gap", &P::gap,
               "Largest difference of the bounds, as a share of the upper bound. The search for `hausdorff` uses the "
               "same share.",
               above(0), below(1))
        .param("most-cuts", &P::most_cuts,
               "Largest number of cuts of triangle parts. After them, certify ends with the bounds reached so far.",
               at_least(1))
        .metric("hausdorff", Unit::length,
                "Largest distance in either direction: at samples, at vertices, and where a search finds it.", headline,
                smaller_is_better)
        .metric("chamfer", Unit::length, "Half the sum of the two directions' mean distances.", smaller_is_better)
        .metric("f-score", Unit::ratio, "2 P R / (P + R) of precision P and recall R at the threshold.", headline,
                numbered, larger_is_better)
        .metric("precision", Unit::ratio, "Share of the mesh's samples within the threshold of the truth.", numbered,
                larger_is_better)
        .metric("recall", Unit::ratio, "Share of the truth's samples within the threshold of the mesh.", numbered,
                larger_is_better)
        .metric("threshold", Unit::length,
                "Threshold distance of f-score, precision and recall, in the order of `thresholds`.", numbered);
    declare_distances(filter, "", "over both directions with equal weight");
    declare_distances(filter, "-to-truth", "from the mesh to the truth");
    declare_distances(filter, "-from-truth", "from the truth to the mesh");
    declare_distances(filter, "-to-points", "from the mesh to the nearest point of a truth of points");
    filter
        .metric("beyond-borders", Unit::count,
                "Points left out because their nearest point on the mesh is on its boundary.", smaller_is_better)
        .metric("normal-consistency", Unit::number,
                "Mean cosine between the normals of samples and of their nearest triangles.", larger_is_better)
        .metric("normal-consistency-unsigned", Unit::number, "Mean of the same cosines without their signs.",
                larger_is_better)
        .metric("without-normal", Unit::count,
                "Samples left out of normal-consistency because their nearest triangle has no normal.",
                smaller_is_better)
        .metric("hausdorff-lower", Unit::length, "Certified lower bound of the Hausdorff distance.", smaller_is_better)
        .metric("hausdorff-upper", Unit::length, "Certified upper bound of the Hausdorff distance.", smaller_is_better)
        .metric("certified", Unit::boolean, "1 if the bounds are as close as `gap` requires.", larger_is_better)
        .metric("cuts", Unit::count, "Parts of triangles that were cut for the bounds.")
        .metric("diagonal", Unit::length, "Diagonal of the bounding box of the mesh.")
        .metric("self-intersections", Unit::count, "Pairs of triangles of the mesh that intersect, touching included.",
                smaller_is_better);
    declare_mesh(filter, "", "of the mesh");
    declare_mesh(filter, "truth-", "of the truth");
    filter.run([](const Inputs& inputs, const P& params, Context& context) {
        const auto& mesh = inputs.get<TriangleMesh>("mesh");
        const auto* surface = inputs.find<TriangleMesh>("truth");
        const Measurement measured = surface ? measure(mesh, *surface, params, context)
                                             : measure(mesh, inputs.get<PointCloud>("truth"), params, context);
        const Metrics metrics = metrics_of(measured);
        for (const Metric& metric : metrics.values) context.metric(metric.name, metric.value, metric.unit);
        return Outputs().set("metrics", metrics).set("deviation", deviation_of(mesh, measured));
    });
    return filter;
}

}  // namespace

SCANMILL_FILTER() { return declaration(); }
