// SPDX-License-Identifier: GPL-3.0-or-later
/// The tree's answers beside those of looking at every position, on clouds that are hard on trees.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "scanmill/base/random.hpp"
#include "scanmill/data/point_tree.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;

/// A line of points whose steps grow from 1 to 2^20.
PointCloud growing_line() {
    Array<Vec3> line;
    for (int i = 0; i < 200; ++i) line.push_back(Vec3(std::exp2(i / 10.0), 0, 0));
    return {{}, std::move(line), {}};
}

/// The left half of a square a hundred times as dense as the right one.
PointCloud uneven_square() {
    Random random(7);
    Array<Vec3> square;
    for (int i = 0; i < 2020; ++i)
        square.push_back(Vec3(i < 2000 ? random.uniform(0, 1) : random.uniform(1, 2), random.uniform(), 0));
    return {{}, std::move(square), {}};
}

/// Two crowds a thousand diameters apart, and one point between them.
PointCloud two_crowds() {
    const PointCloud crowds =
        test::joined(test::random_cube(40, 3), test::moved(test::random_cube(300, 4), 1, {1000, 0, 0}));
    return test::joined(crowds, test::cloud_of({{400, 0, 0}}));
}

std::vector<PointCloud> hard_clouds() {
    const PointCloud cube = test::random_cube(400, 1);
    return {cube,
            test::joined(cube, cube),
            test::lattice_cube(6),
            test::lattice_cube(9, 1, true),
            growing_line(),
            uneven_square(),
            two_crowds(),
            test::cloud_of({{1, 2, 3}, {1, 2, 3}, {4, 5, 6}})};
}

std::vector<Neighbour> all_others(const PointTree& tree, u32 index) {
    std::vector<Neighbour> others;
    for (u32 other = 0; other < tree.positions().size(); ++other) {
        const Vec3 d = tree.positions()[other] - tree.positions()[index];
        if (other != index) others.push_back({(d.x() * d.x() + d.y() * d.y()) + d.z() * d.z(), other});
    }
    std::ranges::sort(others, {}, [](const Neighbour& n) { return std::pair(n.squared, n.index); });
    return others;
}

std::vector<Neighbour> first(std::vector<Neighbour> all, std::size_t count) {
    all.resize(std::min(count, all.size()));
    return all;
}

/// The neighbours that for_each_nearest() finds, by index.
std::vector<std::vector<Neighbour>> all_nearest(const PointTree& tree, std::size_t count, unsigned threads) {
    std::vector<std::vector<Neighbour>> by_index(tree.positions().size());
    std::mutex mutex;
    tree.for_each_nearest(count, threads, [&](const NeighbourBatch& batch) {
        const std::lock_guard lock(mutex);
        ASSERT_EQ(batch.neighbours.size(), batch.indices.size() * batch.each);
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            std::vector<Neighbour>& neighbours = by_index[batch.indices[i]];
            EXPECT_TRUE(neighbours.empty()) << "index " << batch.indices[i] << " is in two batches";
            neighbours.assign(batch.of(i).begin(), batch.of(i).end());
        }
    });
    return by_index;
}

TEST(PointTreeNearest, OnALineByHand_TheLowerOfEquallyFarOnesComesFirst) {
    const PointCloud line = test::cloud_of({{5, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 0, 0}});
    const PointTree tree(line.positions.span());
    NeighbourBuffer buffer;
    EXPECT_THAT(tree.nearest(1, 3, buffer), ElementsAre(Neighbour{1, 0}, Neighbour{1, 2}, Neighbour{16, 3}));
    EXPECT_THAT(tree.nearest(1, 1, buffer), ElementsAre(Neighbour{1, 0})) << "the index decides which is left out";
    EXPECT_THAT(tree.nearest(4, 9, buffer),
                ElementsAre(Neighbour{16, 3}, Neighbour{49, 2}, Neighbour{64, 1}, Neighbour{81, 0}));
    EXPECT_THAT(tree.nearest(4, 0, buffer), ElementsAre());
    EXPECT_THAT(tree.within(3, 17, buffer), ElementsAre(Neighbour{9, 2}, Neighbour{16, 1}, Neighbour{16, 4}));
}

TEST(PointTreeNearest, HardClouds_AreAnsweredAsByLookingAtAll) {
    NeighbourBuffer buffer;
    const std::vector<PointCloud> clouds = hard_clouds();
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        const PointTree tree(clouds[i].positions.span());
        for (u32 index = 0; index < tree.positions().size(); index += 3) {
            const std::vector<Neighbour> others = all_others(tree, index);
            for (std::size_t count : {1, 2, 8, 25, 300}) {
                const std::span<const Neighbour> found = tree.nearest(index, count, buffer);
                ASSERT_TRUE(std::ranges::equal(found, first(others, count))) << i << ": " << count << " of " << index;
            }
            const double squared = others[others.size() / 3].squared;
            std::vector<Neighbour> near = others;
            std::erase_if(near, [&](const Neighbour& n) { return !(n.squared < squared); });
            ASSERT_TRUE(std::ranges::equal(tree.within(index, squared, buffer), near)) << i << ": around " << index;
        }
    }
}

TEST(PointTreeNearest, AllAtOnce_AreAnsweredAsOneByOne) {
    const std::vector<PointCloud> clouds = hard_clouds();
    NeighbourBuffer buffer;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        const PointTree tree(clouds[i].positions.span());
        for (std::size_t count : {0, 1, 25, 100}) {
            const auto all = all_nearest(tree, count, 2);
            for (u32 index = 0; index < all.size(); ++index)
                ASSERT_TRUE(std::ranges::equal(all[index], tree.nearest(index, count, buffer)))
                    << i << ": " << count << " of " << index;
        }
    }
}

TEST(PointTreeNearest, ManyPoints_AreAllAnswered_AndThreadsChangeNothing) {
    const PointCloud torus = test::poisson_torus(0.03);
    ASSERT_GT(torus.size(), 10'000u) << "several chunks of several batches";
    const PointTree one(torus.positions.span(), 1), two(torus.positions.span(), 2);
    EXPECT_TRUE(std::ranges::equal(one.positions(), two.positions()));
    EXPECT_TRUE(std::ranges::equal(one.index_of_row(), two.index_of_row()));
    const auto all = all_nearest(one, 25, 1);
    EXPECT_EQ(all, all_nearest(two, 25, 2));
    for (u32 index = 0; index < all.size(); index += 997)
        EXPECT_EQ(all[index], first(all_others(one, index), 25)) << index;
}

TEST(PointTreeNearest, OnePosition_HasNoNeighbours) {
    const PointCloud same = test::cloud_of({{1, 2, 3}, {1, 2, 3}});
    const PointTree tree(same.positions.span(), 2);
    NeighbourBuffer buffer;
    EXPECT_THAT(tree.nearest(0, 3, buffer), ElementsAre());
    EXPECT_THAT(tree.within(0, 1, buffer), ElementsAre());
    EXPECT_THAT(all_nearest(tree, 3, 1), ElementsAre(std::vector<Neighbour>{}));
}

}  // namespace
}  // namespace scanmill
