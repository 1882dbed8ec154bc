// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers to call outlier-removal, and clouds with outliers.

#include <vector>

#include "outlier_removal/outlier_removal.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/bounds.hpp"

namespace scanmill::test {

inline OutlierRemovalResult clean(const PointCloud& cloud, const OutlierRemovalParams& params = {},
                                  unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return outlier_removal(cloud, params, context);
}

/// All suspects are removed, as by PCL.
inline OutlierRemovalParams suspects_only(u32 neighbours, double factor = 3) {
    OutlierRemovalParams params;
    params.neighbours = neighbours;
    params.factor = factor;
    params.min_component = Ratio();
    return params;
}

inline OutlierRemovalParams by_radius(u32 neighbours, double radius, Ratio min_component = Ratio()) {
    OutlierRemovalParams params;
    params.method = OutlierRemovalParams::Method::radius;
    params.neighbours = neighbours;
    params.radius = radius;
    params.min_component = min_component;
    return params;
}

inline PointCloud cloud_of_points(const std::vector<Vec3>& points) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(points.begin(), points.end());
    return cloud;
}

/// Points on the x axis.
inline PointCloud on_a_line(std::initializer_list<double> xs) {
    std::vector<Vec3> points;
    for (const double x : xs) points.emplace_back(x, 0, 0);
    return cloud_of_points(points);
}

/// The points (i, j) times `spacing` with 0 ≤ i, j < side, from `corner` on.
inline std::vector<Vec3> square_grid(int side, double spacing, const Vec3& corner = Vec3::Zero()) {
    std::vector<Vec3> points;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) points.push_back(corner + spacing * Vec3(i, j, 0));
    return points;
}

/// The cloud followed by `count` points, uniform in its box scaled by `factor` about its centre.
inline PointCloud with_outliers(const PointCloud& cloud, std::size_t count, double factor, std::uint64_t seed) {
    const BoundingBox box = bounding_box(cloud.positions.span());
    const Vec3 centre = (box.low + box.high) / 2, half = (box.high - box.low) / 2;
    std::vector<Vec3> points(cloud.positions.begin(), cloud.positions.end());
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        Vec3 offset;
        for (int axis = 0; axis < 3; ++axis) offset[axis] = factor * (2 * random.uniform() - 1) * half[axis];
        points.push_back(centre + offset);
    }
    return cloud_of_points(points);
}

}  // namespace scanmill::test
