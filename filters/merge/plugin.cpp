// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "merge/merge.hpp"
#include "merge/scan_poses.hpp"

using namespace scanmill;

namespace {

struct PosedMergeParams : MergeParams {
    std::optional<std::filesystem::path> poses_file;
};

}  // namespace

SCANMILL_FILTER() {
    using P = PosedMergeParams;
    return Declare<P>("merge", 5)
        .summary("Merges several clouds, moved by their poses, and keeps one point where they overlap.")
        .source("pose files: Turk and Levoy 1994; weights of `fuse`: the same, and Curless and Levoy 1996")
        .ties("If points overlap and have equal preference, the point of the earlier input is kept.")
        .not_finite("Refused; the message gives the input, their number and the first one.")
        .adds({"source", "uncertainty", "moved"})
        .in<PointCloud>("points", "At least one cloud; all have finite coordinates and the same unit.", list)
        .in<Transforms>("transform", "The motion of each input, in place of a file of `poses`.", optional, by_name)
        .out<PointCloud>("points", "All points that are kept, in input order, with a column `source`.")
        .param("poses", &P::poses_file, "A Stanford .conf or a JSON file with the pose of each input.", word("none"))
        .choice("prefer", &P::prefer,
                {{"none", P::Prefer::none, "The point of the earlier input."},
                 {"lower-uncertainty", P::Prefer::lower_uncertainty,
                  "The point with the smaller number in its column `uncertainty`; with equal numbers, the point of the "
                  "earlier input."}},
                "Which of two points is kept where inputs overlap.")
        .param("within", &P::within, "Points of different inputs within this distance overlap; 0 keeps all.",
               at_least(0))
        .param("fuse", &P::fuse,
               "Views whose surfaces lie at most this far apart become one layer, before points are dropped; 2 spacing "
               "suits registered views. `spacing` is here the median of the views' spacings.",
               word("none"), at_least(0), takes_spacings)
        .param("default-uncertainty", &P::default_uncertainty,
               "Uncertainty of points whose input lacks the column `uncertainty`, and of points with NaN in it.",
               word("none"), at_least(0))
        .metric("points", Unit::count, "Points that were kept.")
        .metric("dropped", Unit::count, "Points that were dropped because a point of another input overlaps them.",
                headline)
        .metric("fused", Unit::count, "Points that `fuse` moved; without `fuse` there is no such metric.")
        .doubts({"views cross each other: at least one of them has a wrong pose"})
        .run([](const Inputs& inputs, P params, Context& context) {
            auto clouds = inputs.list<PointCloud>("points");
            const auto* transforms = inputs.find<Transforms>("transform");
            if (transforms && params.poses_file)
                throw Error("the poses come from the file '{}' and from the input `transform`; one of them is needed",
                            params.poses_file->string())
                    .hint("remove `poses` or the input `transform`");
            if (transforms) {
                merging::place(clouds, params, merging::scan_poses_of(*transforms), context);
            } else if (params.poses_file) {
                const auto warn = [&](std::string sentence) { context.warn(std::move(sentence)); };
                merging::place(clouds, params, read_poses(*params.poses_file, warn), context);
            }
            return Outputs().set("points", merge(clouds, params, context).points);
        });
}
