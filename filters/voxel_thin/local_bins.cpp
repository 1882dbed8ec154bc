// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/local_bins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::voxel {

namespace {

constexpr double parts_of_box = 10;
constexpr double most_bins_along_box = 1 << 20;
/// Above this share, places without a surface are worth a word.
constexpr double many_undetermined = 0.01;

void require_sound(const BoundingBox& box, const VoxelThinParams& params) {
    const double tolerance = params.tolerance.value(), diagonal = box.diagonal();
    if (!(tolerance > 0) || !std::isfinite(tolerance))
        throw Error("the tolerance is {} u; it must be above 0", tolerance);
    const double quantile = params.quantile.value();
    if (!(quantile >= 0 && quantile <= 1)) throw Error("the quantile is {}; it must be between 0 and 1", quantile);
    if (params.neighbours < 6)
        throw Error("neighbours is {}; a quadric needs at least 6", params.neighbours)
            .hint("25 is a good number for most scans");
    if (params.neighbours > 1000)
        throw Error("neighbours is {}; at most 1000 are possible", params.neighbours)
            .hint("25 is a good number for most scans");
    if (!(tolerance < diagonal))
        throw Error("the tolerance is {:.6g} u, and the whole cloud's diagonal is {:.6g} u", tolerance, diagonal)
            .hint("give a tolerance well below the size of the details to keep, or a bin-size");
}

void require_places(std::size_t places, u32 neighbours) {
    if (places > neighbours) return;
    throw Error("the cloud has {}; curvature from {} neighbours needs at least {}",
                counted(places, "distinct place", "distinct places"), neighbours, u64(neighbours) + 1)
        .hint("give a bin-size, or fewer neighbours (at least 6)");
}

/// The least size such that at least this share of the sizes is not above it.
double quantile_of(Array<double> sizes, double share) {
    const double rank = std::ceil(share * static_cast<double>(sizes.size()));
    const auto place = sizes.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::nth_element(sizes.begin(), place, sizes.end());
    return *place;
}

double chosen_of(const LocalBins& bins, const VoxelThinParams& params) {
    Array<double> determined;
    for (std::size_t place = 0; place < bins.sizes.size(); ++place)
        if (bins.surfaces[place].is_curved) determined.push_back(bins.sizes[place]);
    if (determined.empty())
        throw Error("nowhere do {} neighbours show a surface: all lie near lines", params.neighbours)
            .hint("give a bin-size, or more neighbours, so that they reach over more than one scan line");
    const double share = params.rule == VoxelThinParams::Rule::minimum ? 0 : params.quantile.value();
    return quantile_of(std::move(determined), share);
}

void warn_of_undetermined(const LocalBins& bins, const VoxelThinParams& params, Context& context) {
    const auto places = static_cast<double>(bins.sizes.size());
    if (static_cast<double>(bins.undetermined) <= many_undetermined * places) return;
    context.warn(fmt::format(
        "at {} of {} places {} neighbours show no surface, as they lie near lines; the tolerance is not known to hold "
        "there; more neighbours may help",
        bins.undetermined, bins.sizes.size(), params.neighbours));
}

}  // namespace

double longest_edge(double derivatives, double tolerance) { return 2 * std::sqrt(2 * tolerance / derivatives); }

double bin_for_edge(double edge, VoxelThinParams::Guarantee guarantee) {
    const double bin = edge / std::numbers::sqrt3;
    return guarantee == VoxelThinParams::Guarantee::points ? bin / 2 : bin;
}

double derivatives_of(const LocalSurface& surface, VoxelThinParams::Derivatives derivatives) {
    const double sum = std::abs(surface.first_curvature) + std::abs(surface.second_curvature);
    return derivatives == VoxelThinParams::Derivatives::thesis ? sum / 2 : sum;
}

LocalBins local_bins(std::span<const Vec3> positions, const BoundingBox& box, const VoxelThinParams& params,
                     Context& context) {
    require_sound(box, params);
    const PointTree tree(positions, context.threads());
    require_places(tree.places().size(), params.neighbours);
    context.progress(0.2);

    LocalBins bins;
    bins.place_of_row.assign(tree.place_of_row().begin(), tree.place_of_row().end());
    bins.surfaces = local_surfaces(tree, {params.neighbours, params.origin}, context);
    const double extent = (box.high - box.low).maxCoeff();
    const LocalSurface& closest = *std::ranges::min_element(bins.surfaces, {}, &LocalSurface::spacing);
    bins.largest = extent / parts_of_box;
    // A bin smaller than that holds no two places.
    bins.least = std::min(std::max(closest.spacing / std::numbers::sqrt3, extent / most_bins_along_box), bins.largest);
    bins.sizes.resize(bins.surfaces.size());
    for (std::size_t place = 0; place < bins.sizes.size(); ++place) {
        const LocalSurface& surface = bins.surfaces[place];
        const double edge = longest_edge(derivatives_of(surface, params.derivatives), params.tolerance.value());
        const double allowed = bin_for_edge(edge, params.guarantee);
        bins.sizes[place] = std::clamp(allowed, bins.least, bins.largest);
        bins.undetermined += !surface.is_curved;
        bins.flat += surface.is_curved && allowed >= bins.largest;
    }
    bins.chosen = chosen_of(bins, params);
    warn_of_undetermined(bins, params, context);
    return bins;
}

}  // namespace scanmill::voxel
