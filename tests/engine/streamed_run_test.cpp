// SPDX-License-Identifier: GPL-3.0-or-later
// A run whose scans are streamed is the run that reads them whole: the same outputs, reports and keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>
#include <map>
#include <set>

#include "engine/run_fixture.hpp"
#include "scanmill/work/worker_processes.hpp"
#include "support/point_files.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr Origin ran = Origin::ran, cached = Origin::cached, same_inputs = Origin::same_inputs;

/// Two workers in this process; when both have something to do, the second is done first.
class TwoBenches : public Workers {
public:
    TwoBenches(FilterLibrary& library, Cache& cache, KeepRule::Policy policy) {
        for (const char* name : {"first", "second"}) benches_.emplace_back(library, &cache, policy, scratch_ / name);
    }
    std::size_t size() const override { return benches_.size(); }
    void start(std::size_t worker, Job job) override {
        steps_of_second += worker == 1 && std::holds_alternative<StepWork>(job.work);
        jobs_[worker] = std::move(job);
    }
    void forget(std::size_t worker, std::size_t node) override { benches_[worker].forget(node); }
    void wait(const WorkerListener& listener, std::chrono::milliseconds) override {
        if (jobs_.empty()) return;
        const auto [worker, job] = *jobs_.rbegin();
        jobs_.erase(worker);
        JobReport report = benches_[worker].perform(job, {[](double) {}, [](std::string_view) {}, {}});
        listener.on_end(worker, std::move(report), false);
    }
    void cancel() override {}

    std::size_t steps_of_second = 0;

private:
    TemporaryFolder scratch_;
    std::deque<Workbench> benches_;
    std::map<std::size_t, Job> jobs_;
};

class StreamedRun : public Run {
protected:
    StreamedRun() {
        library_ = FilterLibrary({SCANMILL_TEST_PLUGIN_DIR, SCANMILL_PLUGIN_DIR});
        use_cache("cache");
        keep_ = KeepRule::Policy::always;
    }
    void use_cache(const std::string& name) {
        cache_ = std::make_unique<Cache>(folder_ / name);
        settings_.cache = cache_.get();
    }
    /// Of the prepared graph; `whole`: as if nothing could be streamed.
    RunReport run_prepared(bool whole) {
        for (RunNode& node : graph_.nodes) {
            EXPECT_EQ(node.leaf.is_streamed, node.is_scan);
            if (whole) node.leaf.is_streamed = false;
        }
        return run_graph();
    }
    RunReport run_thin(const std::string& parameters, const std::string& file, bool whole = false,
                       const std::string& inputs = "{scan: points}") {
        prepare("  - voxel-thin: {" + parameters + "}\n    expect: {points: '> 0'}\n", {file},
                "outputs: {'{scan}.ply': voxel-thin}\n", inputs);
        return run_prepared(whole);
    }
    RunReport run_logging(const std::string& file, const std::string& parameters = "length: 1 %diag") {
        prepare("  - test-stream: {" + parameters + ", log: " + log() + "}\n", {file},
                "outputs: {'{scan}.ply': test-stream}\n");
        return run_graph();
    }
    std::string logged() const { return content_of(folder_ / "log"); }

    /// Everything that was remembered: names of all files, and what plans lead to.
    std::set<std::string> remembered(const std::string& cache) const {
        std::set<std::string> all;
        std::error_code absent;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / cache, absent)) {
            const std::string name = fs::relative(entry.path(), folder_ / cache).string();
            const bool is_leafs = name.find("/files/") != std::string::npos;
            if (!entry.is_regular_file() || is_leafs) continue;
            all.insert(name + (name.find("/plans/") != std::string::npos ? content_of(entry.path()) : ""));
        }
        return all;
    }
    static std::vector<Origin> origins(const RunReport& report) {
        std::vector<Origin> all;
        for (const NodeReport& node : report.nodes) {
            EXPECT_EQ(node.outcome, Outcome::done) << node.failure.text;
            all.push_back(node.origin);
        }
        return all;
    }
    static void expect_equal(const RunReport& streamed, const RunReport& whole) {
        ASSERT_EQ(streamed.nodes.size(), whole.nodes.size());
        for (std::size_t i = 0; i < whole.nodes.size(); ++i) {
            const NodeReport &a = streamed.nodes[i], &b = whole.nodes[i];
            EXPECT_EQ(a.outcome, b.outcome);
            EXPECT_EQ(a.failure.text, b.failure.text);
            EXPECT_EQ(a.metrics.values, b.metrics.values);
            EXPECT_EQ(a.facts.values, b.facts.values);
            EXPECT_EQ(a.warnings, b.warnings);
            ASSERT_EQ(a.resolved.values.size(), b.resolved.values.size());
            for (std::size_t p = 0; p < a.resolved.values.size(); ++p)
                EXPECT_EQ(text(a.resolved.values[p].second), text(b.resolved.values[p].second));
        }
        EXPECT_EQ(streamed.cells[0].failure.text, whole.cells[0].failure.text);
    }
    /// Thins the file both ways, each with a cache of its own.
    void expect_the_same(const std::string& file, const std::string& parameters,
                         const std::string& inputs = "{scan: points}") {
        keep_ = KeepRule::Policy::never;  // a scan's value is kept only by who has it
        std::vector<std::string> outputs, descriptions;
        std::vector<RunReport> reports;
        for (const bool whole : {false, true}) {
            fs::remove_all(folder_ / (whole ? "whole" : "streamed"));
            use_cache(whole ? "whole" : "streamed");
            reports.push_back(run_thin(parameters, file, whole, inputs));
            const std::string stem = fs::path(file).stem().string();
            outputs.push_back(content_of(folder_ / ("out/" + stem + ".ply")));
            descriptions.push_back(content_of(folder_ / ("out/" + stem + ".ply.json")));
            fs::remove_all(folder_ / "out");
        }
        expect_equal(reports[0], reports[1]);
        EXPECT_TRUE(outputs[0] == outputs[1]) << "the bytes differ";
        EXPECT_EQ(descriptions[0], descriptions[1]);
        EXPECT_EQ(remembered("streamed"), remembered("whole"));
        EXPECT_EQ(outputs[0].empty(), !reports[1].all_done());
    }

    std::unique_ptr<Cache> cache_;
};

TEST_F(StreamedRun, GivesWhatReadingWholeGives) {
    const std::string ply = written(folder_ / "a.ply", helix(150'000));
    expect_the_same(ply, "bin-size: 0.1 u");
    expect_the_same(ply, "bin-size: 2 %diag, margin: 0.01 u, min-points: 2");
    expect_the_same(written(folder_ / "far.ply", helix(70'000, Vec3(4e6, 5e6, -7e6))), "bin-size: 2 %diag");
    expect_the_same(written(folder_ / "a.xyz", without_columns(helix(70'000))), "bin-size: 2 %diag");
}

TEST_F(StreamedRun, TakesUnitFrameAndWarningsAlong) {
    const std::string file = scan("a.xyz", "# unit furlong\n# unit mm\n# frame lab\n" + small_scan);
    expect_the_same(file, "bin-size: 0.5 mm");
    expect_the_same(file, "bin-size: 50 um", "{scan: {kind: points, unit: m, frame: part}}");
    const RunReport report = run_thin("bin-size: 0.5 mm", file, false, "{scan: {kind: points, frame: part}}");
    EXPECT_THAT(report.nodes[0].warnings, ElementsAre(HasSubstr("furlong"), HasSubstr("'lab'")));
    EXPECT_EQ(read_points(folder_ / "out/a.ply")->frame.name, "part");
}

TEST_F(StreamedRun, RefusesWhatReadingWholeRefuses) {
    const std::string ply = written(folder_ / "a.ply", helix(1000));
    expect_the_same(ply, "bin-size: 1e-9 u");
    expect_the_same(ply, "bin-size: 0.1 mm");
    expect_the_same(ply, "bin-size: 0.1 u, min-points: 1000");
    expect_the_same(ply, "bin-size: 0.1 u, rule: adaptive");
    expect_the_same(scan("one.xyz", "1 2 3\n"), "bin-size: 1 %diag");
    EXPECT_THAT(run_thin("bin-size: 1e-9 u", ply).cells[0].failure.text, HasSubstr("bins"));
    expect_the_same(scan("same.xyz", "1 2 3\n1 2 3\n"), "bin-size: 1 %diag");
    EXPECT_THAT(run_thin("bin-size: 1 %diag", scan("one.xyz", "1 2 3\n")).cells[0].failure.text, HasSubstr("no size"));
}

TEST_F(StreamedRun, FileThatTurnsOutToNeedIt_IsReadWhole) {
    const std::string nan = scan("nan.xyz", small_scan + "1 2 nan\n");
    expect_the_same(nan, "bin-size: 0.1 u");
    EXPECT_THAT(run_thin("bin-size: 0.1 u", nan).cells[0].failure.text, HasSubstr("NaN"));
    expect_the_same(scan("late.xyz", small_scan + "1 2 3 4\n"), "bin-size: 0.1 u");
    const std::string mixed = scan("mixed.xyz", small_scan + "1, 2 3\n");
    expect_the_same(mixed, "bin-size: 0.1 u");
    use_cache("logging");
    const std::vector<std::string> log = run_logging(nan).nodes[0].effort.log;
    EXPECT_THAT(log, ElementsAre(HasSubstr("read as a whole")));
    EXPECT_THAT(run_logging(scan("a.xyz")).nodes[0].effort.log, testing::IsEmpty());
    EXPECT_THAT(logged(), testing::MatchesRegex("whole .*\nstream .*\n"));
}

TEST_F(StreamedRun, HandsTheFilterAStream) {
    const RunReport report = run_logging(scan("a.xyz"));
    EXPECT_TRUE(report.all_done()) << report.cells[0].failure.text;
    EXPECT_EQ(logged(), "stream 0.03 u 4\n") << "the diagonal is 3";
    EXPECT_EQ(report.nodes[0].facts.find("points")->value, 4);
}

TEST_F(StreamedRun, WithoutACache_HandsTheFilterAStream) {
    settings_.cache = nullptr;
    EXPECT_TRUE(run_logging(scan("a.xyz")).all_done());
    EXPECT_EQ(logged(), "stream 0.03 u 4\n");
}

TEST_F(StreamedRun, Workers_HandTheFilterAStreamAndGiveTheSame) {
    ::setenv("SCANMILL_PLUGIN_PATH", SCANMILL_TEST_PLUGIN_DIR, 1);
    prepare("  - test-stream: {length: {sweep: [1 %diag, 2 %diag]}, log: " + log() + "}\n", {scan("a.xyz")},
            "outputs: {'{scan}.{variant}.ply': test-stream}\n");
    WorkerProcessSettings command;
    command.command = {SCANMILL_PROGRAM, "worker"};
    command.cache_folder = cache_->folder().string();
    command.keep_policy = static_cast<int>(keep_);
    WorkerProcesses workers(std::move(command));
    workers.resize(2);
    settings_.shares_values = true;
    RunObserver nobody;
    const RunReport there = scanmill::run(library_, graph_, workers, settings_, nobody);
    ::unsetenv("SCANMILL_PLUGIN_PATH");
    ASSERT_TRUE(there.all_done()) << there.cells[0].failure.text;
    EXPECT_THAT(logged(), testing::AnyOf("stream 0.03 u 4\nstream 0.06 u 4\n", "stream 0.06 u 4\nstream 0.03 u 4\n"));
    use_cache("other");
    expect_equal(there, run_graph());
    EXPECT_EQ(remembered("cache"), remembered("other"));
}

TEST_F(StreamedRun, HelperThatOpenedAScan_GoesOnHelping) {
    // The first worker's own: two scans, a step on each, and one that brings both together. Whatever the second does is
    // help, and its scan is opened before the first one's.
    request_.inputs = {{"other", {scan("b.xyz", "0 0 0\n4 4 4\n")}}};
    prepare(
        "  - id: a\n    test-stream: {length: 1 u}\n    in: {points: scan}\n"
        "  - id: b\n    test-stream: {length: 2 u}\n    in: {points: other}\n"
        "  - id: both\n    test-step:\n    in: {points: a, more: [b]}\n",
        {scan("a.xyz")}, "outputs: {'{scan}.ply': both}\n", "{scan: points, other: points}");
    settings_.shares_values = true;
    TwoBenches workers(library_, *cache_, keep_);
    RunObserver nobody;
    const RunReport report = scanmill::run(library_, graph_, workers, settings_, nobody);
    ASSERT_TRUE(report.all_done()) << report.cells[0].failure.text;
    EXPECT_EQ(workers.steps_of_second, 1u);
}

TEST_F(StreamedRun, TheSameAgain_ComputesNothing) {
    const std::string file = written(folder_ / "a.ply", helix(1000));
    for (const bool first_whole : {false, true}) {
        use_cache(first_whole ? "whole-first" : "streamed-first");
        EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", file, first_whole)), ElementsAre(ran, ran));
        EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", file, !first_whole)), ElementsAre(cached, cached));
        EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", file, first_whole)), ElementsAre(cached, cached));
    }
}

TEST_F(StreamedRun, AnotherParameter_OpensTheScanAgain) {
    const std::string file = written(folder_ / "a.ply", helix(1000));
    run_thin("bin-size: 0.1 u", file);
    EXPECT_THAT(origins(run_thin("bin-size: 0.2 u", file)), ElementsAre(ran, ran));
}

TEST_F(StreamedRun, ValueThatWasKept_ChangesNothing) {
    const std::string file = scan("a.xyz");
    run("  - test-step:\n", {file});  // reads it whole, and keeps it
    EXPECT_THAT(origins(run_logging(file)), ElementsAre(cached, ran));
    EXPECT_EQ(logged(), "stream 0.03 u 4\n") << "as is said before anything runs";
}

TEST_F(StreamedRun, ValueThatWasKept_IsTakenWhereTheFileHasToBeReadWhole) {
    const std::string file = scan("a.xyz", small_scan + "1 2 nan\n");
    run("  - test-step:\n", {file});
    EXPECT_THAT(origins(run_logging(file)), ElementsAre(cached, ran));
    EXPECT_THAT(logged(), HasSubstr("whole"));
}

TEST_F(StreamedRun, OtherBytesOfTheSamePoints_AreCutOffBelow) {
    PointCloud cloud = without_columns(helix(1000));
    EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", written(folder_ / "a.ply", cloud))), ElementsAre(ran, ran));
    EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", written(folder_ / "a.xyz", cloud))), ElementsAre(ran, same_inputs));
}

TEST_F(StreamedRun, ScanThatChangesAfterPlanning_Fails) {
    prepare("  - test-stream: {length: 1 u}\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-stream}\n");
    scan("a.xyz", "0 0 0\n7 0 0\n");
    const RunReport report = run_graph();
    EXPECT_THAT(report.nodes[0].failure.text, HasSubstr("changed while the run was going on"));
    EXPECT_FALSE(fs::exists(folder_ / "out/a.ply"));
    EXPECT_FALSE(foresee(graph_, cache_.get())[0].known) << "under the key of what it held before";
}

TEST_F(StreamedRun, ScanThatChangesBetweenOpeningAndTheStep_Fails) {
    prepare("  - test-stream: {length: 1 u}\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-stream}\n");
    struct Changer : RunObserver {
        std::function<void()> change;
        void node_ended(const RunNode& node, const NodeReport&) override {
            if (!node.step) change();
        }
    } changer;
    changer.change = [&] { scan("a.xyz", "0 0 0\n9 0 0\n0 9 0\n1 2 2\n"); };
    const RunReport report = run_graph(changer);
    EXPECT_THAT(report.cells[0].failure.text, HasSubstr("changed while the run was going on"));
}

TEST_F(StreamedRun, ScanThatLosesRowsBetweenOpeningAndTheStep_FailsInWords) {
    struct Changer : RunObserver {
        std::function<void()> change;
        void node_ended(const RunNode& node, const NodeReport&) override {
            if (!node.step) change();
        }
    } changer;
    changer.change = [&] { scan("a.xyz", "0 0 0\n1 0 0\n0 2 0\n     \n"); };
    for (const bool has_cache : {true, false}) {
        if (!has_cache) settings_.cache = nullptr;
        prepare("  - voxel-thin: {bin-size: 0.5 u}\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': voxel-thin}\n");
        const RunReport report = run_graph(changer);
        EXPECT_THAT(report.cells[0].failure.text,
                    HasSubstr(has_cache ? "changed while the run was going on" : "changed while it was read"));
        EXPECT_THAT(report.cells[0].failure.text, HasSubstr("run it again"));
    }
}

TEST_F(StreamedRun, CancelledWhileItIsOpened_Stops) {
    prepare("  - test-stream: {length: 1 u}\n", {scan("a.xyz")});
    struct Canceller : RunObserver {
        bool is_cancelled = false;
        void node_started(const RunNode&, std::size_t) override { is_cancelled = true; }
    } canceller;
    settings_.is_cancelled = [&] { return canceller.is_cancelled; };
    const RunReport report = run_graph(canceller);
    EXPECT_TRUE(report.interrupted);
    EXPECT_EQ(report.nodes[0].outcome, Outcome::skipped);
}

TEST_F(StreamedRun, Forgotten_IsClosed) {
    prepare("  - test-stream: {length: 1 u}\n", {scan("a.xyz")});
    Workbench bench(library_, nullptr, KeepRule::Policy::never, folder_ / "scratch");
    Job job;
    job.node = 0;
    job.work = ReadWork{graph_.nodes[0].leaf, {}};
    EXPECT_EQ(bench.perform(job, {{}, [](std::string_view) {}, {}}).outcome, Outcome::done);
    EXPECT_FALSE(bench.is_empty());
    bench.forget(0);
    EXPECT_TRUE(bench.is_empty());
}

TEST_F(StreamedRun, Cancelled_Stops) {
    prepare("  - test-stream: {length: 1 u, waits: true, log: " + log() + "}\n", {scan("a.xyz")});
    settings_.is_cancelled = [&] { return !logged().empty(); };
    EXPECT_TRUE(run_graph().interrupted);
    EXPECT_THAT(logged(), HasSubstr("stream"));
}

}  // namespace
}  // namespace scanmill::test
