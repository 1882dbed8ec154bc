// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "a_patch/a_patch.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = APatchParams;
    using a_patches::Curvature;
    using a_patches::Split;
    return Declare<P>("a-patch", 7)
        .summary("Spans an implicit surface over a mesh: cubic patches, smooth except at the mesh's sharp edges.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 5")
        .ties(
            "Among equally long edges, the one with the lower vertices is bisected first. Among equally acute edges, "
            "the one with the lower vertices becomes sharp.")
        .not_finite("Refused, with their number and the first of them.")
        .in<TriangleMesh>(
            "mesh",
            "A manifold, closed or open, oriented consistently. Its vertices lie on the surface, and its sharp edges "
            "become creases. Its face column `corner-normals` gives the normals at the vertices.")
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
        .param("fit", &P::fit, "Fits normals (with `normals: auto`) and edge gradients to the points.")
        .param("fairing", &P::fairing,
               "Weight of the surface's fairness relative to its distance from the points; at 1 both weigh about the "
               "same.",
               at_least(0))
        .param(
            "regularisation", &P::regularisation,
            "Smallest penalty on changes of the edge gradients, relative to the points. An edge gets a larger penalty "
            "if each half of the points near it then predicts the other half better.",
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
                "Edges bisected because tetrahedra were inside out or too large, or a crease left its edge.")
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
        .metric("left-out", Unit::count, "Points in no tetrahedron; they are neither fitted nor measured.",
                smaller_is_better)
        .metric("crease-max", Unit::length,
                "Largest distance between a crease and the mesh's sharp edge; creases of round edges bulge.")
        .metric("regularisation", Unit::number, "Median over the edges of the penalty used.")
        .metric("fairness-before", Unit::number,
                "Sum over the edges of the squared difference between the edge's gradient and that of the triangles' "
                "quadrics, before fitting and fairing.")
        .metric("fairness-after", Unit::number, "The same sum as `fairness-before`, for the result.", smaller_is_better)
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set(
                "patches",
                a_patch(inputs.get<TriangleMesh>("mesh"), inputs.find<PointCloud>("points"), params, context).patches);
        });
}
