// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "icp/icp.hpp"

using namespace scanmill;

namespace {

IcpResult refined(const Inputs& inputs, const IcpParams& params, Context& context) {
    const auto& source = inputs.get<PointCloud>("source");
    if (const auto* mesh = inputs.find<TriangleMesh>("target")) return icp(source, *mesh, params, context);
    return icp(source, inputs.get<PointCloud>("target"), params, context);
}

}  // namespace

SCANMILL_FILTER() {
    using P = IcpParams;
    return Declare<P>("icp", 2)
        .summary("Finds the rigid motion that brings a scan, which is already near, onto a mesh or other points.")
        .source("Chen, Medioni 1992; Chetverikov et al. 2002; Gelfand et al. 2003")
        .ties(
            "Of equally near triangles, the one with the lower row counts; of equally near points, the lower one by x, "
            "then y, then z. Pairs with exactly the residual at which `trim` cuts count.")
        .not_finite(
            "Coordinates: refused, with their number and the first of them. Normals of the target: the point has no "
            "pairs.")
        .in<PointCloud>("source", "The scan that is moved. More than 50,000 points are represented by 50,000 of them.")
        .in<TriangleMesh, PointCloud>("target",
                                      "What stays: a mesh, or points with the column `normal` or without it. The scan "
                                      "should be within 2 % of the "
                                      "diagonal and 2 degrees of its pose on it.")
        .out<Transforms>("transform",
                         "From the frame of the source to that of the target; it never scales. Contains the `rms`.")
        .param("max-distance", &P::max_distance,
               "Points farther than this from the target have no pair; `auto` is 5 % of the smaller diagonal. Within "
               "it, the filter finds by itself which residuals are too large to count.",
               above(0), word("auto"))
        .param(
            "trim", &P::trim,
            "Share of the pairs that do not count in the last iterations, those with the largest residuals first. With "
            "0 %, all pairs count equally: least squares.",
            at_least(0), below(1))
        .param("max-iterations", &P::max_iterations,
               "Number of iterations after which the result is doubtful if it still moves.", at_least(1))
        .metric("rms", Unit::length, "Root mean square residual of the points that lie on the target.", headline,
                smaller_is_better)
        .metric(
            "overlap", Unit::ratio,
            "Share of the points that lie on the target: their residual is at most 4.685 standard deviations of the "
            "residuals; with `trim: 0 %`, at most max-distance.",
            headline, larger_is_better)
        .metric("iterations", Unit::count, "Iterations until no point moved by more than 1/10,000 of the spacing.")
        .metric("slide", Unit::number,
                "How well the surfaces determine the least determined direction of motion; below 0.002 they do not, "
                "and the result is doubtful.",
                headline, larger_is_better)
        .doubts({"less than 30 % of the source lies on the target",
                 "the surfaces slide: they do not determine all six directions of motion",
                 "the iterations end before the motion converges",
                 "half of the residuals are above 40 % of `max-distance`"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("transform", Transforms(refined(inputs, params, context).transform));
        });
}
