// SPDX-License-Identifier: GPL-3.0-or-later
// The records of runs: what was appended is read back, other versions and other files are refused, what a killed run
// wrote stays.

#include "scanmill/records/run_records.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/run/run_fixture.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/records/recorder.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RunStart some_start() {
    return {"thin", "thin.yaml", {"scanmill", "run", "a b"}, ~std::uint64_t(0), 4, 2, "0.1.0", "a box", "Eigen 3.4"};
}

StepRecord some_step(std::size_t node) {
    StepRecord step;
    step.node = node;
    step.workflow = "thinning";
    step.label = "thin";
    step.filter = "voxel-thin";
    step.filter_version = 3;
    step.build = "b";
    step.scan = "a \xff.ply";
    step.plan_key = "key";
    step.origin = "ran";
    step.why = "it is new";
    step.outcome = "ok";
    step.seconds = 0.1 + 0.2;
    step.cpu_seconds = 0.5;
    step.authored = {{"bin-size", "1 %diag"}};
    step.resolved = {{"bin-size", "0.3 u"}, {"min-points", "1"}};
    step.metrics = {{{"kept", 7, Unit::count}, {"rms", std::numeric_limits<double>::quiet_NaN(), Unit::length}}};
    step.properties = {{{"closed", 1, Unit::boolean}}};
    step.warnings = {"one", "two"};
    step.failure = {"signal", 11, "it crashed"};
    step.peak_memory = 3'000'000'000;
    step.threads = 4;
    step.attempts = 2;
    step.log = {"first line", "last line"};
    return step;
}

class Records : public testing::Test {
protected:
    std::filesystem::path file() const { return folder_ / "records.sqlite"; }
    TemporaryFolder folder_;
};

TEST_F(Records, WhatWasAppended_IsReadBack) {
    {
        RunRecords records = RunRecords::append_to(file());
        const std::int64_t run = records.begin(some_start());
        records.add(run, {some_step(0), some_step(2)}, {});
        CellRecord cell{"thinning", "a.ply", "alpha=1", "failed", {"time", 0, "what went wrong"},
                        1.5,        {0, 2},  {},        {"a: b"}};
        cell.outputs = {{"out/a.ply", "mesh", "ok", {{{"triangles", 12, Unit::count}}}}};
        records.add(run, {}, {cell});
        records.end(run, "failed", 2.5);
    }
    const RunRecords records = RunRecords::read(file());
    const std::vector<RunSummary> runs = records.runs();
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_EQ(runs[0].outcome, "failed");
    EXPECT_EQ(runs[0].cells, 1u);
    EXPECT_EQ(runs[0].failed, 1u);
    EXPECT_EQ(runs[0].ran, 2u);
    EXPECT_EQ(runs[0].cached, 0u);
    EXPECT_EQ(runs[0].seconds, 2.5);
    EXPECT_THAT(runs[0].started, testing::MatchesRegex("....-..-..T..:..:..Z"));
    const RunDetails run = records.run(runs[0].id);
    EXPECT_THAT(run.cells[0].doubts, ElementsAre("a: b"));
    EXPECT_EQ(run.start.seed, ~std::uint64_t(0));
    EXPECT_THAT(run.start.arguments, ElementsAre("scanmill", "run", "a b"));
    EXPECT_EQ(run.start.machine, "a box");
    ASSERT_EQ(run.steps.size(), 2u);
    const StepRecord& step = run.steps[1];
    EXPECT_EQ(step.node, 2u);
    EXPECT_EQ(step.scan, "a \xff.ply");
    EXPECT_EQ(step.seconds, 0.1 + 0.2);
    EXPECT_EQ(step.authored, some_step(2).authored);
    EXPECT_EQ(step.resolved, some_step(2).resolved);
    EXPECT_EQ(step.metrics.find("kept")->value, 7);
    EXPECT_TRUE(std::isnan(step.metrics.find("rms")->value));
    EXPECT_EQ(step.properties.find("closed")->unit, Unit::boolean);
    EXPECT_EQ(step.warnings, some_step(2).warnings);
    EXPECT_EQ(step.workflow, "thinning");
    EXPECT_EQ(step.failure.cause, "signal");
    EXPECT_EQ(step.failure.number, 11);
    EXPECT_EQ(step.failure.error, "it crashed");
    EXPECT_EQ(step.peak_memory, 3'000'000'000);
    EXPECT_EQ(step.threads, 4u);
    EXPECT_EQ(step.attempts, 2u);
    EXPECT_THAT(step.log, ElementsAre("first line", "last line"));
    EXPECT_EQ(run.start.jobs, 2u);
    EXPECT_EQ(run.start.libraries, "Eigen 3.4");
    ASSERT_EQ(run.cells.size(), 1u);
    EXPECT_EQ(run.cells[0].workflow, "thinning");
    EXPECT_EQ(run.cells[0].failure.cause, "time");
    EXPECT_EQ(run.cells[0].failure.error, "what went wrong");
    EXPECT_THAT(run.cells[0].nodes, ElementsAre(0, 2));
    EXPECT_EQ(run.cells[0].outputs[0].properties.find("triangles")->value, 12);
}

/// The file was written by the program that first had such tables, over one good scan and one bad.
TEST_F(Records, TablesOfTheFirstVersion_AreBroughtUpToDate) {
    {
        SQLite::Database old(file().string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
        old.exec(content_of(SCANMILL_SOURCE_DIR "/tests/data/records_of_version_1.sql"));
    }
    for (const char* how : {"the first time", "once it is up to date"}) {
        SCOPED_TRACE(how);
        const RunRecords records = RunRecords::read(file());
        ASSERT_EQ(records.runs().size(), 1u);
        const RunDetails run = records.run(1);
        EXPECT_EQ(run.summary.failed, 1u);
        ASSERT_EQ(run.cells.size(), 2u);
        EXPECT_EQ(run.cells[0].workflow, "quickstart");
        EXPECT_EQ(run.cells[0].outcome, "ok");
        EXPECT_EQ(run.steps[1].outcome, "ok");
        EXPECT_THAT(run.cells[1].failure.error, HasSubstr("bad.xyz"));
        ASSERT_EQ(run.steps.size(), 5u);
        EXPECT_EQ(run.steps[0].peak_memory, 0);
        EXPECT_EQ(run.steps[1].label, "voxel-thin");
        EXPECT_FALSE(records.last_steps("quickstart", "small.xyz", "voxel-thin").empty());
    }
    RunRecords records = RunRecords::append_to(file());
    EXPECT_EQ(records.begin(some_start()), 2);
}

TEST_F(Records, RunsAfterEachOther_AreNumbered_AndAKilledOneHasNoEnd) {
    {
        RunRecords records = RunRecords::append_to(file());
        records.add(records.begin(some_start()), {some_step(0)}, {});
    }
    RunRecords records = RunRecords::append_to(file());
    const std::int64_t second = records.begin(some_start());
    records.end(second, "ok", 1);
    const std::vector<RunSummary> runs = records.runs();
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_FALSE(runs[0].outcome);
    EXPECT_EQ(runs[0].ran, 1u);
    EXPECT_EQ(runs[1].outcome, "ok");
    EXPECT_THAT(records.run(second).steps, IsEmpty());
    EXPECT_THAT(sentence_of([&] { records.run(9); }), HasSubstr("there is no run 9 in"));
}

TEST_F(Records, TwoWritersAtOnce_BothArrive) {
    RunRecords one = RunRecords::append_to(file()), other = RunRecords::append_to(file());
    const std::int64_t first = one.begin(some_start()), second = other.begin(some_start());
    EXPECT_NE(first, second);
    for (std::size_t node = 0; node < 10; ++node) {
        one.add(first, {some_step(node)}, {});
        other.add(second, {some_step(node)}, {});
    }
    EXPECT_EQ(one.run(first).steps.size(), 10u);
    EXPECT_EQ(one.run(second).steps.size(), 10u);
}

TEST_F(Records, OpenedAgain_AreNotWrittenTo) {
    RunRecords::append_to(file()).begin(some_start());
    const std::string before = content_of(file());
    RunRecords::append_to(file());
    EXPECT_EQ(content_of(file()), before);
}

TEST_F(Records, OfANewerScanmill_AreLeftAlone) {
    RunRecords::append_to(file());
    SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec("PRAGMA user_version = 99");
    for (const bool append : {false, true})
        EXPECT_THAT(sentence_of([&] { append ? RunRecords::append_to(file()) : RunRecords::read(file()); }),
                    HasSubstr("tables are of version 99, this one reads up to 3"));
}

TEST_F(Records, LinkOutOfTheFolder_IsRefusedAndNotFollowed) {
    const TemporaryFolder elsewhere;
    for (const char* target : {"absent.sqlite", "present.sqlite"}) {
        if (target[0] == 'p') elsewhere.write(target, "");
        std::filesystem::remove(file());
        std::filesystem::create_symlink(elsewhere / target, file());
        EXPECT_THAT(sentence_of([&] { RunRecords::append_to(file()); }), HasSubstr("outside the output folder"));
    }
    EXPECT_FALSE(std::filesystem::exists(elsewhere / "absent.sqlite"));
}

TEST_F(Records, WhatIsNone_IsRefused) {
    EXPECT_THAT(sentence_of([&] { RunRecords::read(file()); }), HasSubstr("does not exist"));
    folder_.write("records.sqlite", "this is text, and long enough to be looked at as a database file of its own kind");
    EXPECT_THAT(sentence_of([&] { RunRecords::read(file()); }), HasSubstr("not a database"));
    EXPECT_THAT(sentence_of([&] { RunRecords::append_to(file()); }), HasSubstr("not a database"));
    EXPECT_THAT(sentence_of([&] { RunRecords::append_to(folder_ / "no/such/folder/records.sqlite"); }),
                HasSubstr("unable to open"));
}

TEST_F(Run, Recorder_WritesWhatTheRunReports) {
    prepare("  - test-step: {factor: 2, mode: warn}\n    expect: {points: 4}\n", {scan("a.xyz")},
            "outputs: {'{scan}.ply': test-step}\n");
    const std::filesystem::path file = folder_ / "records.sqlite";
    std::vector<std::string> told;
    Recorder recorder(file, some_start(), library_, graph_, [&](std::string text) { told.push_back(text); });
    recorder.finish(run_graph(recorder));
    const RunDetails run = RunRecords::read(file).run(recorder.run());
    EXPECT_EQ(run.summary.outcome, "ok");
    ASSERT_EQ(run.steps.size(), 2u);
    EXPECT_EQ(run.steps[0].label, "read");
    EXPECT_EQ(run.steps[1].filter, "test-step");
    EXPECT_EQ(run.steps[1].plan_key, graph_.nodes[1].key);
    EXPECT_EQ(run.steps[1].metrics.find("points")->value, 4);
    EXPECT_THAT(run.steps[1].warnings, ElementsAre(HasSubstr("asked to warn")));
    ASSERT_EQ(run.cells.size(), 1u);
    EXPECT_EQ(run.cells[0].outputs[0].kind, "points");
    EXPECT_THAT(told, IsEmpty());
}

TEST_F(Run, Recorder_WritesDoubts) {
    prepare("  - test-step: {mode: doubt}\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-step}\n");
    const std::filesystem::path file = folder_ / "records.sqlite";
    Recorder recorder(file, some_start(), library_, graph_, {});
    recorder.finish(run_graph(recorder));
    const RunDetails run = RunRecords::read(file).run(recorder.run());
    EXPECT_EQ(run.summary.outcome, "doubtful");
    EXPECT_EQ(run.summary.doubtful, 1u);
    EXPECT_EQ(run.summary.failed, 0u);
    EXPECT_EQ(run.cells[0].outcome, "doubtful");
    EXPECT_THAT(run.cells[0].doubts, ElementsAre("test-step: was asked to doubt"));
}

TEST_F(Run, RecorderWithoutAPlaceForRecords_TellsItOnce) {
    prepare("  - test-step: {factor: 2}\n", {scan("a.xyz")}, "");
    std::vector<std::string> told;
    Recorder recorder(folder_ / "no/such/folder/records.sqlite", some_start(), library_, graph_,
                      [&](std::string text) { told.push_back(text); });
    recorder.finish(run_graph(recorder));
    EXPECT_EQ(recorder.run(), 0);
    EXPECT_THAT(told, ElementsAre(HasSubstr("this run is not recorded: the records")));
}

}  // namespace
}  // namespace scanmill::test
