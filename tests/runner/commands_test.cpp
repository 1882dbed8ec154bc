// SPDX-License-Identifier: GPL-3.0-or-later
// The command as its users see it: what is printed where, and exit codes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "support/real_data.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::vector<std::string> filters{"alpha-solid", "delaunay", "virtual-scan", "voxel-thin"};

/// A scan of a sphere by the program itself, written to `file`.
void write_sphere(const TemporaryFolder& folder, const std::string& name) {
    const auto workflow =
        folder.write("sphere.yaml", "scanmill: 1\nname: " + name +
                                        "\nsteps:\n  - virtual-scan: {shape: sphere, views: [8], resolution: 3 %diag}\n"
                                        "outputs: {\"{scan}.ply\": virtual-scan}\n");
    const ProgramResult made = scanmill_program({"run", workflow.string(), "-o", folder.path().string()});
    ASSERT_EQ(made.exit_code, 0) << made.err;
}

std::string quickstart() { return std::string(SCANMILL_SOURCE_DIR) + "/workflows/quickstart.yaml"; }

TEST(Command, Help_GoesToStdoutAndIsNoError) {
    const ProgramResult help = scanmill_program({"--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.err, IsEmpty());
    for (const char* command : {"run", "check", "list", "show", "info", "convert"}) {
        EXPECT_THAT(help.out, HasSubstr(command));
        const ProgramResult of_command = scanmill_program({command, "--help"});
        EXPECT_EQ(of_command.exit_code, 0);
        EXPECT_THAT(of_command.out, HasSubstr("--help"));
    }
}

TEST(Command, Version_IsPrinted) { EXPECT_THAT(scanmill_program({"--version"}).out, HasSubstr("scanmill 0.")); }

TEST(Command, BadArguments_EndWith2AndAHint) {
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{},
                                               {"frobnicate"},
                                               {"run"},
                                               {"show"},
                                               {"show", "no-such-filter"},
                                               {"check", "--format", "xml", "x"},
                                               {"run", "no-such-workflow.yaml", "x.ply"},
                                               {"run", quickstart()},
                                               {"run", quickstart(), "x.ply", "--unit", "yard"},
                                               {"run", quickstart(), "x.ply", "--set", "bin-size"},
                                               {"run", quickstart(), "x.ply", "--set", "nothing=1"},
                                               {"run", quickstart(), "x.ply", "--only", "nothing"},
                                               {"run", quickstart(), "x.ply", "--until", "nothing"},
                                               {"run", quickstart(), "x.ply", "--in", "nothing=x"},
                                               {"run", quickstart(), "x.ply", "--seed", "-1"},
                                               {"run", quickstart(), "x.ply", "--seed", "010"},
                                               {"run", quickstart(), "x.ply", "--seed", "18446744073709551616"},
                                               {"run", quickstart(), "x.ply", "--threads", "two"},
                                               {"run", quickstart(), "x.ply", "-o", ""},
                                               {"run", quickstart(), "x.ply", "-o", quickstart() + "/out"},
                                               {"convert", "a"}}) {
        const ProgramResult result = scanmill_program(arguments);
        EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
        EXPECT_THAT(result.out, IsEmpty());
        EXPECT_THAT(result.err, Not(IsEmpty()));
    }
}

TEST(Command, List_NamesEveryFilterInTextAndJson) {
    const ProgramResult text = scanmill_program({"list"});
    EXPECT_EQ(text.exit_code, 0);
    const json listed = json::parse(scanmill_program({"list", "--json"}).out);
    EXPECT_EQ(listed.at("scanmill"), 1);
    std::vector<std::string> names;
    for (const json& filter : listed.at("filters")) names.push_back(filter.at("name"));
    for (const std::string& filter : filters) {
        EXPECT_THAT(text.out, HasSubstr(filter));
        EXPECT_THAT(names, testing::Contains(filter));
    }
}

TEST(Command, List_LoadsNoModule) {
    // A manifest whose module could never be loaded is listed all the same.
    const TemporaryFolder folder;
    std::string manifest = content_of(std::string(SCANMILL_PLUGIN_DIR) + "/scanmill-voxel-thin.json");
    const std::string name = "\"name\": \"voxel-thin\"";
    manifest.replace(manifest.find(name), name.size(), "\"name\": \"other-thin\"");
    folder.write("scanmill-other-thin.json", manifest);
    folder.write("scanmill-other-thin.so", "no module");
    const ProgramOptions with_folder{.folder = {}, .environment = {"SCANMILL_PLUGIN_PATH=" + folder.path().string()}};
    EXPECT_THAT(scanmill_program({"list"}, with_folder).out, HasSubstr("other-thin"));
    const auto workflow =
        folder.write("w.yaml", "scanmill: 1\ninputs: {scan: points}\nsteps: [{other-thin: {bin-size: 1 u}}]\n");
    EXPECT_EQ(scanmill_program({"check", workflow.string()}, with_folder).exit_code, 0);
    const auto scan = folder.write("scan.xyz", "0 0 0\n1 1 1\n");
    const ProgramResult ran =
        scanmill_program({"run", workflow.string(), scan.string(), "-o", folder.path().string()}, with_folder);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, HasSubstr("cannot be loaded"));
}

TEST(Command, Modules_AreNeverTakenFromTheWorkingFolder) {
    const TemporaryFolder folder;
    folder.write("scanmill-mine.json", "{}");
    folder.write("scanmill-mine.so", "");
    for (const char* variable : {"SCANMILL_PLUGIN_PATH=", "SCANMILL_PLUGIN_PATH=.", "SCANMILL_PLUGIN_PATH=:"}) {
        const ProgramResult listed =
            scanmill_program({"list", "--json"}, {.folder = folder.path(), .environment = {variable}});
        EXPECT_EQ(json::parse(listed.out).at("unusable").size(), 0u) << variable;
    }
}

TEST(Command, ShowExample_IsAWorkflowThatPassesCheck) {
    const TemporaryFolder folder;
    for (const std::string& filter : filters) {
        const ProgramResult shown = scanmill_program({"show", filter, "--example"});
        EXPECT_EQ(shown.exit_code, 0);
        if (filter == "alpha-solid") continue;  // takes tets, which no file holds
        const ProgramResult checked = scanmill_program({"check", folder.write(filter + ".yaml", shown.out).string()});
        EXPECT_EQ(checked.exit_code, 0) << shown.out << checked.err;
    }
}

TEST(Command, Show_PrintsEveryParameterWithItsDefaultAndMeaning) {
    const json listed = json::parse(scanmill_program({"list", "--json"}).out);
    for (const json& filter : listed.at("filters")) {
        const std::string text = scanmill_program({"show", filter.at("name")}).out;
        for (const json& parameter : filter.at("parameters")) {
            EXPECT_THAT(text, HasSubstr(parameter.at("name").get<std::string>()));
            EXPECT_THAT(text, HasSubstr(parameter.at("help").get<std::string>()));
        }
    }
}

TEST(Command, Check_PrintsAllErrorsAtOnceAndEndsWith2) {
    const TemporaryFolder folder;
    const auto workflow = folder.write("w.yaml", R"(scanmill: 1
name: seven-mistakes
inputs: {scan: points}
steps:
  - voxel-thinn: {bin-size: 1 %diag}
  - voxel-thin: {bin-siz: 1 %diag, bin-size: 0.5}
  - delaunay:
  - alpha-solid: {coverage: 300 %}
    in: {tets: scan}
  - delaunay:
    delaunay:
outputs:
  "../{scan}.stl": alpha-solid
)");
    const ProgramResult checked = scanmill_program({"check", workflow.string()});
    EXPECT_EQ(checked.exit_code, 2);
    EXPECT_THAT(checked.out, IsEmpty());
    EXPECT_THAT(
        checked.err,
        AllOf(HasSubstr("w.yaml:5:5: there is no filter 'voxel-thinn'"), HasSubstr("did you mean 'voxel-thin'?"),
              HasSubstr("w.yaml:6:18: voxel-thin has no parameter 'bin-siz'"), HasSubstr("did you mean 'bin-size'?"),
              HasSubstr("w.yaml:6:46: bin-size: '0.5' has no unit"), HasSubstr("w.yaml:8:29: coverage: 300 %"),
              HasSubstr("w.yaml:9:16: 'scan' is points"), HasSubstr("w.yaml:11:5: the key 'delaunay'"),
              HasSubstr("w.yaml:13:3: '../{scan}.stl' lies outside"), HasSubstr("7 errors")));
    const json found = json::parse(scanmill_program({"check", "--json", workflow.string()}).out);
    EXPECT_EQ(found.at("files").at(0).at("diagnostics").size(), 7u);
    EXPECT_FALSE(found.at("files").at(0).at("ok").get<bool>());
}

TEST(Command, CheckPlan_ShowsTheWiringInThreeForms) {
    const ProgramResult text = scanmill_program({"check", "--plan", quickstart()});
    EXPECT_EQ(text.exit_code, 0);
    EXPECT_THAT(text.out,
                AllOf(HasSubstr("points <- scan"), HasSubstr("tets <- delaunay"), HasSubstr("{scan}.stl <- surface")));
    EXPECT_THAT(scanmill_program({"check", "--plan", "--format", "dot", quickstart()}).out, HasSubstr("digraph"));
    const json plan = json::parse(scanmill_program({"check", "--plan", "--format", "json", quickstart()}).out);
    EXPECT_EQ(plan.at("files").at(0).at("plan").at("steps").size(), 3u);
}

TEST(Command, Run_WritesAClosedMeshAndATable) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const ProgramResult ran = scanmill_program(
        {"run", quickstart(), "ball.ply", "--set", "bin-size=1 %diag", "-o", "out"}, {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, AllOf(HasSubstr("kept"), HasSubstr("triangles"), HasSubstr("out/ball.stl"), HasSubstr("yes")));
    const json info = json::parse(scanmill_program({"info", "--json", (folder / "out/ball.stl").string()}).out);
    EXPECT_EQ(info.at("files").at(0).at("closed"), true);
    EXPECT_EQ(info.at("files").at(0).at("genus"), 0);
}

TEST(Command, RunJson_IsJsonWithKeysMetricsAndFiles) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const ProgramResult ran =
        scanmill_program({"run", quickstart(), "ball.ply", "--json", "-o", "out"}, {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json report = json::parse(ran.out);
    EXPECT_EQ(report.at("scanmill"), 1);
    ASSERT_EQ(report.at("cells").size(), 1u);
    const json& cell = report.at("cells").at(0);
    EXPECT_EQ(cell.at("outcome"), "done");
    EXPECT_EQ(cell.at("outputs").at(0).at("facts").at("closed"), true);
    for (const json& step : report.at("steps")) EXPECT_EQ(step.at("key").get<std::string>().size(), 32u);
}

TEST(Command, RunTwiceWithAnyThreads_WritesEqualBytes) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    for (const char* threads : {"1", "2"})
        ASSERT_EQ(scanmill_program({"run", quickstart(), "ball.ply", "--threads", threads, "-o", threads},
                                   {.folder = folder.path()})
                      .exit_code,
                  0);
    EXPECT_EQ(content_of(folder / "1/ball.stl"), content_of(folder / "2/ball.stl"));
    EXPECT_FALSE(content_of(folder / "1/ball.stl").empty());
}

TEST(Command, DryRun_WritesNothing) {
    const TemporaryFolder folder;
    folder.write("a.xyz", "0 0 0\n1 0 0\n");
    const ProgramResult ran =
        scanmill_program({"run", quickstart(), "a.xyz", "--dry-run", "-o", "out"}, {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_THAT(ran.out, HasSubstr("out/a.stl"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Command, OneBadScanAmongGoodOnes_FailsAloneWith1) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    folder.write("flat.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
    const ProgramResult ran = scanmill_program(
        {"run", quickstart(), "flat.xyz", "missing.ply", "ball.ply", "-o", "out"}, {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err,
                AllOf(HasSubstr("on scan 'flat.xyz'"), HasSubstr("in step 'delaunay'"), HasSubstr("missing.ply")));
    EXPECT_THAT(ran.out, HasSubstr("2 of 3 failed"));
    EXPECT_TRUE(std::filesystem::exists(folder / "out/ball.stl"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out/flat.stl"));
}

TEST(Command, TwoScansOfOneName_AreRefusedBeforeTheRun) {
    const TemporaryFolder folder;
    folder.write("a/s.xyz", "0 0 0\n1 0 0\n");
    folder.write("b/s.xyz", "0 0 0\n2 0 0\n");
    const ProgramResult ran =
        scanmill_program({"run", quickstart(), "a/s.xyz", "b/s.xyz", "-o", "out"}, {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("a/s.xyz"), HasSubstr("b/s.xyz"), HasSubstr("would both write")));
}

TEST(Command, Output_NeverReplacesAnInput) {
    const TemporaryFolder folder;
    folder.write("s.ply", "ply\n");
    const auto workflow = folder.write("w.yaml",
                                       "scanmill: 1\ninputs: {scan: points}\nsteps: [{voxel-thin: {bin-size: 1 "
                                       "u}}]\noutputs: {\"{scan}.ply\": voxel-thin}\n");
    const ProgramResult ran = scanmill_program({"run", "w.yaml", "s.ply", "-o", "."}, {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, HasSubstr("must not replace it"));
    EXPECT_EQ(content_of(folder / "s.ply"), "ply\n");
}

TEST(Command, AbsoluteLengthOnAScanOfUnknownUnit_SaysHowToDeclareIt) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const std::vector<std::string> run{"run", quickstart(), "ball.ply", "--set", "bin-size=20 um", "-o", "out"};
    const ProgramResult unknown = scanmill_program(run, {.folder = folder.path()});
    EXPECT_EQ(unknown.exit_code, 1);
    EXPECT_THAT(unknown.err, AllOf(HasSubstr("--unit mm"), HasSubstr("unit: mm")));
    std::vector<std::string> declared = run;
    declared.insert(declared.end(), {"--unit", "mm"});
    EXPECT_EQ(scanmill_program(declared, {.folder = folder.path()}).exit_code, 0);
}

TEST(Command, SaveAndUntil_WriteAndStopAtAStep) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const ProgramResult ran = scanmill_program(
        {"run", quickstart(), "ball.ply", "--save", "voxel-thin", "--until", "voxel-thin", "-o", "out"},
        {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/ball.voxel-thin.ply"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out/ball.stl"));
}

TEST(Command, Info_TellsOfEveryFileAndFailsOnlyForTheBad) {
    const TemporaryFolder folder;
    folder.write("a.xyz", "# unit mm\n0 0 0\n3 4 0\n");
    const ProgramResult info = scanmill_program({"info", "a.xyz", "none.xyz"}, {.folder = folder.path()});
    EXPECT_EQ(info.exit_code, 1);
    EXPECT_THAT(info.out, AllOf(HasSubstr("mm"), HasSubstr("points          2"), HasSubstr("diagonal        5")));
    EXPECT_THAT(info.err, HasSubstr("none.xyz"));
}

TEST(Command, Convert_KeepsPointsAndConvertsUnits) {
    const TemporaryFolder folder;
    folder.write("a.xyz", "0 0 0\n1 nan 0\n3000 4000 0\n");
    const ProgramOptions here{.folder = folder.path(), .environment = {}};
    EXPECT_EQ(scanmill_program({"convert", "a.xyz", "a.ply", "--unit", "mm", "--to-unit", "m", "--drop-invalid"}, here)
                  .exit_code,
              0);
    const json info = json::parse(scanmill_program({"info", "--json", "a.ply"}, here).out).at("files").at(0);
    EXPECT_EQ(info.at("points"), 2);
    EXPECT_EQ(info.at("unit"), "m");
    EXPECT_DOUBLE_EQ(info.at("diagonal"), 5);
    EXPECT_EQ(scanmill_program({"convert", "a.xyz", "b.ply", "--to-unit", "m"}, here).exit_code, 1) << "unknown unit";
    EXPECT_EQ(scanmill_program({"convert", "a.xyz", "a.xyz"}, here).exit_code, 1) << "its own input";
    EXPECT_EQ(scanmill_program({"convert", "a.xyz", "a.docx"}, here).exit_code, 1) << "no such format";
}

TEST(Command, RealScan_ThroughTheQuickstart) {
    SCANMILL_REAL_SCAN(kitten, fetched_data, "points_3/kitten.xyz");
    const TemporaryFolder folder;
    const ProgramResult ran =
        scanmill_program({"run", quickstart(), kitten.string(), "--json", "-o", "out"}, {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json facts = json::parse(ran.out).at("cells").at(0).at("outputs").at(0).at("facts");
    EXPECT_EQ(facts.at("closed"), true);
    EXPECT_EQ(facts.at("genus"), 1);
    EXPECT_EQ(facts.at("components"), 1);
}

}  // namespace
}  // namespace scanmill::test
