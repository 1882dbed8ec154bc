// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/point_tree.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;

std::vector<double> squares(std::span<const Neighbour> neighbours) {
    std::vector<double> result;
    for (const Neighbour& neighbour : neighbours) result.push_back(neighbour.squared);
    return result;
}

std::vector<u32> indices(std::span<const Neighbour> neighbours) {
    std::vector<u32> result;
    for (const Neighbour& neighbour : neighbours) result.push_back(neighbour.index);
    return result;
}

const PointCloud on_a_line = test::cloud_of({{5, 0, 0}, {0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {3, 0, 0}, {-0.0, 0, 0}});

TEST(PointTree, Positions_AreDistinctAndAscend) {
    const PointTree tree(on_a_line.positions.span());
    EXPECT_THAT(tree.positions(), ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0), Vec3(5, 0, 0)));
    EXPECT_THAT(tree.index_of_row(), ElementsAre(3, 0, 1, 3, 2, 0));
}

TEST(PointTree, Nearest_CountsOtherPositionsOnly_AndAllWhenThereAreFewer) {
    NeighbourBuffer buffer;
    const PointTree tree(on_a_line.positions.span());
    EXPECT_THAT(squares(tree.nearest(1, 2, buffer)), ElementsAre(1, 4));
    EXPECT_THAT(squares(tree.nearest(3, 9, buffer)), ElementsAre(4, 16, 25));
    EXPECT_THAT(squares(tree.nearest(0, 0, buffer)), ElementsAre());
    const Vec3 one(1, 2, 3);
    EXPECT_THAT(PointTree(std::span(&one, 1)).nearest(0, 3, buffer), ElementsAre());
}

TEST(PointTree, NearestToAnyPoint_CountsAPositionThere_AndAllWhenThereAreFewer) {
    NeighbourBuffer buffer;
    const PointTree tree(on_a_line.positions.span());
    EXPECT_THAT(squares(tree.nearest_to({3, 0, 0}, 3, buffer)), ElementsAre(0, 4, 4));
    EXPECT_THAT(indices(tree.nearest_to({3, 0, 0}, 3, buffer)), ElementsAre(2, 1, 3)) << "ties by index";
    EXPECT_THAT(squares(tree.nearest_to({3, 2, 0}, 1, buffer)), ElementsAre(4));
    EXPECT_THAT(squares(tree.nearest_to({0, 0, 0}, 9, buffer)), ElementsAre(0, 1, 9, 25));
    EXPECT_THAT(squares(tree.nearest_to({0, 0, 0}, 0, buffer)), ElementsAre());
}

TEST(PointTree, NearestToAnyPoint_AreThoseOfAllPoints) {
    const PointCloud cloud = test::random_cube(2000, 7), queries = test::random_cube(200, 8, 3);
    const PointTree tree(cloud.positions.span());
    NeighbourBuffer buffer;
    for (const Vec3& query : queries.positions) {
        std::vector<double> all;
        for (const Vec3& p : tree.positions()) {
            const Vec3 d = p - query;
            all.push_back((d.x() * d.x() + d.y() * d.y()) + d.z() * d.z());
        }
        std::ranges::sort(all);
        all.resize(9);
        EXPECT_EQ(squares(tree.nearest_to(query, 9, buffer)), all);
    }
}

TEST(PointTree, Within_IsOpenAtItsBorder) {
    NeighbourBuffer buffer;
    const PointTree tree(on_a_line.positions.span());
    EXPECT_THAT(indices(tree.within(1, 4, buffer)), ElementsAre(0));
    EXPECT_THAT(indices(tree.within(1, std::nextafter(4, 5), buffer)), ElementsAre(0, 2));
    EXPECT_THAT(indices(tree.within(1, 0, buffer)), ElementsAre());
    EXPECT_THAT(indices(tree.within(0, 1e300, buffer)), ElementsAre(1, 2, 3));
}

TEST(PointTree, TinyAndHugeClouds_AreAnsweredAlike) {
    for (double factor : {0x1p-100, 0x1p100}) {
        const PointCloud cloud = test::moved(test::lattice_cube(3), factor);
        const PointTree tree(cloud.positions.span());
        NeighbourBuffer buffer;
        EXPECT_EQ(squares(tree.nearest(21, 6, buffer)), std::vector<double>(6, factor * factor));
        EXPECT_EQ(tree.within(21, 1.5 * factor * factor, buffer).size(), 6u);
    }
}

}  // namespace
}  // namespace scanmill
