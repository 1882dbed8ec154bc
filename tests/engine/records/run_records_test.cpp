// SPDX-License-Identifier: GPL-3.0-or-later
// The records of runs: what was appended is read back, other versions and other files are refused, what a killed run
// wrote stays.

#include "scanmill/records/run_records.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/run/run_fixture.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/records/recorder.hpp"
#include "scanmill/worker/file_description.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RunStart some_start() {
    RunStart start;
    start.workflow = "thin";
    start.file = "thin.yaml";
    start.arguments = {"scanmill", "run", "a b"};
    start.seed = ~std::uint64_t(0);
    start.threads = 4;
    start.jobs = 2;
    start.version = "0.1.0";
    start.machine = "a box";
    start.libraries = "Eigen 3.4";
    start.gate = {{"genus", "exact"}};
    return start;
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
    step.origin = Origin::ran;
    step.why = "it is new";
    step.outcome = Outcome::ok;
    step.effort.seconds = 0.1 + 0.2;
    step.effort.cpu_seconds = 0.5;
    step.authored = {{"bin-size", "1 %diag"}};
    step.resolved = {{"bin-size", "0.3 u"}, {"min-points", "1"}};
    step.metrics = {{{"kept", 7, Unit::count}, {"rms", std::numeric_limits<double>::quiet_NaN(), Unit::length}}};
    step.properties = {{{"closed", 1, Unit::boolean}}};
    step.warnings = {"one", "two"};
    step.failure = {Cause::signal, 11, "it crashed"};
    step.effort.peak_memory = 3'000'000'000;
    step.effort.threads = 4;
    step.attempts = 2;
    step.effort.log = {"first line", "last line"};
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
        CellRecord cell{"thinning", "a.ply", "alpha=1", Outcome::failed, {Cause::time, 0, "what went wrong"},
                        1.5,        {0, 2},  {},        {"a: b"},        {}};
        cell.outputs = {
            {"out/a.ply", "mesh", Outcome::ok, {{{"triangles", 12, Unit::count}}}, "c0ffee", 3'000'000'000},
            {"out/b.ply", "mesh", Outcome::failed, {}, "", 0, "out/b.ply.previous", "", {}, "out/failed/b.ply"}};
        cell.costs = {{1.5, 2.5, 3'000'000'000}, {0.5, 0.25, 7}};
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
    EXPECT_EQ(step.effort.seconds, 0.1 + 0.2);
    EXPECT_EQ(step.authored, some_step(2).authored);
    EXPECT_EQ(step.resolved, some_step(2).resolved);
    EXPECT_EQ(step.metrics.find("kept")->value, 7);
    EXPECT_TRUE(std::isnan(step.metrics.find("rms")->value));
    EXPECT_EQ(step.properties.find("closed")->unit, Unit::boolean);
    EXPECT_EQ(step.warnings, some_step(2).warnings);
    EXPECT_EQ(step.workflow, "thinning");
    EXPECT_EQ(step.failure.cause, Cause::signal);
    EXPECT_EQ(step.failure.number, 11);
    EXPECT_EQ(step.failure.error, "it crashed");
    EXPECT_EQ(step.effort.peak_memory, 3'000'000'000);
    EXPECT_EQ(step.effort.threads, 4u);
    EXPECT_EQ(step.attempts, 2u);
    EXPECT_THAT(step.effort.log, ElementsAre("first line", "last line"));
    EXPECT_EQ(run.start.jobs, 2u);
    EXPECT_EQ(run.start.libraries, "Eigen 3.4");
    ASSERT_EQ(run.cells.size(), 1u);
    EXPECT_EQ(run.cells[0].workflow, "thinning");
    EXPECT_EQ(run.cells[0].failure.cause, Cause::time);
    EXPECT_EQ(run.cells[0].failure.error, "what went wrong");
    EXPECT_THAT(run.cells[0].nodes, ElementsAre(0, 2));
    EXPECT_EQ(run.cells[0].outputs[0].properties.find("triangles")->value, 12);
    EXPECT_EQ(run.cells[0].outputs[0].sha256, "c0ffee");
    EXPECT_EQ(run.cells[0].outputs[0].bytes, 3'000'000'000);
    EXPECT_EQ(run.cells[0].outputs[1].moved_to, "out/b.ply.previous");
    EXPECT_EQ(run.cells[0].outputs[1].evidence, "out/failed/b.ply");
    ASSERT_EQ(run.cells[0].costs.size(), 2u);
    EXPECT_EQ(run.cells[0].costs[0].peak_memory, 3'000'000'000);
    EXPECT_EQ(run.cells[0].costs[1].cpu_seconds, 0.25);
    EXPECT_EQ(run.start.gate, some_start().gate);
}

/// Rows of cells and steps of two runs may alternate where folders cannot be locked.
TEST_F(Records, RunsThatWroteInTurns_AreToldApart) {
    RunRecords one = RunRecords::append_to(file()), other = RunRecords::append_to(file());
    const std::int64_t first = one.begin(some_start()), second = other.begin(some_start());
    for (std::size_t node = 0; node < 4; ++node)
        for (auto [records, run] : {std::pair(&one, first), std::pair(&other, second)}) {
            StepRecord step = some_step(node);
            step.warnings = {fmt::format("{}.{}", run, node)};
            CellRecord cell{"thinning", fmt::format("{}.{}", run, node), "default", Outcome::ok, {}, 1, {node}, {}, {},
                            {}};
            cell.outputs = {
                {step.warnings[0], "mesh", Outcome::ok, {{{"run", static_cast<double>(run), Unit::count}}}}};
            cell.costs = {{static_cast<double>(run), 1, 1}};
            records->add(run, {step}, {cell});
        }
    for (const std::int64_t run : {first, second}) {
        const RunDetails details = one.run(run);
        ASSERT_EQ(details.steps.size(), 4u);
        ASSERT_EQ(details.cells.size(), 4u);
        for (std::size_t node = 0; node < 4; ++node) {
            const std::string name = fmt::format("{}.{}", run, node);
            EXPECT_THAT(details.steps[node].warnings, ElementsAre(name));
            EXPECT_EQ(details.steps[node].metrics.values.size(), 2u);
            EXPECT_EQ(details.cells[node].scan, name);
            EXPECT_THAT(details.cells[node].nodes, ElementsAre(node));
            ASSERT_EQ(details.cells[node].outputs.size(), 1u);
            EXPECT_EQ(details.cells[node].outputs[0].file, name);
            EXPECT_EQ(details.cells[node].outputs[0].properties.find("run")->value, run);
            ASSERT_EQ(details.cells[node].costs.size(), 1u);
            EXPECT_EQ(details.cells[node].costs[0].seconds, run);
        }
    }
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

TEST_F(Records, VerdictOfAGate_IsReadBack) {
    RunRecords records = RunRecords::append_to(file());
    const std::int64_t without = records.begin(some_start());
    records.end(without, "ok", 1);
    EXPECT_FALSE(records.summary(without).regressions);
    const std::int64_t judged = records.begin(some_start()), passed = records.begin(some_start());
    for (const std::int64_t run : {judged, passed}) records.end(run, "ok", 1);
    records.add_verdict(judged, 3);
    records.add_verdict(passed, 0);
    const std::vector<RunSummary> runs = RunRecords::read(file()).runs();
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_FALSE(runs[0].regressions);
    EXPECT_EQ(runs[1].regressions, 3u);
    EXPECT_EQ(runs[2].regressions, 0u);
    EXPECT_EQ(runs[1].outcome, "ok");
    EXPECT_EQ(runs[1].seconds, 1) << "the columns after it";
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

/// A Scanmill with other fields, older or newer, writes other tables under another number.
TEST_F(Records, OfAnotherLayout_AreRefusedAndLeftAlone) {
    RunRecords::append_to(file());
    for (const int number : {4, 99}) {
        SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec(fmt::format("PRAGMA user_version = {}", number));
        const std::string before = content_of(file());
        for (const bool append : {false, true}) {
            const Error error = error_of([&] { append ? RunRecords::append_to(file()) : RunRecords::read(file()); });
            EXPECT_THAT(error.sentence(), HasSubstr("another layout"));
            EXPECT_THAT(error.hint(), HasSubstr("new history"));
        }
        EXPECT_EQ(content_of(file()), before);
    }
}

TEST_F(Records, OfAnotherLayout_NameTheProgramThatWroteThem) {
    RunStart start = some_start();
    start.version = "0.9.0";
    RunRecords::append_to(file()).begin(start);
    SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec("PRAGMA user_version = 99");
    EXPECT_THAT(error_of([&] { RunRecords::read(file()); }).sentence(), HasSubstr("; Scanmill 0.9.0 wrote them last"));
}

/// If this number changes, files of version 0.1.0 need a conversion, or the command that makes one.
TEST_F(Records, Layout_IsThatOfTheFirstVersion) {
    RunRecords::append_to(file());
    EXPECT_EQ(SQLite::Database(file().string()).execAndGet("PRAGMA user_version").getInt(), 215950605);
}

TEST_F(Records, ARunAfterAnotherOfEqualNodes_CountsEachNodeOnce) {
    RunRecords records = RunRecords::append_to(file());
    const std::int64_t run = records.begin(some_start());
    StepRecord cached = some_step(0), again = some_step(0), other = some_step(1);
    cached.origin = other.origin = Origin::cached;
    records.add(run, {cached, again, other}, {});
    EXPECT_EQ(records.summary(run).ran, 1u) << "its cached value was lost";
    EXPECT_EQ(records.summary(run).cached, 1u);
    records.end(run, "ok", 1);
    EXPECT_EQ(records.summary(run).ran, 1u);
    EXPECT_EQ(records.summary(run).cached, 1u);
}

// Acceptances.

TEST_F(Records, Baseline_IsTheLastAcceptanceThatHolds) {
    RunRecords records = RunRecords::append_to(file());
    std::vector<std::int64_t> runs;
    for (const char* batch : {"nightly", "nightly", "weekly", "nightly"}) {
        RunStart start = some_start();
        start.workflow = batch;
        runs.push_back(records.begin(start));
        records.end(runs.back(), "failed", 1);
    }
    EXPECT_FALSE(records.baseline("nightly"));
    records.accept(runs[1], "ann", "the first");
    records.accept(runs[2], "ben", "of another batch");
    records.accept(runs[0], "ann", "an earlier one after all");
    EXPECT_EQ(records.baseline("nightly")->run, runs[0]);
    EXPECT_EQ(records.baseline("weekly")->run, runs[2]);
    records.revoke("nightly", "cleo", "a mistake");
    EXPECT_EQ(records.baseline("nightly")->run, runs[1]) << "the one before holds again";
    EXPECT_EQ(records.baseline("nightly")->who, "ann");
    records.revoke("nightly", "cleo", "all of it");
    EXPECT_FALSE(records.baseline("nightly"));
    EXPECT_EQ(sentence_of([&] { records.revoke("nightly", "cleo", "again"); }),
              fmt::format("no run of 'nightly' is accepted in '{}'", file().string()));
    records.accept(runs[1], "ann", "once more");
    EXPECT_EQ(records.baseline("nightly")->run, runs[1]);
    const std::vector<Acceptance> all = RunRecords::read(file()).acceptances();
    ASSERT_EQ(all.size(), 4u) << "none is ever removed";
    EXPECT_EQ(all[2].run, runs[0]);
    EXPECT_EQ(all[2].revoked_by, "cleo");
    EXPECT_EQ(all[2].revoked_why, "a mistake");
    EXPECT_TRUE(all[2].revoked_at);
    EXPECT_FALSE(all[1].revoked_at);
    EXPECT_THAT(all[3].at, testing::MatchesRegex("....-..-..T..:..:..Z"));
}

TEST_F(Records, ARunThatDidNotEnd_IsNotAccepted) {
    RunRecords records = RunRecords::append_to(file());
    EXPECT_THAT(sentence_of([&] { records.accept(1, "ann", "x"); }), HasSubstr("there is no run 1 in"));
    const std::int64_t killed = records.begin(some_start()), interrupted = records.begin(some_start());
    records.end(interrupted, "interrupted", 1);
    for (const std::int64_t run : {killed, interrupted}) {
        const Error error = error_of([&] { records.accept(run, "ann", "x"); });
        EXPECT_EQ(error.sentence(), fmt::format("run {} was interrupted; only a whole run can be accepted", run));
        EXPECT_FALSE(error.hint().empty());
    }
    EXPECT_TRUE(records.acceptances().empty());
}

// Costs.

class Costs : public Records {
protected:
    /// A run of one cell per scan, with these seconds.
    std::int64_t run(const std::vector<std::pair<std::string, std::vector<double>>>& cells,
                     const RunStart& start = some_start()) {
        const std::int64_t id = records_.begin(start);
        for (const auto& [scan, seconds] : cells) {
            CellRecord cell{"thinning", scan, "default", Outcome::ok, {}, 1, {}, {}, {}, {}};
            if (!seconds.empty()) cell.costs = {{seconds[0], 1, 1}};
            records_.add(id, {}, {cell});
            PastCosts more{"thinning", scan, "default", {}};
            for (std::size_t i = 1; i < seconds.size(); ++i) more.costs.push_back({seconds[i], 1, 1});
            records_.add_costs(id, {more});
        }
        records_.end(id, "ok", 1);
        return id;
    }
    std::vector<double> seconds_of(const std::string& scan, std::int64_t first, std::int64_t end) const {
        std::vector<double> seconds;
        for (const PastCosts& cell : records_.past_costs(some_start(), first, end))
            if (cell.scan == scan)
                for (const CostRecord& cost : cell.costs) seconds.push_back(cost.seconds);
        return seconds;
    }
    RunRecords records_ = RunRecords::append_to(file());
};

TEST_F(Costs, OfPastRuns_ComeInTheirOrder_FromTheFirstUpToTheEnd) {
    run({{"a", {1}}, {"b", {2}}});
    const std::int64_t first = run({{"a", {3, 4, 5}}, {"b", {}}});
    run({{"b", {6, 7}}, {"a", {8}}});
    const std::int64_t last = run({{"a", {9}}});
    EXPECT_THAT(seconds_of("a", first, last), ElementsAre(3, 4, 5, 8));
    EXPECT_THAT(seconds_of("b", first, last), ElementsAre(6, 7));
    EXPECT_THAT(seconds_of("a", first, first), IsEmpty());
}

TEST_F(Costs, OfAnotherMachineBatchOrNumberOfThreads_AreLeftOut) {
    run({{"a", {1}}});
    for (int what = 0; what < 4; ++what) {
        RunStart other = some_start();
        if (what == 0) other.machine = "another box";
        if (what == 1) other.threads += 1;
        if (what == 2) other.jobs += 1;
        if (what == 3) other.workflow = "another batch";
        run({{"a", {100}}}, other);
    }
    RunStart newer = some_start();
    newer.version = "0.2.0";
    newer.seed = 5;
    run({{"a", {2}}}, newer);
    EXPECT_THAT(seconds_of("a", 1, 1000), ElementsAre(1, 2));
}

TEST_F(Costs, OfVeryManyRuns_AreThoseOfTheNewest) {
    for (int i = 0; i < RunRecords::most_past_runs + 2; ++i) run({{"a", {static_cast<double>(i)}}});
    run({{"a", {}}});
    const std::vector<double> seconds = seconds_of("a", 1, 1000);
    ASSERT_EQ(seconds.size(), static_cast<std::size_t>(RunRecords::most_past_runs));
    EXPECT_EQ(seconds.front(), 2);
    EXPECT_EQ(seconds.back(), RunRecords::most_past_runs + 1);
}

// Files.

/// A copy of the file and its journal in the middle of a transaction is what a killed run leaves.
TEST_F(Records, JournalOfAKilledRun_IsRolledBackByTheReader) {
    {
        RunRecords records = RunRecords::append_to(file());
        records.end(records.begin(some_start()), "ok", 1);
    }
    std::filesystem::create_directory(folder_ / "killed");
    {
        SQLite::Database writing(file().string(), SQLite::OPEN_READWRITE);
        writing.exec("PRAGMA cache_size = 1; BEGIN; UPDATE run SET version = 'half'");
        for (int i = 0; i < 1000; ++i)
            writing.exec("INSERT INTO step_log (parent, value) VALUES (1, hex(randomblob(2000)))");
        std::filesystem::copy(file(), folder_ / "killed/records.sqlite");
        std::filesystem::copy(file().string() + "-journal", folder_ / "killed/records.sqlite-journal");
    }
    const RunRecords records = RunRecords::read(folder_ / "killed/records.sqlite");
    ASSERT_EQ(records.runs().size(), 1u);
    EXPECT_EQ(records.run(1).start.version, "0.1.0");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "killed/records.sqlite-journal"));
}

TEST_F(Records, TruncatedFile_IsRefused) {
    {
        RunRecords records = RunRecords::append_to(file());
        std::vector<StepRecord> steps;
        for (std::size_t node = 0; node < 200; ++node) steps.push_back(some_step(node));
        records.add(records.begin(some_start()), steps, {});
    }
    const std::string whole = content_of(file());
    for (const std::size_t kept : {whole.size() / 2, whole.size() / 3, std::size_t(5000), std::size_t(100)}) {
        folder_.write("records.sqlite", whole.substr(0, kept));
        for (const bool append : {false, true})
            EXPECT_THAT(sentence_of([&] {
                            RunRecords records = append ? RunRecords::append_to(file()) : RunRecords::read(file());
                            append ? records.begin(some_start()) : records.run(1).summary.id;
                        }),
                        testing::AllOf(HasSubstr("records.sqlite'"),
                                       testing::AnyOf(HasSubstr("malformed"), HasSubstr("not a database"))))
                << kept;
    }
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
    EXPECT_EQ(run.cells[0].outputs[0].bytes, std::filesystem::file_size(run.cells[0].outputs[0].file));
    Sha256 hash;
    hash.add(content_of(run.cells[0].outputs[0].file));
    EXPECT_EQ(run.cells[0].outputs[0].sha256, hash.text());
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
    EXPECT_EQ(run.cells[0].outcome, Outcome::doubtful);
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
