// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "cluster_mesh/cluster_mesh.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = ClusterMeshParams;
    return Declare<P>("cluster-mesh", 4)
        .summary("Inserts thinned points slice by slice into clusters and continues their mesh with each point.")
        .source("Sangveraphunsiri, Srirakulchai 2006, made robust")
        .ties(
            "Of equally near points or edges, the first along a space-filling curve through the box is used. Of "
            "duplicates, the first row is used.")
        .not_finite("Refused, with their number and the first of them.")
        .adds({"cluster-1", "cluster-2"})
        .in<PointCloud>("points", "Thinned points of even density. The column `bin-size` is used if it exists.")
        .made_by("voxel-thin")
        .out<TriangleMesh>("mesh",
                           "An oriented manifold over the used points, with all edges shorter than `max-edge`. Columns "
                           "contain the vertices' clusters of both levels. Closed components face outwards.")
        .param("max-edge", &P::max_edge,
               "Every edge is shorter, and points nearer to each other are in one cluster. Gaps narrower than this may "
               "be bridged. `auto` is 2.3 times the largest value of the column `bin-size`, and at least 2.5 times the "
               "median distance between neighbours.",
               above(0), word("auto"))
        .choice("axis", &P::axis,
                {{"x", P::Axis::x, "Planes of constant x."},
                 {"y", P::Axis::y, "Planes of constant y."},
                 {"z", P::Axis::z, "Planes of constant z."}},
                "The slicing planes are perpendicular to this axis.")
        .param("slice", &P::slice, "Distance between the slicing planes; `auto` is a quarter of `max-edge`.", above(0),
               word("auto"))
        .choice("in-plane", &P::in_plane,
                {{"paper", P::InPlane::paper, "By distance to the slicing plane."},
                 {"nearest", P::InPlane::nearest, "The point nearest to an inserted point comes next."}},
                "The order of the points of a slice.")
        .param("up", &P::up, "The direction that the first triangles face, and flat open components of the result.",
               size(3))
        .param("max-normal-angle", &P::max_normal_angle,
               "A triangle is created if the angle between its normal and that of the triangle that it continues is at "
               "most this. Smaller values ignore noise on smooth surfaces.",
               above(0), at_most(180))
        .param("neighbour-angle", &P::neighbour_angle,
               "Beyond `max-normal-angle`, the surface continues only if a neighbour of the continued triangle agrees "
               "within this angle.",
               above(0), at_most(180))
        .param("overlap-angle", &P::overlap_angle,
               "A point inside a triangle, seen along its normal, splits the triangle unless it is too high above it: "
               "higher than the longest edge times the tangent of this angle.",
               above(0), below(90))
        .metric("triangles", Unit::count, "Triangles of the mesh.", headline)
        .metric("components", Unit::count, "Connected components.")
        .metric("loops", Unit::count, "Boundary loops.", headline)
        .metric("boundary-edges", Unit::count, "Edges of all boundary loops.", smaller_is_better)
        .metric("unused-points", Unit::count, "Distinct points in no triangle.", headline, smaller_is_better)
        .metric("duplicates", Unit::count, "Points at the position of an earlier one.")
        .metric("max-edge", Unit::length, "The limit of the edges' lengths, given or derived.")
        .metric("clusters", Unit::count, "Clusters of level 1: points connected by steps shorter than `max-edge`.")
        .metric("case-1", Unit::count, "Points that joined a cluster of one point.")
        .metric("case-2", Unit::count, "Points far from all earlier points.")
        .metric("case-3", Unit::count, "Points near one point of a larger cluster.")
        .metric("case-4", Unit::count, "Points near several points of a cluster.")
        .metric("splits", Unit::count, "Points that split a triangle.")
        .metric("extra", Unit::count, "Points that waited because the nearest edge is too sharp.")
        .metric("closed-holes", Unit::count, "Small and narrow loops that were closed.")
        .metric("removed-triangles", Unit::count,
                "Triangles removed again, where a vertex had several fans, to close a hole, or for intersections.")
        .metric("flips", Unit::count, "Edges flipped in the end.")
        .doubts({"more than 2 % of the points are in no triangle", signs_of_doubtful_surface})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("mesh", cluster_mesh(inputs.get<PointCloud>("points"), params, context).mesh);
        });
}
