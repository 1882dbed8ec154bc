// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanmill::runner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ProgressBoard, Workers_HaveALineEach_AndTheWholeHasOne) {
    ProgressBoard board(2, 10);
    const int thing = 0;
    board.started(0, &thing, "a.ply: delaunay", 1);
    board.progressed(&thing, 0.456);
    EXPECT_THAT(board.lines(8.5, 80),
                ElementsAre("  1 a.ply: delaunay 46 % 0:07", "  2 -", "[....................] 0/10 steps, 0:08"));
    board.ended(&thing);
    EXPECT_EQ(board.lines(9, 80).front(), "  1 -");
}

TEST(ProgressBoard, OneWorker_NeedsNoNumber) {
    ProgressBoard board(1, 4);
    board.started(0, &board, "a.ply: read", 0);
    EXPECT_EQ(board.lines(0, 80).front(), "a.ply: read 0:00");
    EXPECT_THAT(ProgressBoard(1, 1).lines(0, 80).back(), HasSubstr("0/1 step, "));
}

TEST(ProgressBoard, TimeLeft_IsShownWhenItIsKnown_AndNeverAsNothing) {
    ProgressBoard board(1, 100);
    for (int i = 0; i < 85; ++i) board.step_ended();
    EXPECT_EQ(board.lines(10, 80).back(), "[#################...] 85/100 steps, 0:10");
    EXPECT_EQ(board.lines(10, 80, 9, 30.0).back(), "[#################...] 85/100 steps, 0:10, about 0:30 left");
    EXPECT_THAT(board.lines(10, 80, 9, 0.1).back(), HasSubstr("about 0:01 left"));
}

TEST(ProgressBoard, SecondAttempt_OfAnotherWorker_EndsTheFirst) {
    ProgressBoard board(2, 1);
    board.started(0, &board, "a.ply: sculpt", 0);
    board.started(1, &board, "a.ply: sculpt", 5);
    EXPECT_THAT(board.lines(7, 80), ElementsAre("  1 -", "  2 a.ply: sculpt 0:02", testing::_));
}

TEST(ProgressBoard, Failures_AreCounted) {
    ProgressBoard board(1, 2);
    board.cell_failed();
    board.cell_failed();
    EXPECT_THAT(board.lines(0, 80).back(), HasSubstr("2 failed"));
}

TEST(ProgressBoard, LongNames_KeepTheirEnd_AndWholeCharacters) {
    ProgressBoard board(1, 2);
    board.started(0, &board, "very/long/folder/Größe.ply: decimate", 0);
    EXPECT_EQ(board.lines(0, 25).front(), "…Größe.ply: decimate 0:00");
    EXPECT_EQ(board.lines(0, 3).front(), "…00") << "never wider than that";
}

TEST(ProgressBoard, WideCharacters_CountTwice) {
    ProgressBoard board(1, 2);
    board.started(0, &board, "日本語日本語.off: read", 0);
    EXPECT_EQ(board.lines(0, 80).front(), "日本語日本語.off: read 0:00");
    EXPECT_EQ(board.lines(0, 27).front(), "日本語日本語.off: read 0:00") << "twelve columns of names and fifteen";
    EXPECT_EQ(board.lines(0, 26).front(), "…本語日本語.off: read 0:00");
    EXPECT_EQ(board.lines(0, 25).front(), "…語日本語.off: read 0:00");
}

TEST(ProgressBoard, LowTerminals_ShowWhoWorks) {
    ProgressBoard board(5, 10);
    board.started(3, &board, "a", 0);
    const std::vector<std::string> lines = board.lines(0, 80, 3);
    EXPECT_THAT(lines, ElementsAre("  4 a 0:00", HasSubstr("0/10 steps")));
    for (int worker = 0; worker < 5; ++worker)
        board.started(static_cast<std::size_t>(worker), &lines[0] + worker, "a", 0);
    EXPECT_EQ(board.lines(0, 80, 3).size(), 3u);
    EXPECT_EQ(board.lines(0, 3, 3).front().size(), 0u + std::string("…0").size() + 1);
}

TEST(ClockText, Examples) {
    EXPECT_EQ(clock_text(7.9), "0:07");
    EXPECT_EQ(clock_text(750), "12:30");
    EXPECT_EQ(clock_text(3725), "1:02:05");
    EXPECT_EQ(clock_text(-1), "0:00");
}

}  // namespace
}  // namespace scanmill::runner
