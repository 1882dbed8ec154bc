// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "voxel_thin/voxel_thin.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = VoxelThinParams;
    return Declare<P>("voxel-thin", 5)
        .summary("Keeps, in every voxel, the point nearest the voxel's centre.")
        .source("Wang 2006, chapter 3")
        .ties("Among points equally near a centre, the first is kept; a duplicate counts as a point.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"bin-size", "local-bin-size", "curvature-1", "curvature-2", "fit-error", "stands-for"})
        .in<PointCloud>("points", "Finite coordinates; every column is carried along.")
        .out<PointCloud>("points",
                         "The kept points, in input order. The column `bin-size` holds the edge of each point's voxel. "
                         "If the voxel size is derived, there are also `curvature-1`, `curvature-2`, `fit-error`, "
                         "`local-bin-size` and `stands-for` (the number of points in the voxel).")
        .param("bin-size", &P::bin_size, "Edge of a voxel; auto derives it from the tolerance.", word("auto"), above(0))
        .param("tolerance", &P::tolerance,
               "Largest distance between the scanned surface and a triangulation of the kept points. This and the "
               "parameters down to `guarantee` are used with `bin-size: auto`.",
               above(0), unless_given("bin-size"))
        .choice("rule", &P::rule,
                {{"minimum", P::Rule::minimum, "The smallest size that any point allows."},
                 {"quantile", P::Rule::quantile, "The size that all points but a small share allow."},
                 {"adaptive", P::Rule::adaptive,
                  "An octree whose leaves are as large as their points allow: fewer points in flat regions."}},
                "Rule by which the voxel size follows from the sizes that the points allow.")
        .param("quantile", &P::quantile, "Share of the points, those with the smallest sizes, whose sizes are ignored.",
               at_least(0), at_most(1))
        .param("neighbours", &P::neighbours,
               "Number of nearest points that determine the curvature at a point, itself not counted.", at_least(6),
               at_most(1000))
        .choice("origin", &P::origin,
                {{"nearest", LocalSurfaceParams::Origin::nearest, "The point itself."},
                 {"centroid", LocalSurfaceParams::Origin::centroid,
                  "The point nearest the centroid of the point and its neighbours: better at a scan's boundary."}},
                "The point that the fitted quadric passes through.")
        .choice("derivatives", &P::derivatives,
                {{"exact", P::Derivatives::exact, "The derivatives of the quadric."},
                 {"thesis", P::Derivatives::thesis,
                  "The coefficients of the quadric, as in Wang: voxels up to 1.4 times as large."}},
                "Values that are used as second derivatives of the surface.")
        .choice("guarantee", &P::guarantee,
                {{"centres", P::Guarantee::centres, "Between centres of adjacent voxels: voxels are twice as large."},
                 {"points", P::Guarantee::points, "Between any two points in adjacent voxels."}},
                "Distances that must be at most the edge length that the tolerance allows.")
        .param("min-points", &P::min_points,
               "Voxels with fewer points are noise and keep none; 1 keeps all voxels. With `rule: adaptive`, the "
               "points in basic voxels of edge `bin-size` are counted, before any voxel is divided or joined.",
               at_least(1))
        .param("margin", &P::margin,
               "The grid begins this far below the bounding box of the points that are not stray, along every axis.",
               at_least(0))
        .metric("bin-size", Unit::length, "Edge of a voxel, given or derived; in an octree, edge of a basic voxel.")
        .metric("kept", Unit::count, "Points kept.", headline)
        .metric("removed", Unit::count, "Points that are not kept.")
        .metric("noise", Unit::count,
                "Removed points whose voxels (in an octree, basic voxels) had fewer than min-points.")
        .metric("smallest-radius", Unit::length, "Smallest radius of principal curvature; not reported for a plane.")
        .metric("flat", Unit::count,
                "Points so flat that a tenth of the bounding box (without stray points) limits their voxels.")
        .metric("undetermined", Unit::count, "Points whose neighbours lie near a line and determine no curvature.")
        .metric("smallest-bin", Unit::length, "Smallest edge among octree leaves that hold several points.")
        .metric("largest-bin", Unit::length, "Largest edge among octree leaves that hold several points.")
        .doubts({"fewer than 100 of at least 10,000 points stay",
                 "more than 10 % of the points are in voxels that hold 1 % of them or more, as where one view is in "
                 "another unit"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", voxel_thin(inputs.get<PointCloud>("points"), params, context).points);
        })
        .run_streamed({"bin-size"}, [](const PointStream& scan, const P& params, Context& context) {
            return Outputs().set("points", voxel_thin(scan, params, context).points);
        });
}
