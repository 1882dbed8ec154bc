// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A simulated scanner: points on a known surface, as seen from given views, with the flaws of real scans.
///
/// Every view casts parallel rays on a square grid. The first hit of a ray gives one point, so occlusion is exact. Both
/// sides of a surface reflect; of a closed mesh only the outside is ever hit.

#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct VirtualScanParams {
    enum class Shape {
        none,
        sphere,
        torus,
        box,
        cylinder,
        l_block,
        holed_block,
        hyperboloid,
        bicone,
        cone_on_hemisphere
    };
    /// The surface to scan if there is no mesh. Rays are intersected with it by formula, not with a mesh of it.
    Shape shape = Shape::none;
    /// The shape's dimensions in the scan's own unit. If empty, the defaults in brackets are used.
    /// - sphere: radius [1]; around 0.
    /// - torus: distance from the z axis to the tube's centre, radius of the tube [1, 0.4]; around 0.
    /// - box: x, y, z [1, 1, 1]; around 0.
    /// - cylinder: radius, height along z [0.5, 1]; around 0.
    /// - l_block: size s, thickness t [1, 1]; [0, 2 s]² × [0, t] without the quadrant above s in x and y.
    /// - holed_block: x, y, z, radius of the large hole, radius of the small ones [0.88, 0.95, 0.41, 0.21, 0.05]; a box
    ///   around 0 with five holes through it along z. The large hole is in the middle, the four small ones at (± 0.35
    ///   x, ± 0.35 y).
    /// - hyperboloid: radius r, height h [1, 0.75]; the open surface z = h / r √(x² − y² + r²) above the disc of radius
    ///   r around 0.
    /// - bicone: radius r, height h [1, 1]; two cones of height h on both sides of the disc of radius r around 0 in z =
    ///   0. Its edge has the interior angle 2 atan(h / r).
    /// - cone_on_hemisphere: radius r, height h [1, 0.5]; a cone of height h on this disc, and half of a sphere below
    ///   it. Its edge has the interior angle 90 deg + atan(h / r).
    std::vector<Length> size;
    /// One whole number n: n directions spread evenly over the sphere (1 looks along the x axis). Otherwise three
    /// numbers per view: the direction from the object to the sensor, of any length.
    std::vector<double> views = {12};
    /// Distance between neighbouring rays; above 0.
    Length resolution = Length::percent_of_diagonal(0.5);
    /// Standard deviation of the normally distributed error along the ray.
    Length noise;
    /// Number of outliers, as a share of the surface points. They lie anywhere in the bounding box, enlarged by a tenth
    /// on all sides.
    Ratio outliers = Ratio::percent(0);
    /// Share that is kept of the points that an earlier view has already seen. A point has been seen if a kept point of
    /// an earlier view is nearer than `resolution`, before noise. 100 %: views are independent; 0 %: no two views
    /// overlap.
    Ratio overlap = Ratio::percent(100);
    /// Hits where ray and surface normal make a larger angle are dropped; above 0, at most 90 deg.
    Angle max_angle = Angle::degrees(80);
};

struct VirtualScanResult {
    /// The points view by view, each view row by row; outliers at the end. In the mesh's frame, or in a new one of
    /// unknown unit. Columns: `normal` (3 × f64): the surface's own, turned to the sensor; 0 0 0 for outliers. `view`
    /// (i32): the number of the view; −1 for outliers.
    PointCloud points;
    /// Unit vectors from the object to the sensor, one per view.
    std::vector<Vec3> directions;
    /// Number of rays cast, over all views.
    std::size_t rays = 0;
    std::size_t outliers = 0;
    /// Number of points that were left out because an earlier view had already seen them.
    std::size_t dropped = 0;
    /// `resolution` and `noise` in the scan's unit.
    double resolution = 0;
    double noise = 0;
};

/// Scans `mesh`, or `params.shape` if mesh is nullptr. Relative lengths refer to the scanned surface: `%diag` to its
/// bounding box, `spacing` to the mesh's median edge. Both may be given resolved.
///
/// A mesh needs no topology: triangle soups, holes and nested components are allowed. Triangles without area, or seen
/// edge on, are never hit. If two triangles are equally near, the one with the lower row is hit. Rays through a shared
/// edge or vertex never pass between triangles. Throws Error for
/// - a mesh and a shape, or neither;
/// - a mesh without triangles or without extent, with indices out of range, or with a NaN or infinite vertex;
/// - a wrong number of sizes or views, or a direction of length 0;
/// - a parameter out of its range, or a dimension of a shape, noise or resolution beyond the supported range;
/// - more than 2^28 rays, or a scan without points.
///
/// Deterministic: bytes depend on the seed, not on the number of threads; views are scanned in parallel.
/// Cost: time O(rays + pixels of the triangles' boxes), 48 bytes per point and, for meshes, 12 per ray of the views
///       under way.
/// Metrics: `points`, `outliers` and `dropped`.
VirtualScanResult virtual_scan(const TriangleMesh* mesh, const VirtualScanParams& params, Context& context);

}  // namespace scanmill
