// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "region_grow/region_grow.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = RegionGrowParams;
    return Declare<P>("region-grow", 5)
        .summary(
            "Grows a surface over thinned points from a seed triangle, and tells its borders, holes and sharp edges.")
        .source("Wang 2006, chapter 4, made robust; points chosen by empty circles after Delaunay")
        .ties(
            "Of equally good points the one that comes first along a curve through the box; of duplicates the first, "
            "with the least bin and normal.")
        .not_finite("Refused, with their number and the first of them; normals are replaced instead.")
        .in<PointCloud>("points",
                        "Thinned: of even density, at least locally. Columns `normal` and `bin-size` are used.")
        .made_by("voxel-thin")
        .out<TriangleMesh>("mesh", "An oriented manifold over the points used, with its sharp edges.")
        .out<FeatureGraph>("features",
                           "Outer boundaries, holes and creases with the normals on both sides, and corners.")
        .param("min-angle", &P::min_angle, "No triangle of the first pass has a smaller angle.", at_least(0), below(60))
        .param("max-normal-angle", &P::max_normal_angle,
               "Between a triangle's normal and that of each one it joins; smaller values end patches at sharp edges.",
               above(0), at_most(180))
        .param(
            "search-radius", &P::search_radius,
            "How far an edge looks for its next point; holes wider than two thirds of it stay open. `auto` is 2 "
            "sqrt(3) times the bin size that voxel-thin left in the column `bin-size`; where there is none, or points "
            "lie otherwise, that which the local density tells.",
            above(0), word("auto"))
        .param("sharp-angle", &P::sharp_angle, "Edges that bend by more are creases.", at_least(0), at_most(180))
        .param("close-holes", &P::close_holes,
               "Loops of at most so many edges are closed, and longer ones, up to 100 edges, too narrow for a hole; 0 "
               "closes none.",
               at_least(0), at_most(100))
        .choice("score", &P::score,
                {{"circumradius", P::Score::circumradius, "The point whose circle with the edge holds no other point."},
                 {"midpoint", P::Score::midpoint, "The point nearest the edge's middle: the thesis's rule."}},
                "Which of the suitable points an edge takes.")
        .param("start", &P::start,
               "Row of the point that the seed triangle starts at; `auto` takes the flattest place.", word("auto"))
        .metric("triangles", Unit::count, "Triangles of the mesh.", headline)
        .metric("components", Unit::count, "Connected pieces.")
        .metric("loops", Unit::count, "Boundary loops.", headline)
        .metric("holes", Unit::count, "Of these, such as go round a hole.")
        .metric(
            "thin-loops", Unit::count,
            "Loops where two sides are nearer to each other than three bins, so that the surface may go on there; not "
            "counted with a `search-radius`, nor where given normals tell the sides.")
        .metric("unused-points", Unit::count, "Distinct points in no triangle: noise, or too near others.", headline)
        .metric("duplicates", Unit::count, "Points that repeat the place of an earlier one.")
        .metric("known-bins", Unit::count, "Distinct points whose search radius follows from the column `bin-size`.")
        .metric("patch-edges", Unit::count, "Border edges beyond which the surface goes on at too large an angle.")
        .metric("creases", Unit::count, "Chains of sharp edges.")
        .metric("corners", Unit::count, "Vertices where feature lines meet or turn.")
        .metric("closed-holes", Unit::count, "Small and narrow loops that were closed.")
        .metric("removed-triangles", Unit::count,
                "Triangles taken off again where a vertex had several fans, or to close a hole.")
        .metric("ambiguous", Unit::count, "Loops told apart by their length, as their area does not tell.")
        .metric("without-area", Unit::count, "Triangles without area, counted to a neighbour's plane.")
        .metric("relaxed-triangles", Unit::count, "Triangles formed under relaxed limits.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            RegionGrowResult result = region_grow(inputs.get<PointCloud>("points"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("features", std::move(result.features));
        });
}
