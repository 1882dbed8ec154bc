// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The scanned surface, a mesh or a shape. It gives the first hits of the rays of a view.

#include <functional>
#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "virtual_scan/view.hpp"
#include "virtual_scan/virtual_scan.hpp"

namespace scanmill::scan {

/// The first point of the surface on a ray.
struct Hit {
    Vec3 position;
    Vec3 normal;  ///< unit length, turned to the sensor
};

struct Scene {
    Frame frame;
    BoundingBox box;
    /// Points whose convex hull contains the surface.
    std::vector<Vec3> hull;
    /// The reference of relative lengths.
    LengthScale scale;
    /// Returns the hits of all rays, row by row from the lowest, each row from left to right. Rays that miss the
    /// surface give no hit. Thread-safe.
    std::function<std::vector<Hit>(const View&)> hits;
};

/// The supported range of scans, in the scan's unit.
constexpr double least_size = 1e-9, largest_size = 1e9;

/// Makes a scene of a mesh, which it references. Throws Error for a mesh that cannot be scanned. See rasteriser.cpp.
Scene scene_of(const TriangleMesh& mesh);
/// Makes a scene of a shape. Throws Error for wrong dimensions. See shapes.cpp.
Scene scene_of(VirtualScanParams::Shape shape, std::span<const Length> size);

}  // namespace scanmill::scan
