// SPDX-License-Identifier: GPL-3.0-or-later
/// The tree's answers beside those of looking at every place, on clouds that are hard on trees.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "scanmill/base/random.hpp"
#include "scanmill/geometry/spatial/point_tree.hpp"
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

/// Two crowds a thousand diameters apart, and somebody between them.
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
            test::moved(test::lattice_cube(4), 0x1p-600),  // squares are 0: all are equally far
            test::moved(test::random_cube(50, 5), 0x1p600),  // and here they are infinite
            test::cloud_of({{1, 2, 3}, {1, 2, 3}, {4, 5, 6}})};
}

std::vector<Neighbour> all_others(const PointTree& tree, u32 place) {
    std::vector<Neighbour> others;
    for (u32 other = 0; other < tree.places().size(); ++other) {
        const Vec3 d = tree.places()[other] - tree.places()[place];
        if (other != place) others.push_back({(d.x() * d.x() + d.y() * d.y()) + d.z() * d.z(), other});
    }
    std::ranges::sort(others, {}, [](const Neighbour& n) { return std::pair(n.squared, n.place); });
    return others;
}

std::vector<Neighbour> first(std::vector<Neighbour> all, std::size_t count) {
    all.resize(std::min(count, all.size()));
    return all;
}

/// By place, the neighbours that for_each_nearest tells.
std::vector<std::vector<Neighbour>> told(const PointTree& tree, std::size_t count, unsigned threads) {
    std::vector<std::vector<Neighbour>> by_place(tree.places().size());
    std::mutex mutex;
    tree.for_each_nearest(count, threads, [&](const NeighbourBatch& batch) {
        const std::lock_guard lock(mutex);
        ASSERT_EQ(batch.neighbours.size(), batch.places.size() * batch.each);
        for (std::size_t i = 0; i < batch.places.size(); ++i) {
            std::vector<Neighbour>& neighbours = by_place[batch.places[i]];
            EXPECT_TRUE(neighbours.empty()) << "place " << batch.places[i] << " is told twice";
            neighbours.assign(batch.of(i).begin(), batch.of(i).end());
        }
    });
    return by_place;
}

TEST(PointTreeNearest, OnALineByHand_TheLowerOfEquallyFarOnesComesFirst) {
    const PointCloud line = test::cloud_of({{5, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 0, 0}});
    const PointTree tree(line.positions.span());
    NeighbourBuffer buffer;
    EXPECT_THAT(tree.nearest(1, 3, buffer), ElementsAre(Neighbour{1, 0}, Neighbour{1, 2}, Neighbour{16, 3}));
    EXPECT_THAT(tree.nearest(1, 1, buffer), ElementsAre(Neighbour{1, 0})) << "the number decides who is left out";
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
        for (u32 place = 0; place < tree.places().size(); place += 3) {
            const std::vector<Neighbour> others = all_others(tree, place);
            for (std::size_t count : {1, 2, 8, 25, 300}) {
                const std::span<const Neighbour> found = tree.nearest(place, count, buffer);
                ASSERT_TRUE(std::ranges::equal(found, first(others, count))) << i << ": " << count << " of " << place;
            }
            const double squared = others[others.size() / 3].squared;
            std::vector<Neighbour> near = others;
            std::erase_if(near, [&](const Neighbour& n) { return !(n.squared < squared); });
            ASSERT_TRUE(std::ranges::equal(tree.within(place, squared, buffer), near)) << i << ": around " << place;
        }
    }
}

TEST(PointTreeNearest, AllAtOnce_AreAnsweredAsOneByOne) {
    const std::vector<PointCloud> clouds = hard_clouds();
    NeighbourBuffer buffer;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        const PointTree tree(clouds[i].positions.span());
        for (std::size_t count : {0, 1, 25, 100}) {
            const auto all = told(tree, count, 2);
            for (u32 place = 0; place < all.size(); ++place)
                ASSERT_TRUE(std::ranges::equal(all[place], tree.nearest(place, count, buffer)))
                    << i << ": " << count << " of " << place;
        }
    }
}

TEST(PointTreeNearest, ManyPoints_AreAllTold_AndThreadsChangeNothing) {
    const PointCloud torus = test::poisson_torus(0.03);
    ASSERT_GT(torus.size(), 10'000u) << "several chunks of several batches";
    const PointTree one(torus.positions.span(), 1), two(torus.positions.span(), 2);
    EXPECT_TRUE(std::ranges::equal(one.places(), two.places()));
    EXPECT_TRUE(std::ranges::equal(one.place_of_row(), two.place_of_row()));
    const auto all = told(one, 25, 1);
    EXPECT_EQ(all, told(two, 25, 2));
    for (u32 place = 0; place < all.size(); place += 997)
        EXPECT_EQ(all[place], first(all_others(one, place), 25)) << place;
}

TEST(PointTreeNearest, OnePlace_HasNoNeighbours) {
    const PointCloud same = test::cloud_of({{1, 2, 3}, {1, 2, 3}});
    const PointTree tree(same.positions.span(), 2);
    NeighbourBuffer buffer;
    EXPECT_THAT(tree.nearest(0, 3, buffer), ElementsAre());
    EXPECT_THAT(tree.within(0, 1, buffer), ElementsAre());
    EXPECT_THAT(told(tree, 3, 1), ElementsAre(std::vector<Neighbour>{}));
}

}  // namespace
}  // namespace scanmill
