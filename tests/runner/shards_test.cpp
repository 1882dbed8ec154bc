// SPDX-License-Identifier: GPL-3.0-or-later
// `batch --shard` and `runs merge`: the merged shards are the run of one machine.

#include <sys/mount.h>
#include <unistd.h>

#include <functional>

#include "runner/divided_batch.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class Shards : public DividedBatch {
protected:
    /// Changes the record of the only run in the folder.
    void change_record(const std::string& folder, const std::function<void(RunDetails&)>& change) {
        const fs::path file = folder_ / folder / records_file;
        RunDetails run = RunRecords::read(file).run(1);
        change(run);
        fs::remove(file);
        RunRecords records = RunRecords::append_to(file);
        records.end(records.begin(run.start, run.summary.started), run.steps, run.cells, run.summary.outcome.value(),
                    run.summary.seconds);
    }
    void expect_refusal(const std::vector<std::string>& folders, const std::string& sentence) {
        const ProgramResult merged = merge(folders);
        EXPECT_EQ(merged.exit_code, 2);
        EXPECT_THAT(merged.err, AllOf(HasSubstr(sentence), HasSubstr("hint: ")));
        EXPECT_FALSE(fs::exists(folder_ / "whole/scanmill.sqlite"));
    }
};

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

/// A scan that fails in each of these modes, in a shard of its own.
TEST_F(Shards, OnlyFailuresOfTheMachine_AskForAnotherRun) {
    folder_.write("m.yaml",
                  "scanmill: 1\nname: m\ninputs: {scan: points}\nparameters: {mode: pass}\nsteps:\n"
                  "  - test-step: {mode: $mode}\noutputs: {'{scan}.ply': test-step.points}\n");
    const auto code = [&](const std::string& modes) {
        std::string scans;
        for (std::size_t i = 0; i < modes.size();) {
            const std::size_t end = std::min(modes.find(' ', i), modes.size());
            scans += (scans.empty() ? "" : ", ") + std::string("{path: scans/s") + std::to_string(i) +
                     ".xyz, set: {mode: " + modes.substr(i, end - i) + "}}";
            fs::copy_file(folder_ / "scans/s1.xyz", folder_ / ("scans/s" + std::to_string(i) + ".xyz"),
                          fs::copy_options::skip_existing);
            i = end + 1;
        }
        folder_.write("modes.yaml", "scanmill: 1\nbatch: modes\nscans: [" + scans + "]\nworkflows: m.yaml\n");
        fs::remove_all(folder_ / "one");
        return scanmill({"batch", "modes.yaml", "--shard", "1/1", "-o", "one", "-q"}).exit_code;
    };
    for (const char* mode : {"fail", "throw", "crash", "exit", "undeclared-metric"}) EXPECT_EQ(code(mode), 1) << mode;
    for (const char* modes : {"kill", "out-of-memory", "undeclared-metric kill"}) EXPECT_EQ(code(modes), 5) << modes;
}

/// The user limits the size of files, which another machine does not change.
TEST_F(Shards, OutputThatMayNotBeWritten_DoesNotAskForAnotherRun) {
    folder_.write("large.yaml",
                  "scanmill: 1\nname: large\nsteps:\n  - virtual-scan: {shape: sphere, size: 100 u, views: [12], "
                  "resolution: 1 u}\noutputs: {'large.ply': virtual-scan}\n");
    folder_.write("b.yaml", "scanmill: 1\nbatch: b\nworkflows: [large.yaml]\n");
    ProgramOptions limited = options();
    limited.file_limit = 1'000'000;
    const ProgramResult result =
        scanmill_program({"batch", "b.yaml", "--shard", "1/1", "-o", "p1", "-q", "--no-cache"}, limited);
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("File too large"));
}

/// On a disk that becomes full, the shard is repeated whether an output or the records could not be written.
TEST_F(Shards, FullDisk_AsksForAnotherRun) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root may mount a small disk";
    const fs::path disk = folder_ / "p1";
    fs::create_directories(disk);
    if (::mount("none", disk.c_str(), "tmpfs", 0, "size=200k") != 0) GTEST_SKIP() << "no disk can be mounted here";
    EXPECT_EQ(shard("1/1", "p1").exit_code, 5);
    ::umount(disk.c_str());
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
    EXPECT_EQ(outputs("p1"), before);
}

TEST_F(Shards, OfAnotherBatch_AreRefused) {
    run_shards(2);
    folder_.write("other.yaml",
                  "scanmill: 1\nbatch: other\nscans: [\"scans/*.xyz\"]\nworkflows: [w.yaml, all.yaml]\n"
                  "gate: {points: exact}\n");
    scanmill({"batch", "other.yaml", "--shard", "2/2", "-o", "other", "-q"});
    expect_refusal({"p1", "other"}, "the batch differs, 'b' and 'other'");
    write_batch("points: +1 %");
    shard("2/2", "gated");
    expect_refusal({"p1", "gated"}, "the gate differs, 'points exact' and 'points +1 %'");
}

TEST_F(Shards, OfAnotherVersionOrBuild_AreRefused) {
    run_shards(2);
    change_record("p2", [](RunDetails& run) { run.start.version = "0.0.9"; });
    expect_refusal({"p1", "p2"}, "the version of Scanmill differs");
    shard("2/2", "again");
    change_record("again", [](RunDetails& run) {
        for (StepRecord& step : run.steps)
            if (step.filter == "voxel-thin") step.build = "0123";
    });
    expect_refusal({"p1", "again"}, "they ran different builds of the filter 'voxel-thin'");
    EXPECT_EQ(merge({"p1", "p2"}).exit_code, 2);
}

TEST_F(Shards, OnMachinesWhoseClocksDisagree_AreMergedInTheOrderOfTheBatch) {
    scanmill({"batch", "b.yaml", "-o", "one", "-q", "--no-cache"});
    run_shards(3);
    double longest = 0;
    const auto started = [&](const std::string& time) {
        return [&, time](RunDetails& run) {
            run.summary.started = time;
            longest = std::max(longest, run.summary.seconds);
        };
    };
    change_record("p1", started("2026-03-01T03:00:00.000Z"));
    change_record("p2", started("2026-03-01T01:00:00.000Z"));
    change_record("p3", started("2026-03-01T02:00:00.000Z"));
    EXPECT_EQ(merge({"p2", "p1", "p3"}).exit_code, 1);
    EXPECT_EQ(report("whole"), report("one"));
    EXPECT_THAT(differences(outputs("whole"), outputs("one")), testing::IsEmpty());
    const RunSummary whole = RunRecords::read(folder_ / "whole/scanmill.sqlite").summary(1);
    EXPECT_EQ(whole.started, "2026-03-01T01:00:00.000Z") << "the earliest that a clock showed";
    EXPECT_EQ(whole.seconds, longest) << "not the two hours between the clocks";
}

TEST_F(Shards, WithOtherCaches_AreMerged) {
    scanmill({"batch", "b.yaml", "-o", "one", "-q", "--no-cache"});
    scanmill({"batch", "b.yaml", "-o", "earlier", "-q", "--cache", "cache2", "--keep", "always"});
    scanmill({"batch", "b.yaml", "--shard", "1/3", "-o", "p1", "-q", "--cache", "cache1"});
    scanmill({"batch", "b.yaml", "--shard", "2/3", "-o", "p2", "-q", "--cache", "cache2"});
    scanmill({"batch", "b.yaml", "--shard", "3/3", "-o", "p3", "-q", "--no-cache"});
    const ProgramResult merged = merge({"p1", "p2", "p3"});
    EXPECT_EQ(merged.exit_code, 1);
    EXPECT_THAT(merged.err, testing::IsEmpty());
    EXPECT_EQ(report("whole"), report("one"));
    EXPECT_THAT(differences(outputs("whole"), outputs("one")), testing::IsEmpty());
}

TEST_F(Shards, WithAReadOnlyCache_WarnOnceAndAreMerged) {
    scanmill({"batch", "b.yaml", "-o", "one", "-q", "--no-cache"});
    const auto run = [&](const std::string& number, bool is_owner) {
        ProgramOptions own = options();
        own.without_rights = !is_owner;
        return scanmill_program({"batch", "b.yaml", "--shard", number + "/2", "-o", "p" + number, "-q", "--cache",
                                 "locked", "--keep", "always"},
                                own);
    };
    run("1", true);
    fs::permissions(folder_.path(), fs::perms::all);
    fs::permissions(folder_ / "locked",
                    fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
    const ProgramResult second = run("2", false);
    if (second.exit_code > 100) GTEST_SKIP() << "the program may not be run without root's rights here";
    EXPECT_EQ(second.exit_code, 1) << "cells with two points fail, as in one run";
    EXPECT_THAT(second.err, AllOf(HasSubstr("locked' does not store new results"), HasSubstr("choose another")));
    EXPECT_EQ(second.err.find("does not store"), second.err.rfind("does not store")) << "several workers, one sentence";
    EXPECT_EQ(merge({"p1", "p2"}).exit_code, 1);
    EXPECT_THAT(differences(outputs("whole"), outputs("one")), testing::IsEmpty());
}

TEST_F(Shards, ChunkOfAChangedBatch_IsRefused) {
    scanmill({"export", "slurm", "b.yaml", "-o", "cluster", "--minutes", "0.0001"});
    folder_.write("scans/s9.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 9\n");
    const auto refused = [&](const std::string& file, const std::string& sentence) {
        const ProgramResult result = scanmill({"batch", "b.yaml", "--cells", file, "-o", "p1"});
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.err, AllOf(HasSubstr(sentence), HasSubstr("hint: ")));
    };
    refused("cluster/chunks/0001.json", "the batch has changed since 'cluster/chunks/0001.json' was written");
    refused("b.yaml", "'b.yaml' is not the file of a chunk");
    refused("cluster/chunks/0042.json", "there is no such file");
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
