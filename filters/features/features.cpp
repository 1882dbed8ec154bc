// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/features.hpp"

#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

std::string counted(std::size_t count, std::string_view thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

void warn_of_doubts(const FeatureCounts& counts, const FeatureParams& params, Context& context) {
    if (counts.without_area > 0)
        context.warn(counted(counts.without_area, "triangle") + " without area: counted to a neighbour's plane");
    if (counts.ambiguous > 0)
        context.warn(counted(counts.ambiguous, "boundary loop") +
                     " whose area does not tell outer boundaries from holes: the longest of a piece was taken for its "
                     "outer boundary");
    if (counts.dropped > 0)
        context.warn(fmt::format("{} shorter than {:.6g} u: left out", counted(counts.dropped, "crease"),
                                 params.min_length.value()));
}

}  // namespace

FeatureLines features(const TriangleMesh& mesh, const FeatureParams& params, Context& context) {
    if (mesh.triangles.empty())
        throw Error("the mesh has no triangles; features need at least one")
            .hint("`scanmill info` tells what a file holds");
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
