// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What is scanned, a mesh or a shape, behind one question: what do the rays of a view meet first?

#include <functional>
#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "virtual_scan/view.hpp"
#include "virtual_scan/virtual_scan.hpp"

namespace scanmill::scan {

/// A ray's first meeting with the surface.
struct Hit {
    Vec3 position;
    Vec3 normal;  ///< unit length, turned to the sensor
};

struct Scene {
    Frame frame;
    BoundingBox box;
    /// The surface lies within their convex hull.
    std::vector<Vec3> hull;
    /// What relative lengths refer to.
    LengthScale scale;
    /// The hits of all rays, row by row from the lowest, each from left to right; rays that meet nothing give none.
    /// Callable from several threads.
    std::function<std::vector<Hit>(const View&)> hits;
};

/// Between them products of lengths stay finite, of any proportions: discriminants of quadrics hold the fourth power of
/// height over radius times the square of a length, ten sizes in all.
constexpr double least_size = 1e-30, largest_size = 1e30;

/// Refers to the mesh. Throws Error for a mesh that cannot be scanned. See rasteriser.cpp.
Scene scene_of(const TriangleMesh& mesh);
/// Throws Error for wrong sizes. See shapes.cpp.
Scene scene_of(VirtualScanParams::Shape shape, std::span<const Length> size);

}  // namespace scanmill::scan
