// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of a session: passes that measure costs, the gate in the records, one run per output folder.
#include "scanmill/session/session.hpp"

#include <gmock/gmock.h>

#include "engine/run/run_fixture.hpp"
#include "scanmill/records/run_records.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class SessionRun : public Run {
protected:
    RunReport run_session(unsigned repeats, Cache* cache = nullptr, std::vector<RunObserver*> observers = {}) {
        SessionSettings settings;
        settings.output_folder = request_.output_folder;
        settings.jobs = 0;
        settings.is_cancelled = is_cancelled_;
        Session session(std::move(settings), cache);
        session.on_warning([&](std::string text) { warnings_.push_back(text); });
        SessionTask task{"nightly", "b.yaml", graph_, {}, {{{"seconds", "+20 %", {}}}, repeats}};
        return session.run(task, 0, library_, {}, observers, [](const RunStarted&) {});
    }
    RunDetails recorded(std::int64_t run = 1) const {
        return RunRecords::read(request_.output_folder / records_file).run(run);
    }
    /// A step that logs, as `modes` says for each scan; its outputs.
    void prepare_logged(const std::vector<std::string>& scans, const std::string& mode = "pass") {
        prepare("  - test-step: {mode: " + mode + ", log: " + log() + "}\n", scans,
                "outputs: {'{scan}.ply': test-step}\n");
    }
    std::vector<std::string> warnings_;
    std::function<bool()> is_cancelled_;
};

struct PassCounter : RunObserver {
    void pass_started(unsigned pass, unsigned passes) override { started.emplace_back(pass, passes); }
    void node_ended(const RunNode&, const NodeReport&) override { ++nodes; }
    std::vector<std::pair<unsigned, unsigned>> started;
    int nodes = 0;
};

TEST_F(SessionRun, Costs_AreMeasuredInEveryPass_AndAddUpTheStepsOfTheCell) {
    prepare_logged({scan("a.xyz"), scan("b.xyz", small_scan + "3 3 3\n")});
    PassCounter counter;
    EXPECT_EQ(run_session(3, nullptr, {&counter}).outcome(), Outcome::ok);
    EXPECT_EQ(runs_logged(), 6u);
    EXPECT_EQ(counter.nodes, 4) << "events come from the first pass only";
    EXPECT_THAT(counter.started, ElementsAre(std::pair(2u, 3u), std::pair(3u, 3u)));
    const RunDetails run = recorded();
    EXPECT_EQ(run.start.gate, (Texts{{"seconds", "+20 %"}}));
    ASSERT_THAT(run.cells, SizeIs(2));
    EXPECT_THAT(run.steps, SizeIs(4)) << "steps are recorded once";
    for (const CellRecord& cell : run.cells) {
        ASSERT_THAT(cell.costs, SizeIs(3));
        double seconds = 0;
        u64 memory = 0;
        for (const StepRecord& step : run.steps)
            if (step.scan == cell.scan) {
                seconds += step.effort.seconds;
                memory = std::max(memory, step.effort.peak_memory);
            }
        EXPECT_EQ(cell.costs[0].seconds, seconds);
        EXPECT_EQ(cell.costs[0].peak_memory, memory);
        for (const CostRecord& cost : cell.costs) EXPECT_GT(cost.seconds, 0);
    }
    EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(SessionRun, FailedCells_HaveNoCosts_AndAreNotRunAgain) {
    prepare_logged({scan("a.xyz"), scan("bad.xyz", "1 2\n")});
    EXPECT_EQ(run_session(2).outcome(), Outcome::failed);
    EXPECT_EQ(runs_logged(), 2u);
    const RunDetails run = recorded();
    EXPECT_THAT(run.cells[0].costs, SizeIs(2));
    EXPECT_THAT(run.cells[1].costs, IsEmpty());
}

TEST_F(SessionRun, LaterPasses_WriteNoOutputs) {
    prepare_logged({scan("a.xyz")});
    struct Remover : RunObserver {
        explicit Remover(std::filesystem::path output) : file(std::move(output)) {}
        void pass_started(unsigned, unsigned) override { std::filesystem::remove(file); }
        std::filesystem::path file;
    } remover(folder_ / "out/a.ply");
    run_session(2, nullptr, {&remover});
    EXPECT_EQ(runs_logged(), 2u);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/a.ply"));
}

TEST_F(SessionRun, FailureInALaterPass_IsReported_AndChangesNoResult) {
    prepare_logged({scan("a.xyz"), scan("b.xyz", small_scan + "3 3 3\n")});
    struct Breaker : RunObserver {
        explicit Breaker(std::filesystem::path scan) : file(std::move(scan)) {}
        void pass_started(unsigned, unsigned) override { std::filesystem::remove(file); }
        std::filesystem::path file;
    } breaker(folder_ / "b.xyz");
    EXPECT_EQ(run_session(2, nullptr, {&breaker}).outcome(), Outcome::ok);
    EXPECT_THAT(warnings_, ElementsAre(testing::AllOf(HasSubstr("1 of 2 cells failed"), HasSubstr("b.xyz"))));
    const RunDetails run = recorded();
    EXPECT_EQ(run.summary.outcome, "ok");
    EXPECT_THAT(run.cells[0].costs, SizeIs(2));
    EXPECT_THAT(run.cells[1].costs, SizeIs(1));
}

TEST_F(SessionRun, WithACache_CostsAreNotMeasured) {
    prepare_logged({scan("a.xyz")});
    Cache cache(folder_ / "cache");
    run_session(3, &cache);
    EXPECT_EQ(runs_logged(), 1u);
    EXPECT_THAT(recorded().cells[0].costs, IsEmpty());
    EXPECT_THAT(warnings_, ElementsAre(HasSubstr("costs are not measured")));
}

TEST_F(SessionRun, InterruptInALaterPass_InterruptsTheRun_AndKeepsWhatWasMeasured) {
    prepare_logged({scan("a.xyz")});
    struct Passes : RunObserver {
        void pass_started(unsigned pass, unsigned) override { now = pass; }
        unsigned now = 1;
    } passes;
    is_cancelled_ = [&] { return passes.now == 3; };
    EXPECT_TRUE(run_session(5, nullptr, {&passes}).interrupted);
    EXPECT_EQ(passes.now, 3u);
    EXPECT_EQ(recorded().summary.outcome, "interrupted");
    EXPECT_THAT(recorded().cells[0].costs, SizeIs(2));
}

TEST_F(SessionRun, FolderInUse_IsRefusedBeforeAnythingIsComputed) {
    prepare_logged({scan("a.xyz")});
    std::filesystem::create_directories(folder_ / "out");
    {
        const OutputLock other(folder_ / "out", {"scanmill", "batch"}, {});
        EXPECT_THROW(run_session(1), FolderInUse);
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "log"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/scanmill.sqlite"));
    run_session(1);
    EXPECT_EQ(runs_logged(), 1u);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/scanmill.lock"));
}

}  // namespace
}  // namespace scanmill::test
