// SPDX-License-Identifier: GPL-3.0-or-later
/// delaunay on several threads, its cancellation and its progress.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>

#include "filters/delaunay/checks.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
TEST(DelaunayThreads, AnyNumberOfThreads_GivesTheSameBytes) {
    for (const PointCloud& cloud : {random_cube(40000, 5), lattice_cube(24), fibonacci_sphere(30000, 1e-4)}) {
        const TetMesh one = triangulated(cloud, 1).tets;
        for (unsigned threads : {2u, 3u}) expect_equal_bytes(one, triangulated(cloud, threads).tets);
    }
}

TEST(DelaunayThreads, ManyDuplicates_AreTheSameForThreads) {
    const PointCloud base = random_cube(20000, 9);
    const PointCloud twice = shuffled(joined(base, base), 4);
    const DelaunayResult one = triangulated(twice, 1), two = triangulated(twice, 2);
    EXPECT_EQ(two.duplicates, 20000u);
    expect_equal_bytes(one.tets, two.tets);
    EXPECT_EQ(places(two.tets), places(triangulated(base).tets));
}

TEST(DelaunayThreads, PlateUnderOnePoint_IsTheSameForThreads) {
    PointCloud cloud = joined(random_cube(12000, 3), cloud_of({{0.5, 0.5, 1}}));
    Array<Vec3> flat(cloud.positions.begin(), cloud.positions.end());
    for (std::size_t i = 0; i + 1 < flat.size(); ++i) flat[i].z() = 0;
    cloud.positions = std::move(flat);
    const TetMesh one = triangulated(cloud, 1).tets;
    expect_equal_bytes(one, triangulated(cloud, 2).tets);
    expect_canonical(one);
}

TEST(DelaunayThreads, WhenCancelled_StopsWithCancelled) {
    int asked = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++asked > 3; };
    Context context(options);
    EXPECT_THROW(delaunay(random_cube(50000, 1), {}, context), Cancelled);
    EXPECT_LT(asked, 10);
}

TEST(DelaunayThreads, WhenCancelledOnSeveralThreads_StopsWithCancelled) {
    std::atomic<int> asked = 0;
    ContextOptions options;
    options.threads = 2;
    options.is_cancelled = [&] { return ++asked > 50; };
    Context context(options);
    EXPECT_THROW(delaunay(random_cube(50000, 1), {}, context), Cancelled);
    EXPECT_LT(asked, 60);
}

TEST(DelaunayThreads, Progress_RisesToOne) {
    std::vector<double> fractions;
    ContextOptions options;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    delaunay(random_cube(20000, 1), {}, context);
    ASSERT_GT(fractions.size(), 4u);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace scanmill
