// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/box_tree.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

BoundingBox box_at(const Vec3& centre, double half) {
    BoundingBox box;
    box.add(centre - Vec3::Constant(half));
    box.add(centre + Vec3::Constant(half));
    return box;
}

BoundingBox random_box(Random& random, double size) {
    return box_at(Vec3(random.uniform(), random.uniform(), random.uniform()), size * random.uniform());
}

bool meet(const BoundingBox& one, const BoundingBox& other, double slack) {
    return ((one.low.array() - slack) <= other.high.array()).all() &&
           ((other.low.array() - slack) <= one.high.array()).all();
}

std::vector<u32> found_by(const BoxTree& tree, const BoundingBox& query, u32 stamp = 0) {
    std::vector<u32> items;
    tree.for_each_meeting(
        query, [&](u32 item) { items.push_back(item); }, stamp);
    std::ranges::sort(items);
    return items;
}

std::vector<u32> found_by_all(const std::vector<BoundingBox>& boxes, const BoundingBox& query, double slack = 0) {
    std::vector<u32> items;
    for (u32 i = 0; i < boxes.size(); ++i)
        if (!boxes[i].empty() && meet(boxes[i], query, slack)) items.push_back(i);
    return items;
}

/// Floats round boxes outwards, so a few more than those of `boxes` may be found, but none farther than `slack`.
void expect_same(const BoxTree& tree, const std::vector<BoundingBox>& boxes, const BoundingBox& query, double slack) {
    const std::vector<u32> found = found_by(tree, query);
    EXPECT_EQ(std::ranges::adjacent_find(found), found.end()) << "no item twice";
    EXPECT_THAT(found, IsSupersetOf(found_by_all(boxes, query)));
    EXPECT_THAT(found_by_all(boxes, query, slack), IsSupersetOf(found));
}

TEST(BoxTree, RandomBoxes_AreFoundAsByLookingAtAll) {
    for (const u32 count : {1u, 2u, 4u, 5u, 16u, 17u, 63u, 65u, 300u, 1500u}) {
        Random random(count);
        std::vector<BoundingBox> boxes;
        for (u32 i = 0; i < count; ++i) boxes.push_back(i % 7 == 3 ? BoundingBox{} : random_box(random, 0.1));
        const BoxTree tree(boxes);
        EXPECT_EQ(tree.leaves(), tree.size());
        EXPECT_EQ(tree.size(), static_cast<std::size_t>(std::ranges::count(boxes, false, &BoundingBox::empty)));
        for (int i = 0; i < 50; ++i) expect_same(tree, boxes, random_box(random, i % 5 == 0 ? 1 : 0.2), 1e-6);
    }
}

TEST(BoxTree, Changes_AreFoundAtOnce) {
    Random random(1);
    std::vector<BoundingBox> boxes;
    for (int i = 0; i < 500; ++i) boxes.push_back(random_box(random, 0.05));
    BoxTree tree(boxes);
    std::size_t there = boxes.size();
    for (int change = 0; change < 3000; ++change) {
        const u32 item = static_cast<u32>(random.index(boxes.size()));
        // Grow, shrink, move, remove and bring back.
        const bool is_removal = change % 3 == 0;
        there -= !boxes[item].empty();
        boxes[item] = is_removal ? BoundingBox{} : random_box(random, change % 2 == 0 ? 0.01 : 0.2);
        there += !boxes[item].empty();
        tree.change(item, boxes[item]);
        EXPECT_EQ(tree.size(), there);
        EXPECT_EQ(tree.leaves(), 500u);
        expect_same(tree, boxes, random_box(random, 0.2), 1e-6);
    }
    for (u32 item = 0; item < boxes.size(); ++item) tree.change(item, {});
    EXPECT_EQ(tree.size(), 0u);
    EXPECT_THAT(found_by(tree, box_at(Vec3::Zero(), 100)), IsEmpty());
}

TEST(BoxTree, Stamps_SkipOnlyWhatDidNotChangeSince) {
    Random random(2);
    std::vector<BoundingBox> boxes;
    for (int i = 0; i < 400; ++i) boxes.push_back(random_box(random, 0.05));
    BoxTree tree(boxes);
    std::vector<u32> stamps(boxes.size(), 0);
    const BoundingBox all = box_at(Vec3::Constant(0.5), 10);
    EXPECT_THAT(found_by(tree, all, 1), IsEmpty()) << "nothing has changed";
    for (u32 stamp = 1; stamp <= 60; ++stamp) {
        for (int change = 0; change < 5; ++change) {
            const u32 item = static_cast<u32>(random.index(boxes.size()));
            // A box that stays the same is a change too.
            if (change > 0) boxes[item] = change == 1 ? BoundingBox{} : random_box(random, 0.05);
            tree.change(item, boxes[item], stamp);
            stamps[item] = stamp;
        }
        for (const u32 since : {stamp, stamp > 3 ? stamp - 3 : 0, stamp + 1}) {
            const std::vector<u32> found = found_by(tree, all, since);
            std::vector<u32> changed;
            for (u32 i = 0; i < boxes.size(); ++i)
                if (stamps[i] >= since && !boxes[i].empty()) changed.push_back(i);
            EXPECT_THAT(found, IsSupersetOf(changed)) << stamp << " since " << since;
            // Neighbours of the changed items come with them, not everything.
            EXPECT_LE(found.size(), since > stamp ? 0u : since == stamp ? 5u * 4u : boxes.size());
        }
    }
}

TEST(BoxTree, Borders_Meet) {
    const std::vector<BoundingBox> boxes{box_at(Vec3(0, 0, 0), 1), box_at(Vec3(3, 0, 0), 1)};
    const BoxTree tree(boxes);
    EXPECT_THAT(found_by(tree, box_at(Vec3(1.5, 0, 0), 0.5)), ElementsAre(0, 1));
    EXPECT_THAT(found_by(tree, box_at(Vec3(1.5, 0, 0), 0.49)), IsEmpty());
    EXPECT_THAT(found_by(tree, box_at(Vec3(4, 1, 1), 0)), ElementsAre(1)) << "a corner, a point as query";
}

TEST(BoxTree, CoordinatesThatFloatsDoNotHold_AreRoundedOutwards) {
    Random random(3);
    std::vector<BoundingBox> boxes;
    const Vec3 far(1e8 + 0.3, -1e8 - 0.7, 1e-30);
    for (int i = 0; i < 200; ++i)
        boxes.push_back(box_at(far + 40 * Vec3(random.uniform(), random.uniform(), random.uniform()), 0.4));
    const BoxTree tree(boxes);
    for (const BoundingBox& box : boxes) {
        expect_same(tree, boxes, box, 33);
        const Vec3 corner = box.high;
        expect_same(tree, boxes, box_at(corner, 0), 33);
    }
}

TEST(BoxTree, WithoutBoxes_FindsNothing) {
    EXPECT_THAT(found_by(BoxTree({}), box_at(Vec3::Zero(), 1)), IsEmpty());
    const std::vector<BoundingBox> empty(5);
    const BoxTree tree(empty);
    EXPECT_EQ(tree.size() + tree.leaves(), 0u);
    EXPECT_THAT(found_by(tree, box_at(Vec3::Zero(), 1)), IsEmpty());
}

}  // namespace
}  // namespace scanmill
