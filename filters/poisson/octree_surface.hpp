// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The surface of oriented points by the Poisson equation on an octree, as PCL solves it.
///
/// Source: Kazhdan, Bolitho, Hoppe 2006, "Poisson surface reconstruction"; Kazhdan, Hoppe 2013, "Screened Poisson
/// surface reconstruction". The code is PCL's copy of Kazhdan's, version 4.

#include <functional>
#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct OrientedPoint {
    float x, y, z;
    float normal_x, normal_y, normal_z;  ///< of any length above 0, to the outside
};

struct OctreeSurface {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    /// Edge of the smallest cell that the octree may have, in the unit of the points.
    double cell;
};

/// Parameters are PCL's defaults, except `depth`, `scale`, and that the equation is solved and the surface extracted
/// without division into blocks, which changes nothing but the memory in use. The cube of the octree is centred on the
/// points' box, and `scale` times as large as its longest side; PCL's default is 1.1.
///
/// PCL's own class pcl::Poisson is not called, but the templates beneath it, compiled here without OpenMP: with it,
/// sums are added in the order in which threads arrive, and differ from run to run. They print to stdout; that is
/// turned off.
///
/// The surface is closed except where it leaves the cube, and at cracks of a few edges: where cells of different sizes
/// meet, PCL may omit one edge of a polygon.
///
/// Pre: at least 2 different positions; finite numbers; coordinates of magnitude 1, so that floats suffice.
/// `progress` is called between the stages with their share of the time, and may throw. Calls from several threads wait
/// for each other. Empty if there is no surface.
OctreeSurface octree_surface(std::span<const OrientedPoint> points, int depth, double scale,
                             const std::function<void(double share)>& progress);

}  // namespace scanmill
