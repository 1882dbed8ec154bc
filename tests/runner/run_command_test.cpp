// SPDX-License-Identifier: GPL-3.0-or-later
// `scanmill run` as its users see it: what it writes and prints, and exit codes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/real_data.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

/// A scan of a sphere by the program itself, written to `file`.
void write_sphere(const TemporaryFolder& folder, const std::string& name) {
    const auto workflow =
        folder.write("sphere.yaml", "scanmill: 1\nname: " + name +
                                        "\nsteps:\n  - virtual-scan: {shape: sphere, views: [8], resolution: 3 %diag}\n"
                                        "outputs: {\"{scan}.ply\": virtual-scan}\n");
    const ProgramResult made = scanmill_program({"run", workflow.string(), "-o", folder.path().string()});
    ASSERT_EQ(made.exit_code, 0) << made.err;
}

TEST(RunCommand, ShippedWorkflowsAndBatches_PassCheck) {
    for (const auto& file : std::filesystem::directory_iterator(test::source_folder() + "/workflows")) {
        if (file.path().extension() != ".yaml") continue;
        const ProgramResult found = scanmill_program({"check", file.path().string()});
        EXPECT_EQ(found.exit_code, 0) << file.path() << ": " << found.err;
    }
}

TEST(RunCommand, OnePoint_IsThinnedByABinSizeThatNeedsNoTolerance) {
    const TemporaryFolder folder;
    folder.write("one.xyz", "1 2 3\n");
    folder.write("thin.yaml",
                 "scanmill: 1\ninputs: {scan: points}\nparameters: {size: 1 u}\nsteps: [{voxel-thin: {bin-size: "
                 "$size}}]\noutputs: {'{scan}.xyz': voxel-thin}\n");
    const std::vector<std::string> arguments{"run", "thin.yaml", "one.xyz", "-o", "out", "--no-cache"};
    EXPECT_EQ(scanmill_program(arguments, {.folder = folder.path()}).exit_code, 0);
    EXPECT_EQ(content_of(folder / "out/one.xyz"), "1 2 3\n");
    std::vector<std::string> derived = arguments;
    derived.insert(derived.end(), {"--set", "size=auto"});
    const ProgramResult refused = scanmill_program(derived, {.folder = folder.path()});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, ContainsRegex("%diag is not defined.* diagonal is 0.* one position"));
    EXPECT_THAT(refused.err, HasSubstr("in the parameter 'tolerance'"));
}

TEST(RunCommand, WorkflowOfThePaper_LeadsToAClosedMeshThroughAllPoints) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const ProgramResult ran = scanmill_program(
        {"run", test::source_folder() + "/workflows/bernardini-1997.yaml", "ball.ply", "-o", "out", "--json"},
        {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json scan = json::parse(scanmill_program({"info", "--json", (folder / "ball.ply").string()}).out);
    for (const auto& file : std::filesystem::directory_iterator(folder / "out")) {
        if (file.path().extension() != ".stl" && file.path().extension() != ".ply") continue;
        const json made = json::parse(scanmill_program({"info", "--json", file.path().string()}).out).at("files").at(0);
        EXPECT_EQ(made.at("closed"), true);
        const int triangles = made.at("triangles"), all = 2 * scan.at("files").at(0).at("points").get<int>() - 4;
        const std::string name = file.path().stem().string();
        if (name == "ball") {
            EXPECT_EQ(triangles, all);
        } else if (name == "ball-light") {
            EXPECT_LT(triangles, all / 2);
        }
    }
}

TEST(RunCommand, Run_WritesAClosedMeshAndATable) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const ProgramResult ran =
        scanmill_program({"run", shipped("quickstart.yaml"), "ball.ply", "--set", "bin-size=1 %diag", "-o", "out"},
                         {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, AllOf(HasSubstr("triangles"), HasSubstr("out/ball.stl"), HasSubstr("yes")));
    const json info = json::parse(scanmill_program({"info", "--json", (folder / "out/ball.stl").string()}).out);
    EXPECT_EQ(info.at("files").at(0).at("closed"), true);
    EXPECT_EQ(info.at("files").at(0).at("genus"), 0);
}

TEST(RunCommand, RunJson_IsJsonWithKeysMetricsAndFiles) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const ProgramResult ran = scanmill_program({"run", shipped("quickstart.yaml"), "ball.ply", "--json", "-o", "out"},
                                               {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json report = json::parse(ran.out);
    EXPECT_EQ(report.at("scanmill"), 1);
    ASSERT_EQ(report.at("cells").size(), 1u);
    const json& cell = report.at("cells").at(0);
    EXPECT_EQ(cell.at("outcome"), "ok");
    EXPECT_EQ(cell.at("outputs").at(0).at("properties").at("closed"), true);
    for (const json& step : report.at("steps")) EXPECT_EQ(step.at("key").get<std::string>().size(), 32u);
}

TEST(RunCommand, RunTwiceWithAnyThreads_WritesEqualBytes) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    for (const char* threads : {"1", "2"})
        ASSERT_EQ(scanmill_program({"run", shipped("quickstart.yaml"), "ball.ply", "--threads", threads, "-o", threads},
                                   {.folder = folder.path()})
                      .exit_code,
                  0);
    EXPECT_EQ(content_of(folder / "1/ball.stl"), content_of(folder / "2/ball.stl"));
    EXPECT_FALSE(content_of(folder / "1/ball.stl").empty());
}

TEST(RunCommand, DryRun_WritesNothing) {
    const TemporaryFolder folder;
    folder.write("a.xyz", "0 0 0\n1 0 0\n");
    const ProgramResult ran = scanmill_program({"run", shipped("quickstart.yaml"), "a.xyz", "--dry-run", "-o", "out"},
                                               {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_THAT(ran.out, HasSubstr("out/a.stl"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(RunCommand, OneBadScanAmongGoodOnes_FailsAloneWith1) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    folder.write("flat.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
    const ProgramResult ran =
        scanmill_program({"run", shipped("quickstart.yaml"), "flat.xyz", "missing.ply", "ball.ply", "-o", "out"},
                         {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err,
                AllOf(HasSubstr("on scan 'flat.xyz'"), HasSubstr("in step 'delaunay'"), HasSubstr("missing.ply")));
    EXPECT_THAT(ran.out, HasSubstr("2 of 3 failed"));
    EXPECT_TRUE(std::filesystem::exists(folder / "out/ball.stl"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out/flat.stl"));
}

TEST(RunCommand, AScanThatIsAlsoGivenAsTheFirstInput_IsRefused) {
    const TemporaryFolder folder;
    folder.write("a/s.xyz", "0 0 0\n1 0 0\n");
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{"a/s.xyz", "--in", "scan=a/s.xyz"},
                                               {"a/s.xyz", "--in", "scan=a/../a/s.xyz"},
                                               {"--in", "scan=a/s.xyz,a/s.xyz"}}) {
        std::vector<std::string> command{"run", shipped("quickstart.yaml"), "-o", "out"};
        command.insert(command.end(), arguments.begin(), arguments.end());
        const ProgramResult ran = scanmill_program(command, {.folder = folder.path()});
        EXPECT_EQ(ran.exit_code, 2);
        EXPECT_THAT(ran.err, AllOf(HasSubstr("s.xyz' is given twice"), HasSubstr("--in scan=")));
    }
}

TEST(RunCommand, AScanThatIsGivenTwice_IsRefused) {
    const TemporaryFolder folder;
    folder.write("a/s.xyz", "0 0 0\n1 0 0\n");
    std::filesystem::create_symlink("a/s.xyz", folder / "t.xyz");
    for (const char* other : {"a/s.xyz", "a/../a/s.xyz", "t.xyz"}) {
        const ProgramResult ran = scanmill_program({"run", shipped("quickstart.yaml"), "a/s.xyz", other, "-o", "out"},
                                                   {.folder = folder.path()});
        EXPECT_EQ(ran.exit_code, 2);
        EXPECT_THAT(ran.err, AllOf(HasSubstr(std::string("the scan '") + other + "' is given twice"),
                                   HasSubstr("hint: give each scan once")));
    }
}

TEST(RunCommand, TwoScansOfOneName_AreRefusedBeforeTheRun) {
    const TemporaryFolder folder;
    folder.write("a/s.xyz", "0 0 0\n1 0 0\n");
    folder.write("b/s.xyz", "0 0 0\n2 0 0\n");
    const ProgramResult ran = scanmill_program({"run", shipped("quickstart.yaml"), "a/s.xyz", "b/s.xyz", "-o", "out"},
                                               {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("a/s.xyz"), HasSubstr("b/s.xyz"), HasSubstr("would both write")));
}

TEST(RunCommand, Output_NeverReplacesAnInput) {
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

TEST(RunCommand, AbsoluteLengthOnAScanOfUnknownUnit_SaysHowToDeclareIt) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const std::vector<std::string> run{"run", shipped("quickstart.yaml"), "ball.ply", "--set", "bin-size=20 um", "-o",
                                       "out"};
    const ProgramResult unknown = scanmill_program(run, {.folder = folder.path()});
    EXPECT_EQ(unknown.exit_code, 1);
    EXPECT_THAT(unknown.err, AllOf(HasSubstr("--unit mm"), HasSubstr("unit: mm")));
    std::vector<std::string> declared = run;
    declared.insert(declared.end(), {"--unit", "mm"});
    EXPECT_EQ(scanmill_program(declared, {.folder = folder.path()}).exit_code, 0);
}

TEST(RunCommand, SaveAndUntil_WriteAndStopAtAStep) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    const ProgramResult ran = scanmill_program(
        {"run", shipped("quickstart.yaml"), "ball.ply", "--save", "voxel-thin", "--until", "voxel-thin", "-o", "out"},
        {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/ball.voxel-thin.ply"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out/ball.stl"));
}

TEST(RunCommand, Save_WritesEveryKindInItsFirstFormat) {
    const TemporaryFolder folder;
    write_sphere(folder, "ball");
    folder.write("w.yaml",
                 "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - delaunay:\n  - alpha-solid:\n  - features:\n"
                 "  - measure: {samples: 1000}\n    in: {mesh: alpha-solid, truth: scan}\n");
    std::vector<std::string> run{"run", "w.yaml", "ball.ply", "-o", "out"};
    for (const char* step : {"alpha-solid", "features", "measure"}) run.insert(run.end(), {"--save", step});
    const ProgramResult ran = scanmill_program(run, {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    for (const char* file : {"ball.alpha-solid.ply", "ball.features.json", "ball.measure.json"})
        EXPECT_TRUE(std::filesystem::exists(folder / "out" / file)) << file;
    // Tetrahedra need the module for VTU, which a build may leave out.
    const ProgramResult tets =
        scanmill_program({"run", "w.yaml", "ball.ply", "--save", "delaunay", "-o", "out"}, {.folder = folder.path()});
    if (tets.exit_code == 0)
        EXPECT_TRUE(std::filesystem::exists(folder / "out/ball.delaunay.vtu"));
    else
        EXPECT_THAT(tets.err, HasSubstr("gives tets, which no file format can hold"));
}

class RunCommandUnits : public testing::Test {
protected:
    RunCommandUnits() {
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps: [{delaunay: }, {alpha-solid: }]\n"
                      "outputs: {'{scan}.ply': alpha-solid}\n");
        const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
        folder_.write("mm.xyz", "# unit mm\n" + points);
        folder_.write("m.xyz", "# unit m\n" + points);
        folder_.write("undeclared.xyz", points);
    }
    std::string table_of(const std::vector<std::string>& scans) {
        std::vector<std::string> arguments{"run", "w.yaml", "-o", "out", "--quiet"};
        arguments.insert(arguments.end(), scans.begin(), scans.end());
        const ProgramResult ran = scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.out;
    }
    TemporaryFolder folder_;
};

TEST_F(RunCommandUnits, OneUnit_IsInTheHeader) {
    EXPECT_THAT(table_of({"mm.xyz"}), AllOf(HasSubstr("  alpha (mm)  "), HasSubstr("  0.866025  ")));
    EXPECT_THAT(table_of({"undeclared.xyz", "--unit", "m"}), HasSubstr("  alpha (m)  "));
    EXPECT_THAT(table_of({"undeclared.xyz", "--unit", "m"}), HasSubstr("  alpha (m)  ")) << "from the cache";
    EXPECT_THAT(table_of({"undeclared.xyz"}), AllOf(HasSubstr("  alpha  "), HasSubstr("  0.866025  ")));
}

TEST_F(RunCommandUnits, DifferentUnits_AreInTheCells) {
    EXPECT_THAT(table_of({"mm.xyz", "m.xyz", "undeclared.xyz"}),
                AllOf(HasSubstr("  alpha  "), HasSubstr("  0.866025 mm  "), HasSubstr("  0.866025 m  "),
                      HasSubstr("  0.866025 u  ")));
}

TEST_F(RunCommandUnits, AUnitForNoScan_IsRefused) {
    folder_.write(
        "made.yaml",
        "scanmill: 1\nname: made\nsteps:\n  - virtual-scan: {shape: sphere, size: 1 u, views: [1], resolution: "
        "0.1 u}\noutputs: {'made.ply': virtual-scan}\n");
    const ProgramResult refused =
        scanmill_program({"run", "made.yaml", "-o", "out", "--unit", "mm"}, {.folder = folder_.path()});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("the workflow declares no inputs, so the unit 'mm' belongs to no scan"));
}

TEST_F(RunCommandUnits, Csv_HasTheDeclaredUnit) {
    table_of({"mm.xyz"});
    const ProgramResult csv =
        scanmill_program({"report", "out", "--table", "csv"}, {.folder = folder_.path(), .cache = folder_ / "home"});
    EXPECT_THAT(csv.out, ContainsRegex(",alpha-solid,alpha,0.866025[0-9]*,mm\r\n"));
    const ProgramResult report =
        scanmill_program({"report", "out", "--metric", "alpha"}, {.folder = folder_.path(), .cache = folder_ / "home"});
    EXPECT_THAT(report.out, HasSubstr("alpha (mm)"));
}

TEST(RunCommand, RealScan_ThroughTheQuickstart) {
    SCANMILL_REAL_SCAN(kitten, fetched_data, "points_3/kitten.xyz");
    const TemporaryFolder folder;
    const ProgramResult ran = scanmill_program(
        {"run", shipped("quickstart.yaml"), kitten.string(), "--json", "-o", "out"}, {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json properties = json::parse(ran.out).at("cells").at(0).at("outputs").at(0).at("properties");
    EXPECT_EQ(properties.at("closed"), true);
    EXPECT_EQ(properties.at("genus"), 1);
    EXPECT_EQ(properties.at("components"), 1);
}

}  // namespace
}  // namespace scanmill::test
