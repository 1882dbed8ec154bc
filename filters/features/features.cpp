// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/features.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill {

namespace {

void warn_of_short_creases(const FeatureCounts& counts, const FeatureParams& params, Context& context) {
    if (counts.dropped > 0)
        context.warn(fmt::format("left out {} shorter than {:.6g} u", count_text(counts.dropped, "crease", "creases"),
                                 params.min_length.value()));
}

}  // namespace

FeatureLines features(const TriangleMesh& mesh, const FeatureParams& params, Context& context) {
    if (mesh.triangles.empty())
        throw Error("the mesh has no triangles; features need at least one")
            .hint("`scanmill info` shows what a file contains");
    context.check_cancelled();
    FeatureLines lines = find_features(mesh, params, context);
    for (std::string& sentence : doubts(lines.counts)) context.warn(std::move(sentence));
    warn_of_short_creases(lines.counts, params, context);

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
    metric("unreliable", lines.counts.unreliable);
    context.metric("noise", lines.noise, Unit::length);
    context.progress(1);
    return lines;
}

}  // namespace scanmill
