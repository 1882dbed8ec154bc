// SPDX-License-Identifier: GPL-3.0-or-later
// The command as its users see it: what is printed where, and exit codes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "scanmill/formats/files.hpp"
#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::vector<std::string> all_filters{"alpha-solid", "crop",         "delaunay",        "edge-flip",
                                           "features",    "merge",        "outlier-removal", "region-grow",
                                           "sculpt",      "virtual-scan", "voxel-thin"};

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

/// The status of the program when its reader has gone, which a shell reports as 128 and the number of the signal.
TEST(Command, OutputThatNobodyReads_EndsQuietly) {
    for (const char* caller : {"", "trap '' PIPE; "}) {
        const TemporaryFolder folder;
        const std::string command = std::string(caller) + "{ sleep 0.3; '" + program_file() + "' list 2> '" +
                                    (folder / "err").string() + "'; echo $? > '" + (folder / "code").string() +
                                    "'; } | true";
        ASSERT_EQ(std::system(command.c_str()), 0);
        EXPECT_EQ(content_of(folder / "err"), "");
        EXPECT_EQ(content_of(folder / "code"), "141\n");
    }
}

TEST(Command, BadArguments_EndWith2AndAHint) {
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {},
             {"frobnicate"},
             {"run"},
             {"show"},
             {"show", "no-such-filter"},
             {"check", "--format", "xml", "x"},
             {"run", "no-such-workflow.yaml", "x.ply"},
             {"run", shipped("quickstart.yaml")},
             {"run", shipped("quickstart.yaml"), "x.ply", "--unit", "yard"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--set", "bin-size"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--set", "nothing=1"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--only", "nothing"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--until", "nothing"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--in", "nothing=x"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--seed", "-1"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--seed", "010"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--seed", "18446744073709551616"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--threads", "two"},
             {"run", shipped("quickstart.yaml"), "x.ply", "-o", ""},
             {"run", shipped("quickstart.yaml"), "x.ply", "-o", shipped("quickstart.yaml") + "/out"},
             {"convert", "a"}}) {
        const ProgramResult result = scanmill_program(arguments);
        EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
        EXPECT_THAT(result.out, IsEmpty());
        EXPECT_THAT(result.err, Not(IsEmpty()));
    }
}

TEST(Command, UnknownOptions_AreNamedWithTheOneThatIsMeant) {
    const std::string workflow = shipped("quickstart.yaml");
    for (const auto& [arguments, unknown, meant] :
         std::vector<std::tuple<std::vector<std::string>, std::string, std::string>>{
             {{"run", workflow, "x.ply", "--out", "there"}, "'--out'", "did you mean '--output'?"},
             {{"run", workflow, "x.ply", "--units", "mm"}, "'--units'", "did you mean '--unit'?"},
             {{"run", "--thread=2", workflow, "x.ply"}, "'--thread'", "did you mean '--threads'?"},
             {{"cache", "info", "--jsn"}, "'--jsn'", "did you mean '--json'?"}}) {
        const ProgramResult result = scanmill_program(arguments);
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_THAT(result.err, AllOf(HasSubstr(unknown), HasSubstr(meant), HasSubstr("--help")));
    }
    const ProgramResult far = scanmill_program({"run", workflow, "x.ply", "--frobnicate"});
    EXPECT_EQ(far.exit_code, 2);
    EXPECT_THAT(far.err, AllOf(HasSubstr("'--frobnicate'"), Not(HasSubstr("did you mean"))));
}

TEST(Command, List_NamesEveryFilterInTextAndJson) {
    const ProgramResult text = scanmill_program({"list"});
    EXPECT_EQ(text.exit_code, 0);
    const json listed = json::parse(scanmill_program({"list", "--json"}).out);
    EXPECT_EQ(listed.at("scanmill"), 1);
    std::vector<std::string> names;
    for (const json& filter : listed.at("filters")) names.push_back(filter.at("name"));
    for (const std::string& filter : all_filters) {
        EXPECT_THAT(text.out, HasSubstr(filter));
        EXPECT_THAT(names, testing::Contains(filter));
    }
}

TEST(Command, List_LoadsNoModule) {
    // A manifest whose module could never be loaded is listed all the same.
    const TemporaryFolder folder;
    std::string manifest = content_of(test::plugin_folder() + "/scanmill-voxel-thin.json");
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

TEST(Command, UnknownCommand_IsNamedWithTheNearest) {
    const ProgramResult refused = scanmill_program({"inf", "x.ply"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, ContainsRegex("no command 'inf'.*mean 'info'"));
}

TEST(Command, ShowExample_IsAWorkflowThatPassesCheck) {
    const TemporaryFolder folder;
    for (const std::string& filter : all_filters) {
        const ProgramResult shown = scanmill_program({"show", filter, "--example"});
        EXPECT_EQ(shown.exit_code, 0);
        const ProgramResult checked = scanmill_program({"check", folder.write(filter + ".yaml", shown.out).string()});
        EXPECT_EQ(checked.exit_code, 0) << shown.out << checked.err;
    }
}

TEST(Command, ShowExample_OfFiltersThatLeadFromPointsToAMesh_Runs) {
    const TemporaryFolder folder;
    std::string lattice;
    for (int i = 0; i < 64; ++i)
        lattice += std::to_string(i % 4) + " " + std::to_string(i / 4 % 4) + " " + std::to_string(i / 16) + "\n";
    const auto scan = folder.write("cube.xyz", lattice);
    for (const std::string filter : {"voxel-thin", "delaunay", "alpha-solid", "sculpt"}) {
        const auto example = folder.write(filter + ".yaml", scanmill_program({"show", filter, "--example"}).out);
        const ProgramResult ran =
            scanmill_program({"run", example.string(), scan.string(), "-o", (folder / filter).string()});
        EXPECT_EQ(ran.exit_code, 0) << filter << ran.err;
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
    const ProgramResult text = scanmill_program({"check", "--plan", shipped("quickstart.yaml")});
    EXPECT_EQ(text.exit_code, 0);
    EXPECT_THAT(text.out,
                AllOf(HasSubstr("points <- scan"), HasSubstr("tets <- delaunay"), HasSubstr("{scan}.stl <- surface")));
    EXPECT_THAT(scanmill_program({"check", "--plan", "--format", "dot", shipped("quickstart.yaml")}).out,
                HasSubstr("digraph"));
    const json plan = json::parse(scanmill_program({"check", "--plan", "--json", shipped("quickstart.yaml")}).out);
    EXPECT_EQ(plan.at("files").at(0).at("plan").at("steps").size(), 5u);
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

TEST(Command, Convert_ScalesColumnsThatAreLengths) {
    const TemporaryFolder folder;
    folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\ncomment unit cm\ncomment length-exponent 1 bin-size\n"
        "comment length-exponent 1 local-bin-size\ncomment length-exponent 1 fit-error\ncomment length-exponent -1 "
        "curvature-1\n"
        "comment length-exponent -1 curvature-2\nelement vertex 2\nproperty double x\nproperty double y\n"
        "property double z\nproperty double bin-size\nproperty double local-bin-size\nproperty float fit-error\n"
        "property double curvature-1\nproperty double curvature-2\nproperty double weight\nend_header\n"
        "0 0 0 2 3 0.5 4 -5 7\n1 0 0 2 3 0.5 4 -5 7\n");
    const ProgramResult done = scanmill_program({"convert", "a.ply", "b.ply", "--unit", "cm", "--to-unit", "mm"},
                                                {.folder = folder.path(), .environment = {}});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    const auto points = read_points(folder / "b.ply");
    const auto first = [&](const char* column) { return points->columns.find(column)->number(0); };
    EXPECT_DOUBLE_EQ(first("bin-size"), 20);
    EXPECT_DOUBLE_EQ(first("local-bin-size"), 30);
    EXPECT_DOUBLE_EQ(first("fit-error"), 5);
    EXPECT_DOUBLE_EQ(first("curvature-1"), 0.4);
    EXPECT_DOUBLE_EQ(first("curvature-2"), -0.5);
    EXPECT_EQ(first("weight"), 7) << "the file declares no exponent";
    EXPECT_EQ(points->columns.find("curvature-1")->length_exponent(), -1) << "kept in the written file";
}

}  // namespace
}  // namespace scanmill::test
