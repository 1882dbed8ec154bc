// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "mesh_update/mesh_update.hpp"
#include "tight_cocone/parameters.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = MeshUpdateParams;
    auto filter = Declare<P>("mesh-update", 1);
    filter.summary("Replaces the parts of a closed mesh that were scanned again, and keeps all other vertices.")
        .source("Woo, Dey 2005")
        .ties(
            "Among equally near facets, that with the lowest row counts; among equally near vertices, the lowest. Ties "
            "of tight-cocone are those of that filter.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"source", "group", "replaced", "updated"})
        .in<TriangleMesh>("mesh", "The model: closed, a manifold, facing outwards.")
        .in<PointCloud>("points",
                        "Scans of the changed parts, registered with the model. Each overlaps the unchanged model "
                        "along its whole border.",
                        list)
        .out<TriangleMesh>("mesh",
                           "The updated mesh, with the vertex columns `source` (0: the model, j: cloud j), `group` "
                           "(of the model, from 1; -1 on overlap facets and for points of clouds) and `replaced`, and "
                           "the face column `updated` (1: not a triangle of the model).")
        .out<FeatureGraph>("features", "The loops where the clouds end.")
        .choice("rebuild", &P::rebuild,
                {{"whole", P::Rebuild::whole, "A closed surface through all points is made anew."},
                 {"local", P::Rebuild::local,
                  "Only the surroundings of the change are made anew; all other triangles keep their bytes."}},
                "How much of the mesh is made anew.")
        .param(
            "max-distance", &P::max_distance,
            "Border points of a cloud farther from the model lie on no facet of it. The spacing is the median edge of "
            "the model, or `density` spacings of the densest cloud if that is less.",
            above(0), takes_spacings)
        .choice("overlap", &P::overlap,
                {{"projected", P::Overlap::projected, "The facets under the border of a cloud."},
                 {"candidates", P::Overlap::candidates,
                  "Also all facets at the vertices nearest to border points: a thick border."}},
                "The facets that separate changed from unchanged parts.")
        .param("angle-gap", &P::angle_gap,
               "Least difference between the mean angles of the group that is replaced and the group that is kept.",
               at_least(0), at_most(90))
        .param("trim", &P::trim,
               "Vertices at the border that are nearer to a point of the cloud are discarded; in local spacings of the "
               "cloud.",
               at_least(0))
        .param("density", &P::density,
               "Longer edges of the model are split before the update; in spacings of the densest cloud.", above(0))
        .choice("on-doubt", &P::on_doubt,
                {{"fail", P::OnDoubt::fail, "The step fails, with the reason."},
                 {"keep", P::OnDoubt::keep, "The model is returned unchanged, with the reason as a warning."}},
                "What happens if the scans do not decide what to replace.");
    tight_cocones::declare_noise(filter);
    return filter.metric("updated", Unit::boolean, "Whether the model was updated.", headline)
        .metric("initial", Unit::count, "Vertices of the model.")
        .metric("resampled", Unit::count, "Vertices added by splitting long edges of the model.")
        .metric("added", Unit::count, "Points of all clouds.")
        .metric("discarded", Unit::count, "Vertices of the model that were discarded, those of split edges included.")
        .metric("kept", Unit::count, "Vertices of the model that were kept, those of split edges included.")
        .metric("unused-points", Unit::count, "Kept vertices and added points that are not on the surface.",
                smaller_is_better)
        .metric("groups", Unit::count, "Groups into which the borders of the clouds divide the model.")
        .metric("replaced", Unit::count, "Groups that were replaced.", headline)
        .metric("mean-angle", Unit::angle,
                "Mean angle between a cloud and a group at its border; by cloud, then by group.", numbered)
        .metric("angle-cloud", Unit::count, "Number of the cloud of each mean angle.", numbered)
        .metric("angle-group", Unit::count, "Number of the group of each mean angle.", numbered)
        .metric("angle-replaced", Unit::boolean, "Whether the group of each mean angle was replaced.", numbered)
        .metric("area", Unit::area, "Area of the triangles with a point of a cloud, of each change.", numbered)
        .metric("volume-added", Unit::volume, "Volume inside the result and outside the model, of each change.",
                numbered, headline)
        .metric("volume-removed", Unit::volume, "Volume inside the model and outside the result, of each change.",
                numbered, headline)
        .metric("deviation", Unit::length, "Largest distance of a new point from the model, of each change.", numbered)
        .metric("deviation-x", Unit::length, "World coordinate x of that point.", numbered)
        .metric("deviation-y", Unit::length, "World coordinate y of that point.", numbered)
        .metric("deviation-z", Unit::length, "World coordinate z of that point.", numbered)
        .metric("change-cloud", Unit::count, "Number of the cloud of that point.", numbered)
        .metric("remeshed", Unit::count,
                "New triangles without a point of a cloud: vertices of the model, joined anew.", smaller_is_better)
        .metric(
            "far-surface", Unit::ratio,
            "Share of the new surface that is farther than a spacing of the cloud from the clouds and from what was "
            "kept.",
            smaller_is_better)
        .metric("loops", Unit::count, "Border loops of the clouds that were used.")
        .metric("border-offset", Unit::length,
                "Median distance of border points from the model, the largest of the loops of each cloud.", numbered,
                smaller_is_better)
        .metric("ignored-loops", Unit::count, "Border loops that are small or do not lie on the model.")
        .metric("boundary-edges", Unit::count, "Edges of the clouds' surfaces in one triangle.")
        .metric("paper-edges", Unit::count, "Edges of the clouds' surfaces between two boundary points of cocone.")
        .metric("boundary-seconds", Unit::seconds, "Time to find the borders of the clouds.")
        .metric("model-seconds", Unit::seconds, "Time to split long edges and build the search tree of the model.")
        .metric("overlap-seconds", Unit::seconds, "Time to find the overlap facets.")
        .metric("segmentation-seconds", Unit::seconds, "Time to find the groups and choose those to replace.")
        .metric("reconstruction-seconds", Unit::seconds, "Time to make the new surface.")
        .doubts({"the topology is not that of the kept parts joined with the surfaces of the clouds",
                 "more than 5 % of the clouds' points are not on the surface (not with `noise: big-balls`)",
                 "more than 1 % of the new surface is farther than a spacing from the clouds and from what was kept"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            MeshUpdateResult result =
                mesh_update(inputs.get<TriangleMesh>("mesh"), inputs.list<PointCloud>("points"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("features", std::move(result.features));
        });
}
