// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/search_radii.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"

namespace scanmill::growing {

namespace {

constexpr std::size_t counted_neighbours = 12;
/// Number of voxels that a surface meets per squared voxel edge, on average over all directions.
constexpr double voxels_per_squared_edge = 1.5;
/// The density estimate and the given size agree if their ratio is in this range.
constexpr double least_ratio = 0.55, largest_ratio = 1.15;
/// Largest given size or estimate of a point, as a multiple of the median of its neighbours' sizes or estimates.
constexpr double largest_of_median = 1.15;
constexpr std::size_t chunk = 1 << 12;

/// Returns the voxel size for which the last counted neighbour has its distance, on a surface that meets one voxel per
/// squared edge.
double size_at(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, u32 point) {
    const auto neighbours = neighbourhoods.of(point);
    const std::size_t count = std::min(counted_neighbours, neighbours.size());
    const double distance = (points.positions[neighbours[count - 1]] - points.positions[point]).norm();
    return distance * std::sqrt(std::numbers::pi / static_cast<double>(count));
}

/// Number of voxels per squared edge that a surface of this normal meets.
double voxels_met(const Vec3& normal) { return normal.cwiseAbs().sum(); }

class SizeEstimates {
public:
    SizeEstimates(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, std::span<const Vec3> normals,
                  unsigned threads)
        : neighbourhoods_(neighbourhoods),
          normals_(normals),
          sizes_(points.size()) {
        for_each_chunk(threads, sizes_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t point = begin; point < end; ++point)
                sizes_[point] = size_at(points, neighbourhoods, static_cast<u32>(point));
        });
    }

    double by_density(u32 point, std::vector<double>& buffer) const {
        return std::sqrt(voxels_per_squared_edge) * spacing(point, buffer);
    }
    /// The spacing of a square grid of the same density.
    double spacing(u32 point, std::vector<double>& buffer) const {
        buffer.clear();
        for (u32 other : neighbourhoods_.of(point)) buffer.push_back(sizes_[other]);
        return std::min(sizes_[point], largest_of_median * median(buffer));
    }
    /// The given size, limited by the sizes of the neighbours; 0 if none is given.
    double given(std::span<const double> given_sizes, u32 point, std::vector<double>& buffer) const {
        if (given_sizes.empty() || !(given_sizes[point] > 0)) return 0;
        buffer.clear();
        for (u32 other : neighbourhoods_.of(point))
            if (given_sizes[other] > 0) buffer.push_back(given_sizes[other]);
        return buffer.empty() ? given_sizes[point] : std::min(given_sizes[point], largest_of_median * median(buffer));
    }
    /// Median of the neighbours' estimates, for voxels aligned with the axes.
    double by_density_and_normals(u32 point, std::vector<double>& buffer) const {
        buffer.clear();
        for (u32 other : neighbourhoods_.of(point))
            buffer.push_back(sizes_[other] * std::sqrt(voxels_met(normals_[other])));
        return median(buffer);
    }

private:
    const Neighbourhoods& neighbourhoods_;
    std::span<const Vec3> normals_;
    Array<double> sizes_;
};

}  // namespace

Array<double> local_spacings(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, unsigned threads) {
    const SizeEstimates estimates(points, neighbourhoods, {}, threads);
    Array<double> spacings(points.size());
    for_each_chunk(threads, points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<double> buffer;
        for (std::size_t i = begin; i < end; ++i) spacings[i] = estimates.spacing(static_cast<u32>(i), buffer);
    });
    return spacings;
}

SearchRadii automatic_radii(const DistinctPoints& points, const Neighbourhoods& neighbourhoods,
                            std::span<const Vec3> normals, std::span<const float> variation,
                            std::span<const double> given_sizes, unsigned threads) {
    const SizeEstimates estimates(points, neighbourhoods, normals, threads);
    SearchRadii result;
    result.radii.resize(points.size());
    result.by_density.resize(points.size());
    result.too_dense = Array<double>(given_sizes.size(), 0);
    std::vector<std::size_t> known((points.size() + chunk - 1) / chunk, 0);
    for_each_chunk(threads, points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<double> buffer;
        for (std::size_t i = begin; i < end; ++i) {
            const u32 point = static_cast<u32>(i);
            const double given = estimates.given(given_sizes, point, buffer);
            const double seen = given > 0 ? estimates.by_density_and_normals(point, buffer) : 0;
            const bool agree = given > 0 && seen >= least_ratio * given && seen <= largest_ratio * given;
            known[begin / chunk] += agree;
            const double dense = estimates.by_density(point, buffer);
            const double size = !agree ? dense : variation[i] > sharp_variation ? std::max(given, dense) : given;
            result.radii[i] = radius_in_voxels * size;
            result.by_density[i] = radius_in_voxels * dense;
            if (seen < least_ratio * given) result.too_dense[i] = size;
        }
    });
    for (const std::size_t count : known) result.known += count;
    return result;
}

double equivalent_voxel_size(const Surface& surface, unsigned threads) {
    Array<double> radii =
        automatic_radii(surface.points, surface.neighbourhoods, surface.normals, surface.variation, {}, threads).radii;
    return median(radii) / radius_in_voxels;
}

Array<double> given_voxel_sizes(const PointCloud& cloud, const DistinctPoints& points, Context& context) {
    const Column* column = cloud.columns.find("bin-size");
    if (!column) return {};
    if (column->components() != 1 || column->rows() != cloud.size()) {
        context.warn("the column `bin-size` is not one number per point; the search radius follows from the density");
        return {};
    }
    const auto size_of_row = [&](u32 row) {
        const double size = column->number(row);
        return std::isfinite(size) && size > 0 ? size : 0;
    };
    Array<double> sizes(points.size());
    for (std::size_t point = 0; point < sizes.size(); ++point) sizes[point] = size_of_row(points.rows[point]);
    for (const auto& [point, row] : points.repeats)
        if (const double size = size_of_row(row); size > 0 && (sizes[point] == 0 || size < sizes[point]))
            sizes[point] = size;
    return sizes;
}

void warn_of_contradiction(std::span<const double> given_sizes, const SearchRadii& found, LengthUnit unit,
                           Context& context) {
    std::vector<double> given, seen;
    for (std::size_t point = 0; point < given_sizes.size(); ++point) {
        if (found.too_dense[point] == 0) continue;
        given.push_back(given_sizes[point]);
        seen.push_back(found.too_dense[point]);
    }
    if (2 * given.size() <= given_sizes.size()) return;
    context.warn(
        fmt::format("{} of {} points are too dense for their column `bin-size`: their density is that of voxels of "
                    "{:.3g} {}, not {:.3g}; the search radius follows from the density. Thin the points again, drop "
                    "the column, or check the scan's unit",
                    given.size(), given_sizes.size(), median(seen), symbol(unit), median(given)));
}

}  // namespace scanmill::growing
