// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "decimate/decimate.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = DecimateParams;
    return Declare<P>("decimate", 6)
        .summary("Removes vertices while the surface stays within a distance, and proves the distance.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 4")
        .ties(
            "Among equal estimates, the vertex with the lower number is removed first. Among equally good "
            "triangulations of a hole, the first is taken.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"class", "corner-normals", "error-outside", "error-inside"})
        .in<TriangleMesh>("mesh",
                          "A manifold, closed or open, oriented consistently. Its declared sharp edges are features, "
                          "like the edges that are sharp by their angle.")
        .in<PointCloud>("points",
                        "Data points that the result must stay near, besides the mesh's vertices. Give the scan if "
                        "thinning or sculpting left points off the mesh.",
                        optional)
        .out<TriangleMesh>("mesh",
                           "Vertices of the input, with their columns and `class` (0 smooth, 1 crease, 2 corner, 3 "
                           "boundary); triangles with `corner-normals`, `error-outside` and `error-inside`; the sharp "
                           "edges.")
        .param("max-error", &P::max_error, "Largest distance between the input and the result, in both directions.",
               at_least(0))
        .param("outside", &P::outside, "Replaces max-error where the input is outside the result.", at_least(0))
        .param("inside", &P::inside, "Replaces max-error where the input is inside the result.", at_least(0))
        .choice("mode", &P::mode,
                {{"direct", DecimateMode::direct,
                  "Errors are measured to the input mesh, and to the points if there are any."},
                 {"accumulated", DecimateMode::accumulated,
                  "As in the paper, two error bounds per triangle grow with every removal. More triangles are left "
                  "than with `direct`."}},
                "How the errors that limit removals are measured. The certificate does not depend on this choice.")
        .param("sharp-angle", &P::sharp_angle,
               "An edge is sharp if the normals of its triangles differ by more than this.", at_least(20), at_most(75))
        .param("corner-angle", &P::corner_angle, "A vertex where a feature line turns by more than this is a corner.",
               at_least(0), at_most(180))
        .param("noise", &P::noise,
               "Standard deviation of the vertices' distances from the true surface. Where triangles are too small for "
               "this noise, creases are found by the normals of neighbourhoods. `auto` estimates the noise; with 0, "
               "every edge is judged by its triangles.",
               at_least(0), word("auto"))
        .param("normal-deviation", &P::normal_deviation,
               "Largest angle between the normal of a new triangle and the mean normal of those it replaces.",
               at_least(0), at_most(89))
        .param("min-angle", &P::min_angle,
               "Least angle of a new triangle, unless a replaced triangle has a smaller one; on flat faces 5 degrees "
               "suffice. A larger value gives better-shaped triangles, but more of them.",
               at_least(0), at_most(30))
        .param("max-valence", &P::max_valence,
               "A vertex with more edges than this is not removed, and no vertex gets more.", at_least(6), at_most(64))
        .param("target-triangles", &P::target_triangles,
               "Removal stops when at most this many triangles are left; max-error may stop it earlier. 0: no target.",
               at_least(0))
        .param("final-flips", &P::final_flips,
               "Whether edges are flipped, within the same limits, to raise the triangles' least angles.")
        .metric("triangles", Unit::count, "Triangles of the result.", headline)
        .metric("removed", Unit::count, "Vertices removed.")
        .metric("flips", Unit::count, "Edges flipped.")
        .metric("hausdorff-lower", Unit::length, "Lower bound of the distance between the input and the result.",
                smaller_is_better)
        .metric(
            "hausdorff-upper", Unit::length,
            "Upper bound of the distance between the input and the result; the filter fails if it exceeds max-error.",
            headline, smaller_is_better)
        .metric("certified", Unit::boolean, "Whether the upper bound is proven to be within max-error: always 1.",
                larger_is_better)
        .metric("creases", Unit::count, "Lines of sharp edges, from corner to corner or closed.")
        .metric("corners", Unit::count, "Vertices of class corner.")
        .metric("points-max", Unit::length, "Largest distance from a point of the input `points` to the result.",
                smaller_is_better)
        .metric("points-beyond", Unit::count,
                "Number of points of the input `points` that are farther than max-error from the result.",
                smaller_is_better)
        .simplifies(SimplifySpec{"mesh", "target-triangles", "max-error"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            const PointCloud* points = inputs.find<PointCloud>("points");
            return Outputs().set("mesh", decimate(inputs.get<TriangleMesh>("mesh"), points, params, context).mesh);
        });
}
