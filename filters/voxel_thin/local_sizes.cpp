// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/local_sizes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scanmill/base/error.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::voxel {

namespace {

constexpr double least_voxels_along_box = 10;
constexpr double most_voxels_along_box = 1 << 20;
/// Share of points without a determined surface above which a warning is given.
constexpr double many_undetermined = 0.01;

void require_valid(const RobustBox& box, const VoxelThinParams& params) {
    const double tolerance = params.tolerance.value(), diagonal = box.diagonal();
    if (!(tolerance > 0) || !std::isfinite(tolerance)) throw Error("tolerance is {} u; it must be above 0", tolerance);
    const double quantile = params.quantile.value();
    if (!(quantile >= 0 && quantile <= 1)) throw Error("quantile is {}; it must be between 0 and 1", quantile);
    if (params.neighbours < 6)
        throw Error("neighbours is {}; a quadric needs at least 6", params.neighbours)
            .hint("25 is a good number for most scans");
    if (params.neighbours > 1000)
        throw Error("neighbours is {}; at most 1000 are supported", params.neighbours)
            .hint("25 is a good number for most scans");
    if (!(tolerance < diagonal))
        throw Error("tolerance is {:.6g} u, which is not below the cloud's diagonal of {:.6g} u", tolerance, diagonal)
            .hint("give a tolerance well below the size of the details to keep, or a bin-size");
}

void require_enough(std::size_t points, u32 neighbours) {
    if (points > neighbours) return;
    throw Error("the cloud has {}; curvature from {} neighbours needs at least {}",
                count_text(points, "distinct point", "distinct points"), neighbours, u64(neighbours) + 1)
        .hint("give a bin-size, or fewer neighbours (at least 6)");
}

double chosen_size(const LocalSizes& local, std::span<const StrayPoint> stray, const VoxelThinParams& params) {
    std::vector<bool> is_stray(local.sizes.size());
    for (const StrayPoint& point : stray) is_stray[local.point_of_row[point.row]] = true;
    Array<double> determined;
    for (std::size_t point = 0; point < local.sizes.size(); ++point)
        if (local.surfaces[point].is_curved && !is_stray[point]) determined.push_back(local.sizes[point]);
    if (determined.empty())
        throw Error("no point has {} neighbours that determine a surface: all lie near lines", params.neighbours)
            .hint("give a bin-size, or more neighbours, so that they include more than one scan line");
    const double share = params.rule == VoxelThinParams::Rule::minimum ? 0 : params.quantile.value();
    return quantile(determined, share);
}

void warn_of_undetermined(const LocalSizes& local, const VoxelThinParams& params, Context& context) {
    const auto points = static_cast<double>(local.sizes.size());
    if (static_cast<double>(local.undetermined) <= many_undetermined * points) return;
    context.warn(fmt::format(
        "at {} of {} distinct points the {} neighbours lie near a line and determine no surface; the tolerance may not "
        "hold there; more neighbours may help",
        local.undetermined, local.sizes.size(), params.neighbours));
}

}  // namespace

double longest_edge(double derivatives, double tolerance) { return 2 * std::sqrt(2 * tolerance / derivatives); }

double size_for_edge(double edge, VoxelThinParams::Guarantee guarantee) {
    const double size = edge / std::numbers::sqrt3;
    return guarantee == VoxelThinParams::Guarantee::points ? size / 2 : size;
}

double derivatives_of(const LocalSurface& surface, VoxelThinParams::Derivatives derivatives) {
    const double sum = std::abs(surface.first_curvature) + std::abs(surface.second_curvature);
    return derivatives == VoxelThinParams::Derivatives::thesis ? sum / 2 : sum;
}

LocalSizes local_sizes(std::span<const Vec3> positions, const RobustBox& box, const VoxelThinParams& params,
                       Context& context) {
    require_valid(box, params);
    const PointTree tree(positions, context.threads());
    require_enough(tree.positions().size(), params.neighbours);
    context.progress(0.2);

    LocalSizes local;
    local.point_of_row.assign(tree.index_of_row().begin(), tree.index_of_row().end());
    local.surfaces = local_surfaces(tree, {params.neighbours, params.origin}, context);
    const double extent = (box.robust.high - box.robust.low).maxCoeff();
    const LocalSurface& closest = *std::ranges::min_element(local.surfaces, {}, &LocalSurface::spacing);
    local.largest = extent / least_voxels_along_box;
    // A voxel with a diagonal of less than the closest spacing cannot hold two points.
    local.least =
        std::min(std::max(closest.spacing / std::numbers::sqrt3, extent / most_voxels_along_box), local.largest);
    local.sizes.resize(local.surfaces.size());
    for (std::size_t point = 0; point < local.sizes.size(); ++point) {
        const LocalSurface& surface = local.surfaces[point];
        const double edge = longest_edge(derivatives_of(surface, params.derivatives), params.tolerance.value());
        const double allowed = size_for_edge(edge, params.guarantee);
        local.sizes[point] = std::clamp(allowed, local.least, local.largest);
        local.undetermined += !surface.is_curved;
        local.flat += surface.is_curved && allowed >= local.largest;
    }
    local.chosen = chosen_size(local, box.stray, params);
    warn_of_undetermined(local, params, context);
    return local;
}

}  // namespace scanmill::voxel
