// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Clouds with weights, and how the tests tetrahedralise them.

#include <string>

#include "delaunay/delaunay.hpp"
#include "filters/alpha_solid/cases.hpp"
#include "scanmill/base/random.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {

inline DelaunayParams weighted_by(std::string weights, double factor = 1) { return {std::move(weights), factor}; }

inline DelaunayResult weighted(const PointCloud& cloud, const DelaunayParams& params = weighted_by("spacing"),
                               unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return delaunay(cloud, params, context);
}

/// The cloud with a column `w`.
inline PointCloud with_weights(PointCloud cloud, Array<double> weights) {
    cloud.columns.add(Column("w", 1, Buffer<double>(std::move(weights))));
    return cloud;
}

/// Weights between 0 and `largest`.
inline PointCloud with_random_weights(const PointCloud& cloud, double largest, std::uint64_t seed) {
    Random random(seed);
    Array<double> weights(cloud.size());
    for (double& weight : weights) weight = random.uniform(0, largest);
    return with_weights(cloud, std::move(weights));
}

/// A plate of 10 × 10 × 2 with a square hole of edge 0.8 through its middle. Its surface is sampled on a lattice of
/// spacing 1, round and in the hole of spacing 0.2 (on integers, which are exact, and then divided by 5).
inline PointCloud plate_with_a_hole() {
    const auto is_fine = [](int x, int y) { return x >= 20 && x <= 30 && y >= 20 && y <= 30; };
    const auto in_hole = [](int x, int y) { return x > 23 && x < 27 && y > 23 && y < 27; };
    const auto on_hole = [](int x, int y) {
        return x >= 23 && x <= 27 && y >= 23 && y <= 27 && (x == 23 || x == 27 || y == 23 || y == 27);
    };
    Array<Vec3> positions;
    for (int x = 0; x <= 50; ++x)
        for (int y = 0; y <= 50; ++y)
            for (int z = 0; z <= 10; ++z) {
                const bool coarse = x % 5 == 0 && y % 5 == 0 && z % 5 == 0;
                const bool on_side = x == 0 || x == 50 || y == 0 || y == 50, on_face = z == 0 || z == 10;
                const bool on_plate =
                    is_fine(x, y) ? (on_face && !in_hole(x, y)) || on_hole(x, y) : coarse && (on_side || on_face);
                if (on_plate) positions.push_back(Vec3(x, y, z) / 5);
            }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

}  // namespace scanmill::test
