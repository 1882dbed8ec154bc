// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "voxel_thin/streamed_thin.hpp"
#include "voxel_thin/voxel_thin.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = VoxelThinParams;
    return Declare<P>("voxel-thin", 3)
        .summary("Keeps, in every voxel, the one point nearest the voxel's centre.")
        .source("Wang 2006, chapter 3")
        .ties("Of points equally near a centre the one that comes first stays; a duplicate is a point like any other.")
        .not_finite("Refused, with their number and the first of them.")
        .in<PointCloud>("points", "Finite coordinates; every column is carried along.")
        .out<PointCloud>(
            "points",
            "The kept points, in input order, each with the edge of its voxel in the column `bin-size`; when that is "
            "derived also `curvature-1`, `curvature-2`, `fit-error`, `local-bin-size` and `stands-for`, the "
            "number of points in the voxel.")
        .param("bin-size", &P::bin_size, "Edge of a voxel; auto derives it from the tolerance.", word("auto"), above(0))
        .param("tolerance", &P::tolerance,
               "Largest distance between the scanned surface and a triangulation of the kept points; for bin-size: "
               "auto, as all that follows up to guarantee.",
               above(0))
        .choice("rule", &P::rule,
                {{"minimum", P::Rule::minimum, "The least size that any place allows."},
                 {"quantile", P::Rule::quantile, "The size that all but a small share of the places allow."},
                 {"adaptive", P::Rule::adaptive,
                  "An octree whose leaves are as large as their points allow: flat regions keep fewer."}},
                "Which of the sizes that the places allow counts.")
        .param("quantile", &P::quantile, "The share of the places that may ask for smaller voxels.", at_least(0),
               at_most(1))
        .param("neighbours", &P::neighbours,
               "How many nearest other places, itself not counted, show the curvature at one.", at_least(6),
               at_most(1000))
        .choice("origin", &P::origin,
                {{"nearest", LocalSurfaceParams::Origin::nearest, "The point itself."},
                 {"centroid", LocalSurfaceParams::Origin::centroid,
                  "Of it and its neighbours the one nearest their centroid: better at rims."}},
                "Which point the fitted quadric goes through.")
        .choice(
            "derivatives", &P::derivatives,
            {{"exact", P::Derivatives::exact, "Those of the quadric."},
             {"thesis", P::Derivatives::thesis, "Its coefficients, as Wang has it: bins up to 1.4 times as large."}},
            "What is taken for the second derivatives of the surface.")
        .choice("guarantee", &P::guarantee,
                {{"centres", P::Guarantee::centres, "Between centres of voxels that touch: bins twice as large."},
                 {"points", P::Guarantee::points, "Between any two points in voxels that touch."}},
                "Where distances must not exceed the edge length that the tolerance allows.")
        .param("min-points", &P::min_points,
               "Voxels with fewer points are noise and keep none; 1 keeps all voxels. With `rule: adaptive` these are "
               "the basic voxels of edge `bin-size`, before any is divided.",
               at_least(1))
        .param("margin", &P::margin, "The grid begins this far below the bounding box, along every axis.", at_least(0))
        .metric("bin-size", Unit::length, "Edge of a voxel, given or derived; of an octree that of its basic leaves.")
        .metric("kept", Unit::count, "Points kept.", headline)
        .metric("removed", Unit::count, "Points that gave way to a nearer one of their voxel, or were noise.")
        .metric("noise", Unit::count,
                "Removed points whose voxels (of an octree the basic ones) had fewer than min-points.")
        .metric("smallest-radius", Unit::length, "Of the principal curvatures' radii the least; none on a plane.")
        .metric("flat", Unit::count, "Places so flat that a tenth of the bounding box bounds their voxels.")
        .metric("undetermined", Unit::count, "Places whose neighbours lie near lines and show no curvature.")
        .metric("smallest-bin", Unit::length, "Of an octree's leaves with several points the smallest edge.")
        .metric("largest-bin", Unit::length, "Of an octree's leaves with several points the largest edge.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", voxel_thin(inputs.get<PointCloud>("points"), params, context).points);
        })
        .run_streamed({"bin-size"}, [](const PointStream& scan, const P& params, Context& context) {
            return Outputs().set("points", voxel_thin(scan, params, context).points);
        });
}
