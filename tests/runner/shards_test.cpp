// SPDX-License-Identifier: GPL-3.0-or-later
// `batch --shard` and `runs merge`: the merged shards are the run of one machine.

#include "runner/divided_batch.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class Shards : public DividedBatch {};

TEST_F(Shards, MergedInAnyOrder_AreTheRunOfOneMachine) {
    scanmill({"batch", "b.yaml", "-o", "one", "-q", "--no-cache"});
    const auto outputs_of_one = outputs("one");
    ASSERT_GE(outputs_of_one.size(), 2u * 8);
    for (const int count : {1, 3, 7, 8}) {
        SCOPED_TRACE(count);
        run_shards(count);
        const std::string out = "whole" + std::to_string(count);
        const ProgramResult merged = merge_shuffled("p", count, 3, out);
        EXPECT_EQ(merged.exit_code, 1) << merged.err << "cells with two points fail, as in one run";
        EXPECT_EQ(report(out), report("one"));
        EXPECT_THAT(differences(outputs(out), outputs_of_one), testing::IsEmpty());
        for (int number = 1; number <= count; ++number) {
            const std::string folder = "p" + std::to_string(number);
            EXPECT_TRUE(outputs(folder).empty()) << "the outputs were moved";
            fs::remove_all(folder_ / folder);
        }
    }
}

TEST_F(Shards, ExitCodesAndGate_AreThoseOfOneRun) {
    run_shards(2);
    EXPECT_EQ(merge({"p1", "p2"}).exit_code, 1);
    scanmill({"report", "whole", "--accept", "--who", "Ann", "--why", "x"});
    write_batch("points: +0 %");
    folder_.write("scans/s3.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 5\n9 9 9\n");
    run_shards(2);
    const ProgramResult merged = merge({"p1", "p2"});
    EXPECT_EQ(merged.exit_code, 4) << merged.out << merged.err;
    EXPECT_THAT(merged.out, HasSubstr("b: regressed"));
    EXPECT_THAT(scanmill({"runs", "whole"}).out, HasSubstr("2"));
}

TEST_F(Shards, AFolderThatWasMoved_IsMergedAllTheSame) {
    run_shards(2);
    fs::create_directories(folder_ / "fetched");
    fs::rename(folder_ / "p2", folder_ / "fetched/second");
    EXPECT_EQ(merge({"p1", "fetched/second"}).exit_code, 1);
    EXPECT_TRUE(fs::exists(folder_ / "whole/s1-bin-size=0.1u.ply"));
    for (const nlohmann::json cells = report("whole")["cells"]; const nlohmann::json& cell : cells)
        EXPECT_NE(cell["verdict"], "missing");
}

TEST_F(Shards, AnInterruptedMerge_IsRepeated) {
    run_shards(2);
    fs::create_directories(folder_ / "whole");
    fs::rename(folder_ / "p1/s0-bin-size=0.1u.ply", folder_ / "whole/s0-bin-size=0.1u.ply");
    EXPECT_EQ(merge({"p1", "p2"}).exit_code, 1);
    EXPECT_TRUE(fs::exists(folder_ / "whole/s0-bin-size=0.1u.ply"));
}

TEST_F(Shards, WhatDoesNotFit_IsRefusedAndNothingMoves) {
    run_shards(3);
    const auto before = outputs("p1");
    const auto expect_refusal = [&](const std::vector<std::string>& folders, const std::string& sentence) {
        const ProgramResult merged = merge(folders);
        EXPECT_EQ(merged.exit_code, 2);
        EXPECT_THAT(merged.err, AllOf(HasSubstr(sentence), HasSubstr("hint: ")));
        EXPECT_FALSE(fs::exists(folder_ / "whole/scanmill.sqlite"));
        EXPECT_EQ(outputs("p1"), before);
    };
    expect_refusal({"p1", "p3"}, "1 shard is missing: 2/3");
    expect_refusal({"p1", "p2", "p2", "p3"}, "shard 2/3 is given twice: in 'p2' and in 'p2'");
    shard("2/4", "of4");
    expect_refusal({"p1", "of4", "p3"}, "the number of shards differs, '3' and '4'");
    scanmill({"batch", "b.yaml", "--shard", "2/3", "-o", "seeded", "-q", "--seed", "5"});
    expect_refusal({"p1", "seeded", "p3"}, "the seed differs, '0' and '5'");
    scanmill({"batch", "b.yaml", "-o", "one", "-q"});
    expect_refusal({"p1", "one", "p3"}, "the last run in 'one' is no shard");
    expect_refusal({"p1", "nowhere", "p3"}, "nowhere");
    folder_.write("scans/s8.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 9\n");
    shard("2/3", "changed");
    expect_refusal({"p1", "changed", "p3"}, "the batch's scans, workflows or values were changed between them");
    folder_.write("p2/s1-bin-size=0.1u.ply", "mine");
    expect_refusal({"p1", "p2", "p3"}, "is missing or has changed");
}

TEST_F(Shards, WrongNumbers_AreRefused) {
    EXPECT_THAT(shard("8/7", "p").err, AllOf(HasSubstr("there is no shard 8/7"), HasSubstr("the last shard is 7/7")));
    EXPECT_THAT(shard("0/3", "p").err, HasSubstr("there is no shard 0/3"));
    EXPECT_THAT(shard("x", "p").err, HasSubstr("'x' is not a shard; expected two numbers, as 3/7"));
    EXPECT_THAT(shard("9/9", "p").err, HasSubstr("the batch can be divided into at most 8 shards"));
    EXPECT_EQ(shard("1/0", "p").exit_code, 2);
    EXPECT_EQ(scanmill({"batch", "b.yaml", "--shard", "1/2", "--scan", "scans/s1.xyz"}).exit_code, 2);
    EXPECT_EQ(scanmill({"runs"}).exit_code, 2);
    EXPECT_EQ(scanmill({"runs", "merge", "p1"}).exit_code, 2) << "-o is missing";
}

}  // namespace
}  // namespace scanmill::test
