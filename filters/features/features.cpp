// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/features.hpp"

#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

void warn_of_doubts(const FeatureCounts& counts, const FeatureParams& params, Context& context) {
    if (counts.without_area > 0)
        context.warn(
            fmt::format("{} triangles have no area; they count as part of a neighbour's plane", counts.without_area));
    if (counts.ambiguous > 0)
        context.warn(
            fmt::format("{} boundary loops cannot be told to be outer or holes by their area; the longest loop of a "
                        "piece was taken for its outer boundary",
                        counts.ambiguous));
    if (counts.dropped > 0)
        context.warn(
            fmt::format("{} creases shorter than {} u were left out", counts.dropped, params.min_length.value()));
}

}  // namespace

FeatureLines features(const TriangleMesh& mesh, const FeatureParams& params, Context& context) {
    if (mesh.triangles.empty()) throw Error("the mesh has no triangles; features need at least one");
    context.check_cancelled();
    FeatureLines lines = find_features(mesh, params, context.threads());
    warn_of_doubts(lines.counts, params, context);

    const auto metric = [&](std::string_view name, std::size_t count) {
        context.metric(name, static_cast<double>(count));
    };
    metric("creases", lines.counts.creases);
    metric("holes", lines.counts.holes);
    metric("boundaries", lines.counts.boundaries);
    metric("corners", lines.counts.corners);
    metric("ambiguous", lines.counts.ambiguous);
    metric("dropped", lines.counts.dropped);
    metric("without-area", lines.counts.without_area);
    context.progress(1);
    return lines;
}

}  // namespace scanmill
