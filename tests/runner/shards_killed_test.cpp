// SPDX-License-Identifier: GPL-3.0-or-later
// Shards that are killed and run again: nothing but the running cells is lost, and the merged run is that of one
// machine.

#include "runner/divided_batch.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <set>
#include <thread>

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

class KilledShards : public DividedBatch {
protected:
    KilledShards() { environment_.push_back("SCANMILL_TEST_HOLD=" + (folder_ / "hold").string()); }

    /// Scans a_1 … a_3, b_1, b_2 and c_1 … c_9. The last step has two variants. It has this mode for the scans b.
    void write(const std::string& mode) {
        for (const auto& [name, count] : {std::pair("a", 3), {"b", 2}, {"c", 9}})
            for (int i = 1; i <= count; ++i)
                folder_.write(fmt::format("held/{}_{}.xyz", name, i),
                              fmt::format("0 0 0\n{0} 0 0\n0 2 0\n1 2 {1}\n", i, name[0] - 'a' + 1));
        folder_.write("h.yaml",
                      "scanmill: 1\nname: h\ninputs: {scan: points}\nparameters: {mode: slow}\nsteps:\n"
                      "  - id: shared\n    test-step: {factor: 0.5}\n"
                      "  - id: last\n    test-step: {mode: $mode, factor: {sweep: [1, 2]}}\n"
                      "    in: {points: shared.points}\noutputs: {'{scan}-{variant}.ply': last}\n");
        folder_.write("held.yaml", "scanmill: 1\nbatch: held\nscans: [held/a_*.xyz, {path: held/b_*.xyz, set: {mode: " +
                                       mode + "}}, held/c_*.xyz]\nworkflows: h.yaml\ngate: {points: exact}\n");
    }
    json status() {
        const std::string text = scanmill({"batch", "--status", "cluster", "--json"}).out;
        return json::parse(text)["chunks"];
    }
    /// By scan and variant, whether the last step of the last run was computed or read from the cache.
    std::map<std::string, std::set<std::string>> origins(const std::string& out) {
        const json runs = json::parse(scanmill({"runs", out, "--json"}).out)["runs"];
        const json run = json::parse(scanmill({"runs", out, "show", runs.back()["id"].dump(), "--json"}).out);
        std::map<std::string, std::set<std::string>> origins;
        for (const json& step : run["steps"])
            if (step["step"] == "last") origins[step["scan"]].insert(step["origin"]);
        return origins;
    }
};

TEST_F(KilledShards, KilledChunk_LosesItsRunningCells_AndGoesOn) {
    write("held");
    const std::string changed = content_of(folder_ / "held/c_1.xyz");
    folder_.write("held/c_1.xyz", changed + "7 7 7\n");
    scanmill({"batch", "held.yaml", "-o", "before", "-q", "--no-cache"});
    folder_.write("held/c_1.xyz", changed);
    scanmill({"batch", "held.yaml", "-o", "one", "-q", "--no-cache"});
    ASSERT_EQ(scanmill({"export", "slurm", "held.yaml", "-o", "cluster", "--minutes", "0.16"}).exit_code, 0);
    const auto chunk = [](int number) {
        return std::vector<std::string>{"batch",   "held.yaml",
                                        "--cells", fmt::format("cluster/chunks/{:04}.json", number),
                                        "-o",      fmt::format("cluster/parts/{:04}", number),
                                        "-j",      "2"};
    };
    ASSERT_EQ(status().size(), 3u) << "five scans each: the first chunk has a_1 to a_3, b_1 and b_2";

    folder_.write("hold", "");
    {
        ProgramOptions own = options();
        own.own_group = true;
        RunningProgram job(chunk(1), own);
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        const auto has_ended = [&](const char* step) { return job.err().find(step) != std::string::npos; };
        while (!job.has_ended() && std::chrono::steady_clock::now() < deadline &&
               !((has_ended("b_1.xyz: shared") || has_ended("b_2.xyz: shared")) &&
                 outputs("cluster/parts/0001").size() >= 2u * 6))
            std::this_thread::sleep_for(std::chrono::milliseconds(60));
        EXPECT_EQ(status()[0]["state"], "running");
        EXPECT_THAT(merge({"cluster/parts/0001"}).err, HasSubstr("has not ended yet"));
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // records are written every second
        ASSERT_FALSE(job.has_ended()) << job.err();
        job.signal_group(SIGKILL);
        EXPECT_EQ(job.wait().exit_code, -SIGKILL);
    }
    fs::remove(folder_ / "hold");
    const json killed = status()[0];
    EXPECT_EQ(killed["state"], "failed");
    EXPECT_EQ(killed["cells"], 6) << "the cells that had finished";
    EXPECT_EQ(status()[1]["state"], "waiting");
    const ProgramResult told = scanmill({"batch", "--status", "cluster"});
    EXPECT_EQ(told.exit_code, 1);
    EXPECT_THAT(told.out, testing::AllOf(HasSubstr("6 cells are recorded in 3 chunks"), HasSubstr("submit.sh 1"),
                                         HasSubstr("cells that had finished are in the cache")));

    for (const int number : {3, 2}) EXPECT_EQ(scanmill(chunk(number)).exit_code, 0);
    const std::vector<std::string> parts{"cluster/parts/0003", "cluster/parts/0001", "cluster/parts/0002"};
    const ProgramResult early = merge(parts);
    EXPECT_EQ(early.exit_code, 2);
    EXPECT_THAT(early.err, testing::AllOf(HasSubstr("shard 1/3"), HasSubstr("unfinished"), HasSubstr("hint: ")));

    EXPECT_EQ(scanmill(chunk(1)).exit_code, 0);
    for (const auto& [scan, origin] : origins("cluster/parts/0001"))
        EXPECT_THAT(origin, testing::ElementsAre(scan.starts_with("held/a_") ? "cached" : "ran")) << scan;
    for (const json& each : status()) EXPECT_EQ(each["state"], "done");

    EXPECT_EQ(merge(parts).exit_code, 0);
    EXPECT_THAT(differences(outputs("whole"), outputs("one")), IsEmpty());
    EXPECT_EQ(outputs("one").size(), 2u * 28);
    EXPECT_EQ(report("whole"), report("one"));
    const std::vector<std::string> against{"--against", "before"};
    EXPECT_EQ(report("whole", against), report("one", against));
    EXPECT_EQ(report("one", against)["verdict"], "regressed");
    EXPECT_EQ(scanmill({"report", "whole", "--against", "before"}).exit_code, 4);
}

TEST_F(KilledShards, KilledAtAnyMoment_MergeToTheRunOfOneMachine) {
    write("slow");
    scanmill({"batch", "held.yaml", "-o", "one", "-q", "--no-cache"});
    static constexpr int count = 3;
    const auto arguments = [](int number) {
        return std::vector<std::string>{
            "batch", "held.yaml", "--shard", fmt::format("{}/{}", number, count), "-o", fmt::format("p{}", number),
            "-j",    "2",         "-q"};
    };
    std::mt19937 random(5);
    std::uniform_int_distribution<int> moment(20, 300);
    int killed = 0;
    for (int round = 0; round < 2; ++round) {
        fs::remove_all(folder_ / "home");
        for (int number = 1; number <= count; ++number) {
            fs::remove_all(folder_ / fmt::format("p{}", number));
            for (int kill = 0; kill < 2; ++kill) {
                ProgramOptions own = options();
                own.own_group = true;
                RunningProgram job(arguments(number), own);
                std::this_thread::sleep_for(std::chrono::milliseconds(moment(random)));
                kill == 0 ? job.signal_group(SIGKILL) : job.signal(SIGKILL);
                killed += job.wait().exit_code == -SIGKILL;
            }
        }
        for (int number = 1; number <= count; ++number) EXPECT_EQ(scanmill(arguments(number)).exit_code, 0);
        const std::string out = fmt::format("whole{}", round);
        EXPECT_EQ(merge_shuffled("p", count, static_cast<unsigned>(round), out).exit_code, 0);
        EXPECT_THAT(differences(outputs(out), outputs("one")), IsEmpty());
        EXPECT_EQ(report(out), report("one"));
    }
    EXPECT_GE(killed, 4) << "the others ended before they were killed";
}

}  // namespace
}  // namespace scanmill::test
