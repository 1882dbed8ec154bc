// SPDX-License-Identifier: GPL-3.0-or-later
// Scans that change, and runs that are cancelled, while scans are streamed.
#include <gmock/gmock.h>

#include "engine/run/streamed_run_fixture.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(StreamedRun, ScanThatChangesAfterPlanning_Fails) {
    prepare("  - test-stream: {length: 1 u}\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-stream}\n");
    scan("a.xyz", "0 0 0\n7 0 0\n");
    const RunReport report = run_graph();
    EXPECT_THAT(report.nodes[0].failure.whole().what(), HasSubstr("changed during the run"));
    EXPECT_FALSE(fs::exists(folder_ / "out/a.ply"));
    EXPECT_FALSE(predict(graph_, cache_.get())[0].cached) << "under the key of what it held before";
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
    EXPECT_THAT(report.cells[0].failure.whole().what(), HasSubstr("changed during the run"));
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
        EXPECT_THAT(report.cells[0].failure.whole().what(),
                    HasSubstr(has_cache ? "changed during the run" : "changed while it was read"));
        EXPECT_THAT(report.cells[0].failure.whole().what(), HasSubstr("run it again"));
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

TEST_F(StreamedRun, Cancelled_Stops) {
    prepare("  - test-stream: {length: 1 u, waits: true, log: " + log() + "}\n", {scan("a.xyz")});
    settings_.is_cancelled = [&] { return !logged().empty(); };
    EXPECT_TRUE(run_graph().interrupted);
    EXPECT_THAT(logged(), HasSubstr("stream"));
}

}  // namespace
}  // namespace scanmill::test
