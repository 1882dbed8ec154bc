// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/plugin.hpp"
#include "voxel_thin/voxel_thin.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = VoxelThinParams;
    return Declare<P>("voxel-thin", 1)
        .summary("Keeps, in every voxel, the one point nearest the voxel's centre.")
        .source("Wang 2006, chapter 3")
        .ties("Of points equally near a centre the one that comes first stays; a duplicate is a point like any other.")
        .not_finite("Refused, with their number and the first of them.")
        .in<PointCloud>("points", "Finite coordinates; every column is carried along.")
        .out<PointCloud>("points", "The kept points, in input order.")
        .param("bin-size", &P::bin_size, "Edge of a voxel.", required, above(0))
        .param("min-points", &P::min_points, "Voxels with fewer points are noise and keep none; 1 keeps all voxels.",
               at_least(1))
        .param("margin", &P::margin, "The grid begins this far below the bounding box, along every axis.", at_least(0))
        .metric("bin-size", Unit::length, "Edge of a voxel, resolved.")
        .metric("kept", Unit::count, "Points kept.", headline)
        .metric("removed", Unit::count, "Points that gave way to a nearer one of their voxel, or were noise.")
        .metric("noise", Unit::count, "Removed points whose voxels had fewer than min-points.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            context.metric("bin-size", params.bin_size.value(), Unit::length);
            return Outputs().set("points", voxel_thin(inputs.get<PointCloud>("points"), params, context).points);
        });
}
