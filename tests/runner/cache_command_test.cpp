// SPDX-License-Identifier: GPL-3.0-or-later
// The cache on the command line: a second run, a dry run, its size, and emptying it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class CacheCommand : public testing::Test {
protected:
    CacheCommand() {
        // With normals, so that it is read whole: what is read as a stream is not kept.
        folder_.write("a.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 2 0 0 0 1\n1 2 2 0 0 1\n");
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.1 u}\n"
                      "outputs: {'{scan}.ply': voxel-thin}\n");
    }
    ProgramResult scanmill(std::vector<std::string> arguments) {
        return scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
    }
    ProgramResult run(const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"run", "w.yaml", "a.xyz", "-o", "out"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return scanmill(std::move(arguments));
    }
    TemporaryFolder folder_;
};

TEST_F(CacheCommand, SecondRun_SaysWhatWasCachedAndWritesTheSame) {
    EXPECT_EQ(run({"--keep", "always"}).exit_code, 0);
    const std::string first = content_of(folder_ / "out/a.ply");
    std::filesystem::remove_all(folder_ / "out");
    const ProgramResult again = run();
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_THAT(again.err, HasSubstr("voxel-thin cached"));
    EXPECT_EQ(content_of(folder_ / "out/a.ply"), first);
    const json report = json::parse(run({"--json"}).out);
    EXPECT_EQ(report["steps"][1]["origin"], "cached");
}

TEST_F(CacheCommand, DryRun_NamesWhatIsCachedAndWhyTheRestRuns) {
    run({"--keep", "always"});
    EXPECT_THAT(run({"--dry-run"}).out, AllOf(HasSubstr("0 to compute, 2 cached"), Not(HasSubstr("because"))));
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.2 u}\n"
                  "outputs: {'{scan}.ply': voxel-thin}\n");
    EXPECT_THAT(run({"--dry-run"}).out,
                AllOf(HasSubstr("1 to compute, 1 cached"),
                      HasSubstr("will run because bin-size changed 0.1 u → 0.2 u since run 1")));
    const json planned = json::parse(run({"--dry-run", "--json"}).out);
    EXPECT_EQ(planned["nodes"][0]["cached"], true);
    EXPECT_EQ(planned["nodes"][1]["cached"], false);
}

TEST_F(CacheCommand, NoCache_TouchesNone) {
    EXPECT_EQ(run({"--no-cache"}).exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "home"));
    EXPECT_EQ(run({"--no-cache", "--cache", "x"}).exit_code, 2) << "which of the two?";
}

TEST_F(CacheCommand, InfoAndClear_AreAboutTheSameFolder) {
    run({"--keep", "always"});
    const json full = json::parse(scanmill({"cache", "info", "--json"}).out);
    EXPECT_EQ(full["steps"], 2);
    EXPECT_GT(full["bytes"], 0);
    EXPECT_EQ(full["folder"], (folder_ / "home/scanmill").string());
    EXPECT_THAT(scanmill({"cache", "info"}).out, AllOf(HasSubstr("steps   2"), HasSubstr("size by filter"),
                                                       HasSubstr("voxel-thin"), HasSubstr("last day")));
    EXPECT_THAT(scanmill({"cache", "info"}).out, ContainsRegex("size by workflow\n  w +[0-9.]+ "));
    EXPECT_EQ(full["by-workflow"][0]["workflow"], "w");
    const auto sum = [](const json& uses) {
        std::int64_t bytes = 0;
        for (const json& use : uses) bytes += use["bytes"].get<std::int64_t>();
        return bytes;
    };
    EXPECT_EQ(sum(full["by-filter"]), full["bytes"]);
    EXPECT_EQ(sum(full["by-workflow"]), full["bytes"]);
    EXPECT_EQ(sum(full["by-age"]), full["bytes"]);
    EXPECT_EQ(scanmill({"cache", "clear"}).exit_code, 0);
    EXPECT_EQ(json::parse(scanmill({"cache", "info", "--json"}).out)["bytes"], 0);
    EXPECT_THAT(run({"--dry-run"}).out, HasSubstr("2 to compute, 0 cached"));
}

TEST_F(CacheCommand, ResultOfSeveralWorkflows_CountsForTheFirst) {
    run({"--keep", "always"});
    const auto uses = [&] {
        const json info = json::parse(scanmill({"cache", "info", "--json"}).out);
        std::map<std::string, std::int64_t> bytes;
        for (const json& use : info["by-workflow"]) bytes[use["workflow"]] = use["bytes"].get<std::int64_t>();
        return bytes;
    };
    const auto before = uses();
    const std::string steps = "inputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.1 u}\n";
    folder_.write("w.yaml", "scanmill: 1\nname: other\n" + steps + "outputs: {'{scan}.ply': voxel-thin}\n");
    run({"--keep", "always"});
    EXPECT_EQ(uses(), before) << "nothing was computed";
    folder_.write("w.yaml", "scanmill: 1\nname: other\n" + steps +
                                "  - id: again\n    voxel-thin: {bin-size: 5 u}\noutputs: {'{scan}.ply': again}\n");
    run({"--keep", "always"});
    EXPECT_EQ(uses().at("w"), before.at("w"));
    EXPECT_GT(uses().at("other"), 0);
    EXPECT_THAT(scanmill({"cache", "info"}).out, HasSubstr("\n  other "));
}

TEST_F(CacheCommand, FolderOfItsOwn_IsUsed) {
    run({"--cache", "mine", "--keep", "always"});
    EXPECT_TRUE(std::filesystem::exists(folder_ / "mine/v1/steps"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "home"));
    EXPECT_EQ(json::parse(scanmill({"cache", "info", "--json", "--cache", "mine"}).out)["steps"], 2);
}

TEST_F(CacheCommand, LimitThatIsReached_RemovesAtTheEndOfTheRun) {
    EXPECT_EQ(run({"--keep", "always", "--cache-limit", "1 kB"}).exit_code, 0);
    EXPECT_LE(json::parse(scanmill({"cache", "info", "--json"}).out)["bytes"], 1000);
    const ProgramResult refused = run({"--cache-limit", "much"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("'much' is not a size; expected 500 MiB"));
}

TEST_F(CacheCommand, WithoutAHome_TheRunGoesOnWithoutACache) {
    const ProgramResult ran = scanmill_program(
        {"run", "w.yaml", "a.xyz", "-o", "out"},
        {.folder = folder_.path(), .environment = {"XDG_CACHE_HOME=relative", "HOME="}, .cache = folder_ / "home"});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("there is no folder for the cache"), HasSubstr("results are not cached")));
}

}  // namespace
}  // namespace scanmill::test
