// SPDX-License-Identifier: GPL-3.0-or-later
// The locks of threads that change one triangulation.
#include <gtest/gtest.h>

#include <future>

#include "delaunay/lock_grid.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {
namespace {

const CGAL::Bbox_3 space(0, 0, 0, 4, 4, 4);
const Vec3 here(0.5, 0.5, 0.5), beside(0.9, 0.1, 0.6), there(3.5, 0.5, 0.5);

/// In a thread of its own, which holds no locks before.
bool other_can_lock(LockGrid& grid, const Vec3& point) {
    return std::async(std::launch::async,
                      [&] {
                          const bool locked = grid.try_lock(point);
                          grid.unlock_all_points_locked_by_this_thread();
                          return locked;
                      })
        .get();
}

TEST(LockGrid, LockedBox_IsRefusedToOtherThreadsOnly) {
    LockGrid grid(space, 4);
    EXPECT_FALSE(grid.is_locked_by_this_thread(here));
    EXPECT_TRUE(grid.try_lock(here));
    EXPECT_TRUE(grid.try_lock(beside)) << "in the same box";
    EXPECT_TRUE(grid.is_locked_by_this_thread(beside));
    EXPECT_FALSE(other_can_lock(grid, beside));
    EXPECT_TRUE(other_can_lock(grid, there));
    grid.unlock_all_points_locked_by_this_thread();
    EXPECT_FALSE(grid.is_locked_by_this_thread(here));
    EXPECT_TRUE(other_can_lock(grid, here));
}

TEST(LockGrid, OneBox_CanBeKept) {
    LockGrid grid(space, 4);
    grid.try_lock(here);
    grid.try_lock(there);
    grid.unlock_all_tls_locked_locations_but_one_point(there);
    EXPECT_TRUE(other_can_lock(grid, here));
    EXPECT_FALSE(other_can_lock(grid, there));
    grid.unlock_all_tls_locked_locations_but_one_point(here);
    EXPECT_TRUE(other_can_lock(grid, there));
    EXPECT_FALSE(grid.is_locked_by_this_thread(here)) << "it was not locked";
}

TEST(LockGrid, PointsOnTheBorderAndOutside_BelongToTheOuterBoxes) {
    LockGrid grid(space, 4);
    grid.try_lock(Vec3(4, 4, 4));
    EXPECT_TRUE(grid.is_locked_by_this_thread(Vec3(3.1, 3.1, 3.1)));
    EXPECT_TRUE(grid.is_locked_by_this_thread(Vec3(9, 9, 9)));
    EXPECT_FALSE(grid.is_locked_by_this_thread(Vec3(-1, 9, 9)));
    grid.unlock_all_points_locked_by_this_thread();
}

TEST(LockGrid, LocksLeftInAnotherGrid_AreNotReleasedInThisOne) {
    {
        LockGrid failed(space, 4);
        failed.try_lock(here);
    }
    LockGrid grid(space, 4);
    std::promise<void> locked, done;
    std::thread other([&] {
        grid.try_lock(here);
        locked.set_value();
        done.get_future().wait();
        grid.unlock_all_points_locked_by_this_thread();
    });
    locked.get_future().wait();
    grid.unlock_all_points_locked_by_this_thread();
    EXPECT_FALSE(other_can_lock(grid, here));
    done.set_value();
    other.join();
}

}  // namespace
}  // namespace scanmill
