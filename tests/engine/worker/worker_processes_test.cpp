// SPDX-License-Identifier: GPL-3.0-or-later
// Workers seen from the runner: what arrives as it was sent, and what becomes of processes that are no workers.
#include "scanmill/worker/worker_processes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/run/run_fixture.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/plan/expectation.hpp"
#include "support/folders.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

class WorkerProcessesTest : public Run {
protected:
    WorkerProcessesTest() { ::setenv("SCANMILL_PLUGIN_PATH", test::test_plugin_folder().c_str(), 1); }
    ~WorkerProcessesTest() override { ::unsetenv("SCANMILL_PLUGIN_PATH"); }

    RunReport run_with(const std::vector<std::string>& command) {
        WorkerProcessSettings settings;
        settings.command = command;
        WorkerProcesses workers(std::move(settings));
        return scanmill::run(library_, graph_, workers, settings_);
    }
};

const std::string step = "  - test-step: {factor: 2, length: 5 %diag}\n    expect: {points: [3, 5], more: 0}\n";
const std::string step_output = "outputs: {'{scan}.ply': test-step.points}\n";

TEST_F(WorkerProcessesTest, Worker_GivesWhatThisProcessGives) {
    const RunReport here = run(step, {scan("a.xyz")}, step_output);
    const std::string file = content_of(folder_ / "out/a.ply");
    ASSERT_TRUE(here.outcome() == Outcome::ok) << here.cells[0].failure.whole().what();
    std::filesystem::remove_all(folder_ / "out");
    const RunReport there = run_with({test::program_file(), "worker"});
    ASSERT_TRUE(there.outcome() == Outcome::ok) << there.cells[0].failure.whole().what();
    EXPECT_EQ(content_of(folder_ / "out/a.ply"), file);
    for (std::size_t i = 0; i < here.nodes.size(); ++i) {
        EXPECT_EQ(there.nodes[i].metrics.values, here.nodes[i].metrics.values);
        EXPECT_EQ(there.nodes[i].properties.values, here.nodes[i].properties.values);
        EXPECT_EQ(there.nodes[i].warnings, here.nodes[i].warnings);
        ASSERT_EQ(there.nodes[i].resolved.values.size(), here.nodes[i].resolved.values.size());
        for (std::size_t p = 0; p < here.nodes[i].resolved.values.size(); ++p)
            EXPECT_EQ(text(there.nodes[i].resolved.values[p].second), text(here.nodes[i].resolved.values[p].second));
    }
    EXPECT_EQ(there.cells[0].outputs[0].properties.values, here.cells[0].outputs[0].properties.values);
}

TEST_F(WorkerProcessesTest, Picture_IsTheSameFromAWorker) {
    const std::string drawing = step + "  - test-draw: {caption: Four points}\n";
    const std::string output = "outputs: {'{scan}.png': test-draw}\n";
    ASSERT_TRUE(run(drawing, {scan("a.xyz")}, output).outcome() == Outcome::ok);
    const std::string file = content_of(folder_ / "out/a.png");
    std::filesystem::remove_all(folder_ / "out");
    const RunReport there = run_with({test::program_file(), "worker"});
    ASSERT_TRUE(there.outcome() == Outcome::ok) << there.cells[0].failure.whole().what();
    EXPECT_EQ(content_of(folder_ / "out/a.png"), file);
    EXPECT_NE(file, "");
}

TEST_F(WorkerProcessesTest, ProcessesThatAreNoWorkers_FailTheirJobs) {
    prepare(step, {scan("a.xyz"), scan("b.xyz", "1 2 3\n4 5 6\n7 8 9\n")}, step_output);
    struct Stranger {
        std::vector<std::string> command;
        Cause cause;
    };
    const std::vector<Stranger> strangers{
        {{"/bin/false"}, Cause::exit},
        {{"/bin/sh", "-c", "exit 7"}, Cause::exit},
        {{"/bin/sh", "-c", "kill -9 $$"}, Cause::signal},
        {{"/bin/sh", "-c", "echo these are no messages >&3; sleep 100"}, Cause::exit},
        {{"/bin/sh", "-c", "printf '\\001\\000\\000\\000\\240' >&3; sleep 100"}, Cause::exit},  // an empty map
        {{"/bin/sh", "-c", "exec 3>&-; sleep 100"}, Cause::signal}};
    for (const Stranger& stranger : strangers) {
        const RunReport report = run_with(stranger.command);
        for (const CellReport& cell : report.cells) {
            EXPECT_EQ(cell.outcome, Outcome::failed) << stranger.command.back();
            EXPECT_EQ(cell.failure.cause, stranger.cause) << stranger.command.back() << cell.failure.whole().what();
        }
    }
    const RunReport none = run_with({"/no/such/program"});
    EXPECT_EQ(none.cells[1].failure.cause, Cause::exit);
    EXPECT_THAT(none.cells[1].failure.whole().what(), HasSubstr("no worker process can be started"));
}

TEST_F(WorkerProcessesTest, ModuleThatEndsItsProcessAtLoad_FailsTheCellAndIsNamed) {
    for (const char* file : {"scanmill-test-step.so", "scanmill-test-step.json"})
        std::filesystem::copy(std::filesystem::path(test::test_plugin_folder()) / file, folder_ / file);
    std::filesystem::copy(std::filesystem::path(test::test_plugin_folder()) / "unusable/scanmill-exiting-at-load.so",
                          folder_ / "scanmill-test-step.so", std::filesystem::copy_options::overwrite_existing);
    ::setenv("SCANMILL_PLUGIN_PATH", folder_.path().c_str(), 1);
    library_ = FilterLibrary({folder_.path()});
    prepare("  - test-step:\n", {scan("a.xyz")});
    const RunReport report = run_with({test::program_file(), "worker"});
    EXPECT_EQ(report.cells[0].failure.cause, Cause::exit);
    EXPECT_EQ(report.cells[0].failure.number, 3);
    const std::string module = (folder_ / "scanmill-test-step.so").string();
    EXPECT_THAT(report.cells[0].failure.error.frames(),
                testing::ElementsAre("while loading the module '" + module + "'", HasSubstr("in step 'test-step'")));
}

TEST_F(WorkerProcessesTest, JobMessage_BringsEverythingOfAStep) {
    prepare(
        "  - test-step: {mode: warn, factor: 0.1, length: 3 spacing, log: /a path/with blanks}\n"
        "    expect: {points: \"> 3\", length: [0.1 u, 0.2 u], more: 0}\n",
        {scan("a.xyz")});
    Job job;
    job.node = 7;
    job.frame = "in step 'x'";
    job.scan = "\xff";
    job.threads = 3;
    job.seed = ~std::uint64_t(0);
    job.memory_limit = u64(1) << 40;
    job.seconds_limit = 0.1;
    StepWork work;
    work.step = std::shared_ptr<const PlannedStep>(graph_.plans[0], &graph_.plans[0]->steps[0]);
    work.build = "b";
    work.inputs = {{"points", 3, "mesh", "c", {}},
                   {"more", 4, "", "d", LeafSource{"/a", "d", kind_of<PointCloud>(), {}, "", {}}}};
    work.parameter_files = {{"/a path", "content"}};
    work.caching = {true, "plan", "code", 0.1, {"points", "mesh"}, "workflow"};
    job.work = work;
    const Job received = job_from(to_message(job), library_);
    EXPECT_EQ(received.node, 7u);
    EXPECT_EQ(received.frame, job.frame);
    EXPECT_EQ(received.scan, job.scan);
    EXPECT_EQ(received.threads, 3u);
    EXPECT_EQ(received.seed, job.seed);
    EXPECT_EQ(received.memory_limit, job.memory_limit);
    EXPECT_EQ(received.seconds_limit, 0.1);
    const auto& arrived = std::get<StepWork>(received.work);
    EXPECT_EQ(arrived.build, "b");
    EXPECT_EQ(arrived.inputs[0].port, "points");
    EXPECT_EQ(arrived.inputs[0].node, 3u);
    EXPECT_EQ(arrived.inputs[0].from, "mesh");
    EXPECT_EQ(arrived.inputs[0].content, "c");
    EXPECT_FALSE(arrived.inputs[0].leaf);
    ASSERT_TRUE(arrived.inputs[1].leaf);
    EXPECT_EQ(arrived.inputs[1].leaf->file, "/a");
    EXPECT_EQ(arrived.parameter_files[0].path, "/a path");
    EXPECT_EQ(arrived.caching.plan_key, "plan");
    EXPECT_EQ(arrived.caching.code, "code");
    EXPECT_TRUE(arrived.caching.is_used);
    EXPECT_EQ(arrived.caching.inputs_cost, 0.1);
    EXPECT_EQ(arrived.caching.needed, work.caching.needed);
    EXPECT_EQ(arrived.caching.workflow, "workflow");
    const PlannedStep &sent = *work.step, &step_there = *arrived.step;
    EXPECT_EQ(step_there.label, sent.label);
    ASSERT_EQ(step_there.parameters.values.size(), sent.parameters.values.size());
    for (std::size_t i = 0; i < sent.parameters.values.size(); ++i) {
        EXPECT_EQ(step_there.parameters.values[i].first, sent.parameters.values[i].first);
        EXPECT_EQ(step_there.parameters.values[i].second, sent.parameters.values[i].second);
    }
    ASSERT_EQ(step_there.expectations.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(step_there.expectations[i].name, sent.expectations[i].name);
        EXPECT_EQ(step_there.expectations[i].relation, sent.expectations[i].relation);
        EXPECT_EQ(step_there.expectations[i].low, sent.expectations[i].low);
        EXPECT_EQ(step_there.expectations[i].high, sent.expectations[i].high);
        EXPECT_EQ(step_there.expectations[i].text, sent.expectations[i].text);
    }
}

TEST_F(WorkerProcessesTest, JobMessage_BringsAFileToRead_AndItsPose) {
    RigidTransform pose;
    pose.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    pose.translation = Vec3(0.1, 1e6, -0.0);
    pose.unit = LengthUnit::metre;
    pose.to = "lab";
    Job job;
    job.work = ReadWork{{"/a \xff.ply", "hash", kind_of<TriangleMesh>(), LengthUnit::inch, "part", pose}, {}};
    const Job received = job_from(to_message(job), library_);
    const LeafSource& leaf = std::get<ReadWork>(received.work).leaf;
    EXPECT_EQ(leaf.file, "/a \xff.ply");
    EXPECT_EQ(leaf.content, "hash");
    EXPECT_EQ(leaf.kind, kind_of<TriangleMesh>());
    EXPECT_EQ(leaf.unit, LengthUnit::inch);
    EXPECT_EQ(leaf.frame, "part");
    ASSERT_TRUE(leaf.pose);
    EXPECT_EQ(leaf.pose->rotation, pose.rotation);
    EXPECT_EQ(leaf.pose->translation, pose.translation);
    EXPECT_EQ(leaf.pose->unit, pose.unit);
    EXPECT_EQ(leaf.pose->to, "lab");
}

TEST_F(WorkerProcessesTest, MessagesThatAreNone_AreErrors) {
    for (const std::string& bytes : {std::string(), std::string("x"), std::string("\xa0"), std::string("\x80")}) {
        EXPECT_THAT(sentence_of([&] { job_from(bytes, library_); }), HasSubstr("message"));
        EXPECT_THAT(sentence_of([&] { worker_message_from(bytes); }), HasSubstr("message"));
    }
}

}  // namespace
}  // namespace scanmill::test
