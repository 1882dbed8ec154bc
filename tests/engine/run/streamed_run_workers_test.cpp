// SPDX-License-Identifier: GPL-3.0-or-later
// Several workers over scans that are streamed.
#include <gmock/gmock.h>

#include <cstdlib>
#include <deque>

#include "engine/run/streamed_run_fixture.hpp"
#include "scanmill/worker/worker_processes.hpp"
#include "support/folders.hpp"

namespace scanmill::test {
namespace {

/// Two workers in this process; when both have something to do, the second is done first.
class TwoBenches : public Workers {
public:
    TwoBenches(FilterLibrary& library, Cache& cache, KeepRule::Policy policy) {
        for (const char* name : {"first", "second"})
            benches_.emplace_back(library, &cache, policy, values_, scratch_ / name);
    }
    std::size_t size() const override { return benches_.size(); }
    bool start(std::size_t worker, Job job) override {
        steps_of_second += worker == 1 && std::holds_alternative<StepWork>(job.work);
        jobs_[worker] = std::move(job);
        return true;
    }
    RunValues& values() override { return values_; }
    void wait(const WorkerListener& listener, std::chrono::milliseconds) override {
        if (jobs_.empty()) return;
        const auto [worker, job] = *jobs_.rbegin();
        jobs_.erase(worker);
        JobReport report = benches_[worker].perform(job, {[](double) {}, [](std::string_view) {}, {}});
        listener.on_end(worker, std::move(report));
    }
    void cancel() override {}

    std::size_t steps_of_second = 0;

private:
    TemporaryFolder scratch_;
    RunValues values_{std::filesystem::path(scratch_.path())};
    std::deque<Workbench> benches_;
    std::map<std::size_t, Job> jobs_;
};

TEST_F(StreamedRun, Workers_HandTheFilterAStreamAndGiveTheSame) {
    ::setenv("SCANMILL_PLUGIN_PATH", test::test_plugin_folder().c_str(), 1);
    prepare("  - test-stream: {length: {sweep: [1 %diag, 2 %diag]}, log: " + log() + "}\n", {scan("a.xyz")},
            "outputs: {'{scan}.{variant}.ply': test-stream}\n");
    WorkerProcessSettings command;
    command.command = {test::program_file(), "worker"};
    command.cache_folder = cache_->folder().string();
    command.keep_policy = static_cast<int>(keep_);
    WorkerProcesses workers(std::move(command));
    workers.resize(2);
    const RunReport there = scanmill::run(library_, graph_, workers, settings_);
    ::unsetenv("SCANMILL_PLUGIN_PATH");
    ASSERT_TRUE(there.outcome() == Outcome::ok) << there.cells[0].failure.whole().what();
    EXPECT_THAT(logged(), testing::AnyOf("stream 0.03 u 4\nstream 0.06 u 4\n", "stream 0.06 u 4\nstream 0.03 u 4\n"));
    use_cache("other");
    expect_equal(there, run_graph());
    EXPECT_EQ(remembered("cache"), remembered("other"));
}

TEST_F(StreamedRun, WorkersShareTheStepsOfACell) {
    // Two scans, a step on each, and one that brings both together.
    request_.inputs = {{"other", {scan("b.xyz", "0 0 0\n4 4 4\n")}}};
    prepare(
        "  - id: a\n    test-stream: {length: 1 u}\n    in: {points: scan}\n"
        "  - id: b\n    test-stream: {length: 2 u}\n    in: {points: other}\n"
        "  - id: both\n    test-step:\n    in: {points: a, more: [b]}\n",
        {scan("a.xyz")}, "outputs: {'{scan}.ply': both}\n", "{scan: points, other: points}");
    TwoBenches workers(library_, *cache_, keep_);
    const RunReport report = scanmill::run(library_, graph_, workers, settings_);
    ASSERT_TRUE(report.outcome() == Outcome::ok) << report.cells[0].failure.whole().what();
    EXPECT_EQ(workers.steps_of_second, 1u);
}

}  // namespace
}  // namespace scanmill::test
