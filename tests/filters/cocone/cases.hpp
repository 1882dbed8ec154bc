// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call cocone, and the open clouds that they use.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cocone/cocone.hpp"
#include "delaunay/delaunay.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/topology.hpp"
#include "support/point_sets.hpp"

namespace scanmill::test {

inline TetMesh tets_of(const PointCloud& cloud, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return delaunay(cloud, {}, context).tets;
}

inline CoconeResult surface_through(const PointCloud& cloud, const CoconeParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return cocone(tets_of(cloud, threads), params, context);
}

/// The points of a cloud that `keep` accepts.
template <class Keep>
PointCloud points_where(const PointCloud& cloud, const Keep& keep) {
    Array<u32> rows;
    for (u32 row = 0; row < cloud.positions.size(); ++row)
        if (keep(cloud.positions[row])) rows.push_back(row);
    PointCloud kept;
    kept.frame = cloud.frame;
    kept.positions = gather(cloud.positions, rows);
    return kept;
}

/// A gently curved patch of 21 × 21 points, one apart, slightly moved.
inline PointCloud curved_patch() {
    PointCloud cloud;
    Array<Vec3> positions;
    Random random(3);
    for (int i = 0; i <= 20; ++i)
        for (int j = 0; j <= 20; ++j) {
            const double x = i - 10 + random.uniform(-0.05, 0.05), y = j - 10 + random.uniform(-0.05, 0.05);
            positions.emplace_back(x, y, 0.01 * (x * x + 0.5 * y * y));
        }
    cloud.positions = std::move(positions);
    return cloud;
}

}  // namespace scanmill::test
