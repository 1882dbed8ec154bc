// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "register/registered_clouds.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = RegisterParams;
    return Declare<P>("register", 2)
        .summary("Finds one motion per view that brings views without poses into one frame.")
        .source(
            "Rusu, Blodow, Beetz 2009; Chen, Sun, Yang, Tao 2022; Chen, Medioni 1992; Huber, Hebert 2003 for the views "
            "that contradict each other")
        .ties("Of equal scores, the pair of the views with fewer points counts, then the one with lower coordinates.")
        .not_finite("Refused; the message gives the view, their number and the first one.")
        .in<PointCloud>("points",
                        "The views, each in a frame of its own. The side of the scanner is that of the column "
                        "`approach`, else of `normal`; without both it is found in the points, with a warning.",
                        list)
        .in<TriangleMesh, PointCloud>(
            "target",
            "A mesh or points that stay, such as a CAD model: `points` is then one scan, from one side or all sides.",
            optional, by_name)
        .out<Transforms>("transform",
                         "One motion per placed view, into the frame of the first placed view or of the target; it "
                         "never scales. With the "
                         "refused views and the accepted pairs.")
        .param("overlap", &P::overlap, "Smallest share of the points that two views must have in common.", above(0),
               at_most(1))
        .param(
            "resolution", &P::resolution,
            "Edge of the voxels to which views are reduced; `auto` is 4 spacings, or a tenth of the size of a view if "
            "that is larger. Poses are refined with all points.",
            above(0), word("auto"))
        .param("poses", &P::poses,
               "A Stanford .conf or a JSON file with the poses of the views; they are taken as they are. A view that "
               "fits the others better elsewhere makes the result doubtful.",
               word("none"))
        .param(
            "start", &P::start,
            "A Stanford .conf or a JSON file with poses to begin with; they are refined and tested, and a wrong one is "
            "refused. With a target, the pose decides between others that fit equally well.",
            word("none"))
        .param("as-is", &P::as_is,
               "Whether views that are already in one frame are only tested; if nothing contradicts their poses, they "
               "keep them.")
        .param(
            "whole-views", &P::whole_views,
            "Whether each view shows the whole side of the object that faces its scanner. false: the scanner's field "
            "cuts views off, and parts outside the convex outline of a view do not contradict it.")
        .param("seed-tries", &P::seed_tries,
               "Number of poses of a pair that are refined; the ten with most votes are tested. On a target, all that "
               "descriptors propose are refined, and so many of them are fitted with the points.",
               at_least(1), at_most(300))
        .choice("on-refusal", &P::on_refusal,
                {{"fail", P::OnRefusal::fail, "The step fails, and the message lists every refused view."},
                 {"leave-out", P::OnRefusal::leave_out,
                  "The other views go on without the refused ones, and the result is doubtful."}},
                "What happens if a view cannot be placed surely.")
        .metric("views", Unit::count, "Views in the input.")
        .metric("placed", Unit::count, "Views with a motion.", headline, larger_is_better)
        .metric("refused", Unit::count, "Views without a motion.", headline, smaller_is_better)
        .metric("pairs", Unit::count, "Pairs of views that were accepted.")
        .metric("overlap", Unit::ratio, "Largest share of a view's points that another view has, too.", numbered,
                larger_is_better)
        .metric("residual", Unit::length, "Root mean square distance of a view's points from the planes of the others.",
                numbered, smaller_is_better)
        .metric(
            "confidence", Unit::number,
            "Largest score of a view's pairs: the overlap, less for points in front of other views and for points that "
            "other views should have; 0 to 1.",
            numbered, larger_is_better)
        .metric("rms", Unit::length, "Root mean square distance of the points from the planes of other views.",
                headline, smaller_is_better)
        .metric("rival", Unit::ratio, "With a target: share of the points that lie on it in the next best pose.",
                smaller_is_better)
        .doubts({"views were left out: they fit nowhere surely, or the file of poses refuses them",
                 "views fit the others better elsewhere than at the poses of the file",
                 "the views overlap too little to find or test their poses",
                 "`whole-views` is false, and no other view confirms a pair"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            const auto clouds = inputs.list<PointCloud>("points");
            if (const auto* target = inputs.find<TriangleMesh>("target"))
                return Outputs().set("transform", registered_to(*target, clouds, params, context));
            if (const auto* target = inputs.find<PointCloud>("target"))
                return Outputs().set("transform", registered_to(*target, clouds, params, context));
            return Outputs().set("transform", registered_clouds(clouds, params, context));
        });
}
