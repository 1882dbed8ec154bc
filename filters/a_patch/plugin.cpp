// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "a_patch/a_patch.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = APatchParams;
    using a_patches::Curvature;
    using a_patches::Split;
    return Declare<P>("a-patch", 9)
        .summary("Spans an implicit surface over a mesh: cubic patches, smooth except at the mesh's sharp edges.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 5")
        .ties(
            "Among equally long edges, the one with the lower vertices is bisected first. Among equally acute edges, "
            "the one with the lower vertices becomes sharp.")
        .not_finite("Refused, with their number and the first of them.")
        .in<TriangleMesh>("mesh",
                          "A manifold, closed or open, oriented consistently. Its sharp edges become creases. Without "
                          "points, or with "
                          "`interpolate: yes`, its vertices lie on the surface. Its face column `corner-normals` gives "
                          "the normals at the vertices.")
        .in<PointCloud>("points",
                        "The scan. The surface is fitted to its points. They also give the normals at the vertices if "
                        "the mesh has no `corner-normals`.",
                        optional)
        .out<PatchComplex>("patches", "Tetrahedra on both sides of the mesh, each with the 20 weights of its cubic.")
        .choice("normals", &P::normals,
                {{"auto", P::Normals::automatic,
                  "`given` if the mesh has the column, else `points` if there are points, else `mesh`. With points and "
                  "`fit`, the normals are then turned so that the surface passes near the points."},
                 {"given", P::Normals::given, "The mesh's face column `corner-normals`."},
                 {"points", P::Normals::points, "Normals of quadrics fitted to the points near each vertex."},
                 {"mesh", P::Normals::mesh, "Mean normal of the triangles around each vertex."}},
                "Source of the normals at the vertices; they decide most of the surface's error.")
        .choice("split", &P::split,
                {{"always", Split::always, "Every triangle has three tetrahedra per side; the error is smaller."},
                 {"where-needed", Split::where_needed,
                  "A triangle has one tetrahedron per side, unless it cannot join its neighbours with equal gradients; "
                  "there are up to a third fewer tetrahedra."}},
                "Choice of the triangles whose tetrahedra are divided at a base point.")
        .param("fit", &P::fit, "Fits the surface to the points.")
        .choice("interpolate", &P::interpolate,
                {{"auto", P::Interpolate::automatic, "`no` if there are points and `normals` is `auto`, else `yes`."},
                 {"yes", P::Interpolate::yes,
                  "The surface passes through the vertices of the mesh. With `normals: auto` the normals are fitted "
                  "first, then "
                  "the edge gradients."},
                 {"no", P::Interpolate::no,
                  "Vertices, normals and edge gradients are fitted together, so that the surface bends little; before, "
                  "edges "
                  "are flipped and vertices moved for more even triangles. Vertices and normals at sharp edges stay."}},
                "Whether the surface of a fit passes through the given vertices.")
        .param("fairing", &P::fairing,
               "A factor on the weight of the surface's bending that the fit finds. Larger values make it smoother.",
               at_least(0))
        .param(
            "max-error", &P::max_error,
            "Largest distance between the surface and the points, in both directions. The fit bisects triangles with "
            "points beyond it, unless the surface passes through the vertices, but not for noise and single points. If "
            "the "
            "distance stays larger, the result is doubtful. `none`: any distance is accepted.",
            word("none"))
        .param("regularisation", &P::regularisation,
               "With `interpolate: yes`: smallest penalty on changes of the edge gradients, relative to the points. An "
               "edge "
               "gets a larger penalty if each half of the points near it then predicts the other half better.",
               at_least(1e-6), at_most(1))
        .choice(
            "curvature", &P::curvature,
            {{"distance", Curvature::distance, "The second derivative is 0: F grows like a distance."},
             {"mean", Curvature::mean, "The mean curvature of the triangle's quadric, which is exact for spheres."}},
            "Second derivative of F along the normal.")
        .param(
            "apex-factor", &P::apex_factor,
            "Height of the tetrahedra, as a multiple of the smallest possible height. Higher tetrahedra contain more "
            "of the space near the surface.",
            at_least(1.05), at_most(3))
        .metric("tetrahedra", Unit::count, "Tetrahedra of the result.", headline)
        .metric("inverted", Unit::count, "Tetrahedra that are inside out; always 0.")
        .metric("c1-jump", Unit::number,
                "Largest difference of the gradients where tetrahedra meet, except at sharp edges, as a share of the "
                "gradient.",
                headline, smaller_is_better)
        .metric("sign-violations", Unit::count, "Edges, and weights over triangles, that allow a second sheet.",
                smaller_is_better)
        .metric("refined", Unit::count,
                "Edges bisected because tetrahedra were inside out or too large, a crease left its edge, triangles "
                "were too "
                "coarse for the shape, or their points were beyond max-error.")
        .metric("split-faces", Unit::count, "Triangles with three tetrahedra per side.")
        .metric("creased-edges", Unit::count, "Edges made sharp, because the mesh is folded there.", smaller_is_better)
        .metric("smoothed-edges", Unit::count,
                "Sharp edges made smooth, because the surface has nearly one normal on both sides.", smaller_is_better)
        .metric("pointed-vertices", Unit::count,
                "Vertices beside which the surface is not smooth, because none fits: corners of flat triangles, and "
                "ends of open edges that are not sharp.",
                smaller_is_better)
        .metric("flat-triangles", Unit::count, "Triangles that are the surface, because no smooth surface fits there.",
                smaller_is_better)
        .metric("straight-edges", Unit::count,
                "Open edges: a narrow straight strip joins the surfaces of the two triangles, because no tetrahedra "
                "fit between them.",
                smaller_is_better)
        .metric("raised", Unit::count,
                "Control coefficients changed so that every line to an apex meets the surface once.")
        .metric("fit-rms", Unit::length, "Root of the mean squared distance of the points from the surface.", headline,
                smaller_is_better)
        .metric("fit-p95", Unit::length, "95 % quantile of the points' distances from the surface.", smaller_is_better)
        .metric("fit-max", Unit::length, "Largest distance of a point from the surface.", smaller_is_better)
        .metric("error", Unit::length,
                "With max-error: largest distance between the surface and all points, in both directions. That from "
                "the surface to the nearest point is less the distance of that point from its 6th neighbour.",
                smaller_is_better)
        .metric("beyond", Unit::count, "With max-error: points farther from the surface than that.", smaller_is_better)
        .metric("left-out", Unit::count, "Points in no tetrahedron; they are neither fitted nor measured.",
                smaller_is_better)
        .metric("crease-max", Unit::length,
                "Largest distance between a crease and the mesh's sharp edge; creases of round edges bulge.")
        .metric("regularisation", Unit::number, "With `interpolate: yes`: median over the edges of the penalty used.")
        .metric(
            "weight", Unit::number,
            "Weight of the bending that was used: the one that predicts each half of the points best from the other.")
        .metric("offset-rms", Unit::length, "Root of the mean squared way of the vertices in the fit, along normals.")
        .metric("offset-max", Unit::length, "Longest way of a vertex in the fit, along its normal.")
        .metric("turned", Unit::count, "Normals turned because they opposed a triangle.")
        .metric("flips", Unit::count, "Edges flipped for more even triangles.")
        .doubts({"there are points, and more than 10 % of the vertices have none near them",
                 "more than 50 % of the points are in no tetrahedron near the surface",
                 "the points are farther from the surface than from the mesh (rms)",
                 "the surface follows the mesh at more than 10 % of the vertices, because no smooth surface fits there",
                 "points are farther than `max-error` from the surface, or the surface from them",
                 "parts of the surface intersect, or the mesh is inside out"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set(
                "patches",
                a_patch(inputs.get<TriangleMesh>("mesh"), inputs.find<PointCloud>("points"), params, context).patches);
        });
}
