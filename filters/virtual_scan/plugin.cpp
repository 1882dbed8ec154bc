// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "virtual_scan/virtual_scan.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = VirtualScanParams;
    return Declare<P>("virtual-scan", 1)
        .summary("Scans a mesh or a shape as a real scanner would: from views, with noise, outliers and hidden parts.")
        .source("z-buffer: Catmull 1974; edge functions: Pineda 1988")
        .ties("Where two triangles are equally near along a ray, the one with the lower row is hit.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"normal", "view"})
        .in<TriangleMesh>("mesh", "The surface to scan, of any topology; omit it to scan a shape.", optional)
        .out<PointCloud>("points", "The hits, view by view, with columns `normal` and `view`; outliers at the end.")
        .choice("shape", &P::shape,
                {{"none", P::Shape::none, "The mesh is scanned."},
                 {"sphere", P::Shape::sphere, "Around the origin; size: radius."},
                 {"torus", P::Shape::torus, "Around the z axis; size: radius of the ring, radius of its tube."},
                 {"box", P::Shape::box, "Around the origin; size: x, y, z."},
                 {"cylinder", P::Shape::cylinder, "Around the z axis; size: radius, height."},
                 {"l-block", P::Shape::l_block, "Three squares in an L; size: edge of a square, thickness."},
                 {"block-with-holes", P::Shape::holed_block,
                  "A box with a large hole through its middle and four small ones; size: x, y, z, the two radii."},
                 {"hyperboloid", P::Shape::hyperboloid,
                  "A saddle above a disc, part of a hyperboloid of one sheet; size: radius, height in the middle."},
                 {"bicone", P::Shape::bicone,
                  "Two cones with a common base: one circular edge of the angle 2 atan(height / radius); size: radius, "
                  "height of each."},
                 {"cone-on-hemisphere", P::Shape::cone_on_hemisphere,
                  "A cone on half of a sphere: one circular edge of the angle 90 deg + atan(height / radius); size: "
                  "radius, height of the cone."}},
                "The shape to scan if no mesh is given. Rays meet its exact surface, not triangles.")
        .param("size", &P::size, "The shape's dimensions in the scan's own unit; empty takes defaults around 1 u.",
               above(0))
        .param(
            "views", &P::views,
            "Number of views, evenly spread; or three numbers per view, the direction from the object to the sensor.")
        .param("resolution", &P::resolution, "Distance between neighbouring rays.", above(0))
        .param("noise", &P::noise, "Standard deviation of the error along the ray.", at_least(0))
        .param("outliers", &P::outliers,
               "Number of points anywhere in the enlarged bounding box, as a share of the surface points.", at_least(0),
               at_most(10))
        .param("overlap", &P::overlap, "Share that is kept of the points that an earlier view has already seen.",
               at_least(0), at_most(1))
        .param("max-angle", &P::max_angle, "Hits where ray and surface normal make a larger angle are dropped.",
               above(0), at_most(90))
        .metric("points", Unit::count, "Points of the scan, outliers included.", headline)
        .metric("outliers", Unit::count, "Points that are not on the surface.")
        .metric("dropped", Unit::count, "Points dropped because an earlier view had seen their position.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", virtual_scan(inputs.find<TriangleMesh>("mesh"), params, context).points);
        });
}
