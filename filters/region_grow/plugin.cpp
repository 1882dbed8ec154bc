// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "region_grow/region_grow.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = RegionGrowParams;
    return Declare<P>("region-grow", 11)
        .summary("Grows a surface over thinned points from a seed triangle; finds boundaries, holes and sharp edges.")
        .source("Wang 2006, chapter 4, made robust; points chosen by empty circles after Delaunay")
        .ties(
            "Among equally good points, the first along a space-filling curve through the box is used. Duplicates "
            "count as the first row, with the smallest bin-size and the first normal by x, y, z. Of crossing segments "
            "of "
            "equal uncertainty, the later one yields.")
        .not_finite(
            "Coordinates: refused; the message gives their number and the first one. Normals: replaced by those of the "
            "neighbourhood.")
        .in<PointCloud>(
            "points", "Thinned points, of even density at least locally. The columns `normal` and `bin-size` are used.")
        .made_by("voxel-thin")
        .in<FeatureGraph>("lines",
                          "Measured edge lines. Their segments become sharp edges of the mesh, whatever the scan says "
                          "nearby; long ones are divided.",
                          optional, by_name)
        .out<TriangleMesh>("mesh", "An oriented manifold over the points used, with its sharp edges.")
        .out<FeatureGraph>("features",
                           "Outer boundaries, holes and creases with the normals on both sides, and corners.")
        .param("min-angle", &P::min_angle, "No triangle of the first pass has a smaller angle.", at_least(0), below(60))
        .param("max-normal-angle", &P::max_normal_angle,
               "Largest angle between the normals of triangles that share an edge; smaller values end patches at sharp "
               "edges.",
               above(0), at_most(180))
        .param("search-radius", &P::search_radius,
               "Distance within which an edge looks for its next point; holes wider than two thirds of it stay open. "
               "`auto` is 2 sqrt(3) times the column `bin-size` of voxel-thin. Without the column, or where the "
               "density contradicts it, `auto` is 2 sqrt(3) times the voxel size that matches the local density.",
               above(0), word("auto"))
        .param("sharp-angle", &P::sharp_angle,
               "An edge is a crease if the normals of its triangles differ by more than this.", at_least(0),
               at_most(180))
        .param("noise", &P::noise,
               "Standard deviation of the points' distances from the surface; `auto` estimates it. Where triangles are "
               "too small for the noise, creases are found by the normals of neighbourhoods.",
               at_least(0), word("auto"))
        .param("close-holes", &P::close_holes,
               "Loops of at most this many edges are closed. Longer loops, up to 100 edges, are closed if they are too "
               "narrow for a hole. 0 closes none.",
               at_least(0), at_most(100))
        .choice("score", &P::score,
                {{"circumradius", P::Score::circumradius, "The point whose circle with the edge is empty."},
                 {"midpoint", P::Score::midpoint, "The point nearest the edge's midpoint, as in Wang."}},
                "Rule by which an edge chooses among its suitable points.")
        .param("start", &P::start, "Row of the point where the seed triangle starts; `auto` is the flattest point.",
               word("auto"))
        .metric("triangles", Unit::count, "Triangles of the mesh.", headline)
        .metric("components", Unit::count, "Connected components.")
        .metric("loops", Unit::count, "Boundary loops.", headline)
        .metric("holes", Unit::count, "Boundary loops around holes.")
        .metric("thin-loops", Unit::count,
                "Loops where two sides are less than three voxels apart, so that the surface may continue there. They "
                "are not counted with a given `search-radius`, nor where given normals distinguish the sides.",
                smaller_is_better)
        .metric("unused-points", Unit::count, "Distinct points in no triangle, because of noise or layers.", headline,
                smaller_is_better)
        .metric("duplicates", Unit::count, "Points at the position of an earlier point.")
        .metric("known-bins", Unit::count, "Distinct points whose search radius follows from the column `bin-size`.")
        .metric("patch-edges", Unit::count, "Boundary edges beyond which the surface continues at too large an angle.",
                smaller_is_better)
        .metric("creases", Unit::count, "Chains of sharp edges.")
        .metric("corners", Unit::count, "Vertices where feature lines meet or turn.")
        .metric("noise", Unit::length, "Standard deviation of the points' distances from the surface.")
        .metric("closed-holes", Unit::count, "Small and narrow loops that were closed.")
        .metric("removed-triangles", Unit::count,
                "Triangles removed again, because a vertex had several fans or to close a hole.")
        .metric("ambiguous", Unit::count,
                "Loops that are classified by their length, because their area does not decide.", smaller_is_better)
        .metric("without-area", Unit::count, "Triangles without area, assigned to a neighbour's plane.",
                smaller_is_better)
        .metric("relaxed-triangles", Unit::count, "Triangles formed under relaxed limits.")
        .metric("lines", Unit::count, "Segments of `lines` that are edges of the mesh, divided ones in parts.")
        .metric("near-lines", Unit::count, "Scan points left out because a segment of `lines` is near.")
        .metric("unsupported", Unit::count, "Segments of `lines` without scan points near them, left out.",
                smaller_is_better)
        .metric("crossing", Unit::count, "Segments of `lines` left out because they cross a more certain one.",
                smaller_is_better)
        .metric("missing-lines", Unit::count, "Segments of `lines` that the surface does not contain.",
                smaller_is_better)
        .doubts({"more than 2 % of the points are in no triangle",
                 "there is more than one crease per 20 edges (of more than 10,000), as on noisy scans",
                 "boundary loops lie where the object is thinner than three voxels",
                 "normals reverse within the surface", "segments of `lines` are missing in the mesh"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            const auto& points = inputs.get<PointCloud>("points");
            const auto* lines = inputs.find<FeatureGraph>("lines");
            RegionGrowResult result =
                lines ? region_grow(points, *lines, params, context) : region_grow(points, params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("features", std::move(result.features));
        });
}
