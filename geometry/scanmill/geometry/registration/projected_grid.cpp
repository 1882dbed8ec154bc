// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/projected_grid.hpp"

#include <limits>
#include <numeric>
#include <tuple>

#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

/// Outliers far away would need many empty cells.
constexpr double most_cells_per_point = 16;

}  // namespace

ProjectedGrid::ProjectedGrid(std::span<const Vec3> points, const Vec3& direction, double edge)
    : direction_(direction),
      edge_(edge) {
    std::tie(x_axis_, y_axis_) = directions_across(direction);
    Array<Ray> rays;
    rays.reserve(points.size());
    double high_x = -std::numeric_limits<double>::infinity(), high_y = high_x;
    low_x_ = low_y_ = -high_x;
    for (u32 row = 0; row < points.size(); ++row) {
        Ray ray = ray_of(points[row]);
        ray.row = row;
        low_x_ = std::min(low_x_, ray.x), high_x = std::max(high_x, ray.x);
        low_y_ = std::min(low_y_, ray.y), high_y = std::max(high_y, ray.y);
        rays.push_back(ray);
    }
    if (points.empty()) low_x_ = low_y_ = high_x = high_y = 0;
    const auto cells = [&](double low, double high) { return std::floor((high - low) / edge_) + 1; };
    while (cells(low_x_, high_x) * cells(low_y_, high_y) >
           most_cells_per_point * static_cast<double>(points.size() + 64))
        edge_ *= 2;
    columns_ = cells(low_x_, high_x), rows_ = cells(low_y_, high_y);
    const auto cell_of = [&](const Ray& ray) {
        const double column = std::min(std::floor((ray.x - low_x_) / edge_), columns_ - 1);
        const double row = std::min(std::floor((ray.y - low_y_) / edge_), rows_ - 1);
        return static_cast<std::size_t>(row * columns_ + column);
    };
    begin_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (const Ray& ray : rays) ++begin_[cell_of(ray) + 1];
    std::inclusive_scan(begin_.begin(), begin_.end(), begin_.begin());
    Array<u32> next(begin_.begin(), begin_.end() - 1);
    rays_.resize(rays.size());
    for (const Ray& ray : rays) rays_[next[cell_of(ray)]++] = ray;
}

ProjectedGrid::Nearest ProjectedGrid::nearest(const Vec3& position, double guess, double limit) const {
    const Ray at = ray_of(position);
    // Cells are visited whole, so a radius of less than an edge would save little.
    for (double radius = std::min(std::max(guess, edge_ / 2), limit);; radius = std::min(2 * radius, limit)) {
        double least = std::numeric_limits<double>::infinity(), second = least;
        u32 best = Nearest::none;
        any_within(at, radius, [&](const Ray& ray) {
            const double x = ray.x - at.x, y = ray.y - at.y, z = ray.height - at.height,
                         squared = x * x + y * y + z * z;
            if (squared < least || (squared == least && ray.row < best)) {
                second = least;
                least = squared, best = ray.row;
            } else {
                second = std::min(second, squared);
            }
            return false;
        });
        // Points beyond the radius were not all seen.
        if (least <= radius * radius) return {best, std::sqrt(least), std::min(std::sqrt(second), radius)};
        if (radius >= limit) return {Nearest::none, limit, limit};
    }
}

}  // namespace scanmill
