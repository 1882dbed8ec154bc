// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/lists.hpp"

#include <gmock/gmock.h>

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Lists, KeepTheOrderOfTheirElements) {
    const Lists<double> lists(4, [](auto&& add) {
        add(2, 0.5);
        add(0, 7.0);
        add(2, -1.0);
    });
    EXPECT_THAT(lists[0], ElementsAre(7));
    EXPECT_THAT(lists[1], IsEmpty());
    EXPECT_THAT(lists[2], ElementsAre(0.5, -1));
    EXPECT_THAT(lists[3], IsEmpty());
    EXPECT_TRUE(Lists<>().empty());
}

}  // namespace
}  // namespace scanmill::test
