// SPDX-License-Identifier: GPL-3.0-or-later
// The records as a user meets them: a line per run, and all of one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "scanmill/records/run_records.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class RunsCommand : public testing::Test {
protected:
    RunsCommand() {
        folder_.write("a.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 2\n");
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.1 u}\n"
                      "outputs: {'{scan}.ply': voxel-thin}\n");
    }
    ProgramResult scanmill(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
    }
    TemporaryFolder folder_;
};

TEST_F(RunsCommand, EveryRun_IsALine) {
    scanmill({"run", "w.yaml", "a.xyz", "-o", "out", "--keep", "always"});
    scanmill({"run", "w.yaml", "a.xyz", "missing.xyz", "-o", "out"});
    const json runs = json::parse(scanmill({"runs", "out", "--json"}).out)["runs"];
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_EQ(runs[0]["outcome"], "ok");
    EXPECT_EQ(runs[0]["ran"], 2);
    EXPECT_EQ(runs[0]["cached"], 0);
    EXPECT_EQ(runs[1]["outcome"], "failed");
    EXPECT_EQ(runs[1]["cells"], 2);
    EXPECT_EQ(runs[1]["failed"], 1);
    EXPECT_EQ(runs[1]["cached"], 2) << "what the first run kept";
    EXPECT_THAT(scanmill({"runs", "out"}).out, AllOf(HasSubstr("run"), HasSubstr("failed"), HasSubstr("ok")));
}

TEST_F(RunsCommand, Show_SaysEverythingOfOne) {
    scanmill({"run", "w.yaml", "a.xyz", "missing.xyz", "-o", "out", "--seed", "7", "-j", "1"});
    const json run = json::parse(scanmill({"runs", "out", "show", "1", "--json"}).out);
    EXPECT_EQ(run["run"]["seed"], 7);
    EXPECT_EQ(run["run"]["arguments"][1], "run");
    EXPECT_EQ(run["cells"][1]["outcome"], "failed");
    EXPECT_THAT(run["cells"][1]["error"].get<std::string>(), HasSubstr("missing.xyz"));
    const json& thin = run["steps"][1];
    EXPECT_EQ(thin["filter"], "voxel-thin");
    EXPECT_EQ(thin["authored"]["bin-size"], "0.1 u");
    EXPECT_EQ(thin["metrics"]["kept"], 4);
    EXPECT_EQ(thin["origin"], "ran");
    EXPECT_THAT(scanmill({"runs", "out", "show", "1"}).out,
                AllOf(HasSubstr("voxel-thin"), HasSubstr("missing.xyz"), HasSubstr("seed 7")));
}

TEST_F(RunsCommand, Outputs_HaveTheHashThatSha256sumGives) {
    scanmill({"run", "w.yaml", "a.xyz", "-o", "out"});
    const json output = json::parse(scanmill({"runs", "out", "show", "1", "--json"}).out)["cells"][0]["outputs"][0];
    const std::string file = (folder_ / "out/a.ply").string();
    ASSERT_EQ(std::system(("sha256sum '" + file + "' > '" + (folder_ / "sum").string() + "'").c_str()), 0);
    const std::string sum = content_of(folder_ / "sum").substr(0, 64);
    EXPECT_EQ(output["sha256"], sum);
    EXPECT_EQ(output["bytes"], std::filesystem::file_size(file));
    EXPECT_EQ(json::parse(content_of(file + ".json"))["file"]["sha256"], sum) << "the description agrees";
}

TEST_F(RunsCommand, StepsAndCells_NameTheirVariants) {
    folder_.write("v.yaml",
                  "scanmill: 1\nname: v\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.1 u}\n"
                  "  - id: last\n    voxel-thin: {bin-size: {sweep: [0.2 u, 0.3 u, 0.4 u, 0.5 u]}}\n");
    scanmill({"run", "v.yaml", "a.xyz", "missing.xyz", "-o", "out"});
    const json run = json::parse(scanmill({"runs", "out", "show", "1", "--json"}).out);
    std::map<std::size_t, std::size_t> uses;
    for (const json& cell : run["cells"])
        for (const json& node : cell["steps"]) ++uses[node.get<std::size_t>()];
    for (const json& step : run["steps"])
        if (step["scan"] == "a.xyz") {
            EXPECT_EQ(uses[step["node"]], step["step"] == "last" ? 1u : 4u) << step;
        }
    const std::string text = scanmill({"runs", "out", "show", "1"}).out;
    EXPECT_THAT(text, AllOf(HasSubstr("bin-size=0.2u, bin-size=0.3u, bin-size=0.4u and 1 more"),
                            HasSubstr("missing.xyz [bin-size=0.2u, bin-size=0.3u, bin-size=0.4u and 1 more]: ")));
}

TEST_F(RunsCommand, AcceptedRuns_AreMarkedWithWhoAndWhy) {
    scanmill({"run", "w.yaml", "a.xyz", "-o", "out"});
    scanmill({"run", "w.yaml", "a.xyz", "-o", "out"});
    EXPECT_THAT(scanmill({"runs", "out"}).out, testing::Not(HasSubstr("accepted")));
    {
        RunRecords records = RunRecords::append_to(folder_ / "out/scanmill.sqlite");
        records.accept(1, "ann", "as ordered");
        records.accept(2, "ben", "by\nmistake");
        records.revoke("w", "cleo", "it was wrong");
    }
    const json runs = json::parse(scanmill({"runs", "out", "--json"}).out)["runs"];
    EXPECT_EQ(runs[0]["accepted"][0]["who"], "ann");
    EXPECT_EQ(runs[0]["accepted"][0]["baseline"], true);
    EXPECT_EQ(runs[1]["accepted"][0]["revoked"]["who"], "cleo");
    EXPECT_EQ(runs[1]["accepted"][0]["baseline"], false);
    EXPECT_THAT(scanmill({"runs", "out"}).out,
                AllOf(HasSubstr("baseline, by ann: as ordered"),
                      HasSubstr("by ben: by\\nmistake (revoked by cleo: it was wrong)")));
    EXPECT_THAT(scanmill({"runs", "out", "show", "1"}).out, HasSubstr("accepted  baseline, by ann: as ordered"));
}

TEST_F(RunsCommand, DryRun_NamesWhatChangedSinceTheLastRun) {
    const std::string steps =
        "  - id: first\n    voxel-thin: {bin-size: SIZE}\n  - id: second\n    voxel-thin: {bin-size: 0.3 u}\n";
    const auto write = [&](const std::string& size) {
        std::string text =
            "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n" + steps + "outputs: {'{scan}.ply': second}\n";
        text.replace(text.find("SIZE"), 4, size);
        folder_.write("w.yaml", text);
    };
    const auto dry = [&](const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"run", "w.yaml", "a.xyz", "-o", "out", "--dry-run"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return scanmill(arguments).out;
    };
    write("0.1 u");
    EXPECT_THAT(dry(), HasSubstr("will run because it has not run with these inputs"));
    scanmill({"run", "w.yaml", "a.xyz", "-o", "out", "--keep", "always"});
    EXPECT_THAT(dry(), HasSubstr("0 to compute"));
    write("0.2 u");
    EXPECT_THAT(dry(), AllOf(HasSubstr("will run because bin-size changed 0.1 u → 0.2 u since run 1"),
                             HasSubstr("will run because the result of 'first' may change since run 1")));
    write("0.1 u");
    EXPECT_THAT(dry({"--seed", "3"}), HasSubstr("the seed changed 0 → 3"));
    folder_.write("a.xyz", "0 0 0\n5 0 0\n");
    EXPECT_THAT(dry(),
                AllOf(HasSubstr("the file, its unit or its frame changed since run 1"), HasSubstr("the scan changed")));
    scanmill({"cache", "clear"});
    folder_.write("a.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 2\n");
    EXPECT_THAT(dry(), HasSubstr("its result is not in the cache"));
}

TEST_F(RunsCommand, MissingRunsAndFolders_AreReported) {
    const ProgramResult nothing = scanmill({"runs", "nowhere"});
    EXPECT_EQ(nothing.exit_code, 2);
    EXPECT_THAT(nothing.err, AllOf(HasSubstr("does not exist"), HasSubstr("hint")));
    scanmill({"run", "w.yaml", "a.xyz", "-o", "out"});
    EXPECT_THAT(scanmill({"runs", "out", "show", "5"}).err, HasSubstr("there is no run 5"));
    EXPECT_THAT(scanmill({"runs", "out", "show", "x"}).err, HasSubstr("'x' is not the number of a run"));
    EXPECT_THAT(scanmill({"runs", "out", "show"}).err, HasSubstr("needs the number of a run"));
}

TEST_F(RunsCommand, RecordsThatCannotBeWritten_DoNotStopTheRun) {
    folder_.write("out/scanmill.sqlite", "another program's file, long enough to be read as a database");
    const ProgramResult ran = scanmill({"run", "w.yaml", "a.xyz", "-o", "out"});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_THAT(ran.err, HasSubstr("this run is not recorded"));
    EXPECT_THAT(content_of(folder_ / "out/scanmill.sqlite"), HasSubstr("another program's"));
}

}  // namespace
}  // namespace scanmill::test
