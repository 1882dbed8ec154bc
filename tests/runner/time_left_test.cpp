// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/time_left.hpp"

#include <gtest/gtest.h>

namespace scanmill::runner {
namespace {

/// Begins a task and ends it after `seconds`.
void pass(TimeLeft& left, std::size_t task, double at, double seconds) {
    left.started(task, at);
    left.ended(task, at + seconds, true);
}

TEST(TimeLeft, IsUnknown_UntilATaskOfEveryKindHasEnded) {
    TimeLeft left(1);
    for (int scan = 0; scan < 3; ++scan) {
        left.add(0, static_cast<std::size_t>(scan), 1);
        left.add(1, static_cast<std::size_t>(scan), 1);
    }
    EXPECT_FALSE(left.seconds(0));
    pass(left, 0, 0, 2);
    EXPECT_FALSE(left.seconds(2)) << "reading took 2 s; how long the step takes is not known";
    pass(left, 1, 2, 10);
    EXPECT_DOUBLE_EQ(*left.seconds(12), 24) << "two scans of 2 s and 10 s";
    left.started(2, 12);
    EXPECT_DOUBLE_EQ(*left.seconds(13), 23);
}

TEST(TimeLeft, TasksTakeTimeInProportionToTheirSize) {
    TimeLeft left(1);
    left.add(0, 0, 100);
    left.add(0, 1, 1000);
    pass(left, 0, 0, 3);
    EXPECT_DOUBLE_EQ(*left.seconds(3), 30);
}

TEST(TimeLeft, WorkersShareGroups_ButNotOneGroup) {
    TimeLeft left(4);
    for (std::size_t task = 0; task < 9; ++task) left.add(0, task < 5 ? task : 5, 1);
    pass(left, 0, 0, 10);
    EXPECT_DOUBLE_EQ(*left.seconds(10), 40) << "four groups of 10 s beside one of 40 s";
    for (std::size_t task = 1; task < 5; ++task) pass(left, task, 10, 10);
    EXPECT_DOUBLE_EQ(*left.seconds(20), 40) << "three workers have nothing to do";
    left.started(5, 20);
    left.started(6, 20);
    EXPECT_DOUBLE_EQ(*left.seconds(20), 20) << "two workers share it after all";
}

/// Many short steps, then a long one: what it takes is not what the others took.
TEST(TimeLeft, LastTaskThatTakesLongerThanOthers_IsUnknown) {
    TimeLeft left(1);
    for (std::size_t task = 0; task < 20; ++task) left.add(0, task, 1);
    for (std::size_t task = 0; task < 19; ++task) pass(left, task, static_cast<double>(task), 1);
    left.started(19, 19);
    EXPECT_DOUBLE_EQ(*left.seconds(19.25), 0.75);
    EXPECT_FALSE(left.seconds(25));
    left.progressed(19, 0.25);
    EXPECT_DOUBLE_EQ(*left.seconds(29), 30) << "a quarter took 10 s";
    left.progressed(19, 1);
    EXPECT_FALSE(left.seconds(29)) << "it says it is done and goes on";
}

TEST(TimeLeft, OneSlowTaskAmongMany_LeavesTheRestKnown) {
    TimeLeft left(1);
    for (std::size_t task = 0; task < 100; ++task) left.add(0, task, 1);
    pass(left, 0, 0, 1);
    left.started(1, 1);
    EXPECT_DOUBLE_EQ(*left.seconds(3), 98 + 2) << "it may take as long again";
}

TEST(TimeLeft, FailedAndDroppedTasks_TeachNothing) {
    TimeLeft left(1);
    for (std::size_t task = 0; task < 4; ++task) left.add(0, task, 1);
    pass(left, 0, 0, 10);
    left.started(1, 10);
    left.ended(1, 10.1, false);
    EXPECT_DOUBLE_EQ(*left.seconds(10.1), 20);
    left.dropped(2);
    EXPECT_DOUBLE_EQ(*left.seconds(10.1), 10);
    left.dropped(3);
    EXPECT_FALSE(left.seconds(10.1));
}

TEST(TimeLeft, FurtherPasses_TakeAsLongAsTheOneBefore) {
    TimeLeft left(1, 3);
    left.add(0, 0, 1);
    left.add(0, 1, 1);
    pass(left, 0, 0, 10);
    EXPECT_DOUBLE_EQ(*left.seconds(10), 10 + 2 * 20);
    pass(left, 1, 10, 10);
    EXPECT_FALSE(left.seconds(20)) << "between two passes";
    left.pass_started(2, 20);
    EXPECT_DOUBLE_EQ(*left.seconds(25), 15 + 20);
    left.pass_started(3, 38);
    EXPECT_DOUBLE_EQ(*left.seconds(40), 16) << "the second took 18 s, without outputs";
    EXPECT_FALSE(left.seconds(57)) << "longer than the one before";
}

TEST(TimeLeft, TaskThatRunsAgain_CountsAgain) {
    TimeLeft left(1);
    left.add(0, 0, 1);
    left.add(0, 1, 1);
    pass(left, 0, 0, 4);
    pass(left, 1, 4, 4);
    EXPECT_FALSE(left.seconds(8));
    left.started(0, 8);
    EXPECT_DOUBLE_EQ(*left.seconds(9), 3);
}

}  // namespace
}  // namespace scanmill::runner
