// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "region_grow/normal_signs.hpp"
#include "region_grow/small_holes.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill::growing {

namespace {

void count_all(const RegionGrowResult& result, Context& context) {
    const auto count = [&](std::string_view name, std::size_t value) {
        context.metric(name, static_cast<double>(value));
    };
    count("triangles", result.mesh.triangles.size());
    count("components", result.components);
    count("loops", result.loops);
    count("holes", result.holes);
    count("thin-loops", result.thin_loops);
    count("unused-points", result.unused_points);
    count("duplicates", result.duplicates);
    count("patch-edges", result.patch_edges);
    count("creases", result.creases);
    count("corners", result.corners);
    count("closed-holes", result.closed_holes);
    count("removed-triangles", result.removed_triangles);
    count("ambiguous", result.ambiguous_loops);
    count("without-area", result.triangles_without_area);
    count("relaxed-triangles", static_cast<std::size_t>(std::ranges::count_if(
                                   result.passes, [](u8 pass) { return pass > 0 && pass < closing_pass; })));
}

void warn_of_unused(const RegionGrowResult& result, const Surface& surface, Context& context) {
    const std::size_t places = surface.samples.size(), unused = result.unused_points;
    if (200 * unused > places)
        context.warn(fmt::format(
            "{} of {} distinct points are in no triangle; thin the scan, or remove its noise first", unused, places));
}

void warn_of_thin_parts(const RegionGrowResult& result, const ThinParts& thin, Context& context) {
    if (thin.loops == 0) return;
    const std::string_view unit = symbol(result.mesh.frame.unit);
    context.warn(fmt::format(
        "{} of {} boundary loops {} where two sides, or layers, are nearer to each other than {} bins, the "
        "nearest {:.3g} "
        "{} with bins of {:.3g} {}: the surface may go on there; thin less where the object is thin, more "
        "where the scan "
        "is noisy",
        thin.loops, result.loops, by_count(thin.loops, "lies", "lie"), thin_in_bins, thin.least, unit, thin.bin, unit));
}

void warn_of_seams(const Surface& surface, Context& context) {
    if (!surface.oriented) return;
    if (const std::size_t places = places_at_seams(surface); places > 2)
        context.warn(fmt::format(
            "the surface ends at {} points where normals of the column 'normal' turn to the opposite from one point to "
            "the next, as those do that were turned towards a camera; drop the column if it goes on there",
            places));
}

}  // namespace

void report(const RegionGrowResult& result, const FeatureCounts& lines, const Surface& surface, const ThinParts& thin,
            Context& context) {
    count_all(result, context);
    warn_of_unused(result, surface, context);
    for (std::string& sentence : doubts(lines)) context.warn(std::move(sentence));
    warn_of_seams(surface, context);
    warn_of_thin_parts(result, thin, context);
}

}  // namespace scanmill::growing
