// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/point_tree.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;

const PointCloud on_a_line = test::cloud_of({{5, 0, 0}, {0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {3, 0, 0}, {-0.0, 0, 0}});

TEST(PointTree, Places_AreDistinctAndAscend) {
    const PointTree tree(on_a_line.positions.span());
    EXPECT_THAT(tree.places(), ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0), Vec3(5, 0, 0)));
    EXPECT_THAT(tree.place_of_row(), ElementsAre(3, 0, 1, 3, 2, 0));
}

TEST(PointTree, Nearest_CountsOtherPlacesOnly_AndAllWhenThereAreFewer) {
    const PointTree tree(on_a_line.positions.span());
    EXPECT_THAT(tree.nearest(1, 2), ElementsAre(1, 4));
    EXPECT_THAT(tree.nearest(3, 9), ElementsAre(4, 16, 25));
    EXPECT_THAT(tree.nearest(0, 0), ElementsAre());
    const Vec3 one(1, 2, 3);
    EXPECT_THAT(PointTree(std::span(&one, 1)).nearest(0, 3), ElementsAre());
}

TEST(PointTree, Within_IsOpenAtItsBorder) {
    const PointTree tree(on_a_line.positions.span());
    EXPECT_THAT(tree.within(1, 4), ElementsAre(0));
    EXPECT_THAT(tree.within(1, std::nextafter(4, 5)), ElementsAre(0, 2));
    EXPECT_THAT(tree.within(1, 0), ElementsAre());
    EXPECT_THAT(tree.within(0, 1e300), ElementsAre(1, 2, 3));
}

TEST(PointTree, TinyAndHugeClouds_AreAnsweredAlike) {
    for (double factor : {0x1p-100, 0x1p100}) {
        const PointCloud cloud = test::moved(test::lattice_cube(3), factor);
        const PointTree tree(cloud.positions.span());
        EXPECT_EQ(tree.nearest(21, 6), std::vector<double>(6, factor * factor));
        EXPECT_EQ(tree.within(21, 1.5 * factor * factor).size(), 6u);
    }
}

}  // namespace
}  // namespace scanmill
