// SPDX-License-Identifier: GPL-3.0-or-later
/// Cancellation takes effect in every stage.
#include <gmock/gmock.h>

#include "filters/region_grow/cases.hpp"

namespace scanmill {
namespace {

using namespace test;

TEST(RegionGrow_Cancelled, EndsAlsoWhereNoTriangleIsFound) {
    // Few triangles: most checks are for edges without a suitable point.
    std::size_t checks = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++checks, false; };
    Context context(options);
    RegionGrowParams params;
    params.search_radius = Length(100);
    const RegionGrowResult result = region_grow(random_cube(300, 3), params, context);
    EXPECT_LT(result.mesh.triangles.size(), 1000u);
    const std::size_t all = checks;
    EXPECT_GE(all, 12u);
    checks = 0;
    options.is_cancelled = [&] { return ++checks >= all - 2; };
    Context cancelled(options);
    EXPECT_THROW(region_grow(random_cube(300, 3), params, cancelled), Cancelled);
}

/// Number of cancellation checks by progress.
struct Checks {
    std::map<double, std::size_t> by_progress;
    std::size_t between(double begin, double end) const {
        std::size_t sum = 0;
        for (const auto& [progress, times] : by_progress) sum += progress >= begin && progress < end ? times : 0;
        return sum;
    }
};

Checks checks_by_progress(const PointCloud& cloud, const RegionGrowParams& params) {
    Checks checks;
    double progress = 0;
    ContextOptions options;
    options.on_progress = [&](double fraction) { progress = fraction; };
    options.is_cancelled = [&] { return ++checks.by_progress[progress], false; };
    Context context(options);
    region_grow(cloud, params, context);
    return checks;
}

TEST(RegionGrow_Cancelled, EndsInEveryStage) {
    // Noise with many boundaries: holes to close and patch edges to test after growth has reported 0.9.
    const PointCloud cloud = random_cube(3000, 3);
    RegionGrowParams params;
    params.close_holes = 0;
    const auto without_holes = checks_by_progress(cloud, params);
    params.close_holes = 30;
    const auto checks = checks_by_progress(cloud, params);
    EXPECT_GE(checks.between(0.05, 0.3), 1u) << "before neighbours are sought";
    EXPECT_GE(checks.between(0.4, 0.9), 100u) << "growing";
    // A check per 64 edges of a surface that is mostly boundary, and per loop.
    EXPECT_GE(without_holes.between(0.9, 1), 5u) << "patch edges";
    EXPECT_GE(checks.between(0.9, 1), without_holes.between(0.9, 1) + 20) << "holes";
    for (const double stage : {0.05, 0.3, 0.4, 0.9}) {
        bool reached = false;
        ContextOptions options;
        options.on_progress = [&](double fraction) { reached = reached || fraction >= stage; };
        options.is_cancelled = [&] { return reached; };
        Context context(options);
        EXPECT_THROW(region_grow(cloud, params, context), Cancelled) << stage;
        EXPECT_TRUE(reached) << stage;
    }
}

}  // namespace
}  // namespace scanmill
