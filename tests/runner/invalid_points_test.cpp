// SPDX-License-Identifier: GPL-3.0-or-later
// Points without coordinates and stray points, as the commands report them.
#include "runner/batch_fixture.hpp"
#include "support/point_files.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf, testing::HasSubstr, testing::Not;

class InvalidPoints : public Batch {
protected:
    InvalidPoints() {
        folder_.write("a.xyz", "0 0 0\nnan 1 1\n1 0 0\n0 2 0\n1 2 2\n");
        write_input("points");
    }
    void write_input(const std::string& input) {
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: " + input +
                                    "}\nsteps: [{test-step: }]\noutputs: {'{scan}.ply': test-step.points}\n");
    }
    ProgramResult run(const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"run", "w.yaml", "-o", "out", "-q"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return scanmill(arguments);
    }
};

TEST_F(InvalidPoints, RefusedScan_NamesTheOptionAndTheKey) {
    const ProgramResult result = run({"a.xyz"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, AllOf(HasSubstr("1 of 5 points has a NaN"), HasSubstr("--invalid drop on the command line"),
                                  HasSubstr("`invalid: drop` in a workflow")));
}

TEST_F(InvalidPoints, DroppedPoints_AreInTheTableTheJsonAndTheRecords) {
    const ProgramResult table = run({"a.xyz", "--invalid", "drop", "--wide"});
    EXPECT_EQ(table.exit_code, 0) << table.err;
    EXPECT_THAT(table.out, AllOf(HasSubstr("dropped-points"), testing::ContainsRegex("a.xyz +ok +4 +1 ")));
    EXPECT_THAT(table.err, HasSubstr("warning: 'a.xyz': 1 of 5 points was dropped"));
    const Json report = Json::parse(run({"a.xyz", "--invalid", "drop", "--json"}).out);
    const Json read = of_step(report, "read").at(0);
    EXPECT_EQ(read["properties"]["points"], 4);
    EXPECT_EQ(read["properties"]["dropped-points"], 1);
    const Json recorded_read = of_step(recorded(1), "read").at(0);
    EXPECT_EQ(recorded_read["properties"]["dropped-points"], 1);
    EXPECT_EQ(recorded_read["authored"]["invalid"], "drop");
    EXPECT_THAT(recorded_read["warnings"].dump(), HasSubstr("1 of 5 points was dropped"));
}

TEST_F(InvalidPoints, WorkflowAndBatch_CanDropThem) {
    write_input("{kind: points, invalid: drop}");
    EXPECT_EQ(run({"a.xyz"}).exit_code, 0);
    EXPECT_EQ(run({"a.xyz", "--invalid", "refuse"}).exit_code, 1) << "the command line overrides the workflow";
    write_input("points");
    write_batch("a.xyz");
    EXPECT_EQ(run_batch().exit_code, 1);
    write_batch("{path: a.xyz, invalid: drop}");
    EXPECT_EQ(run_batch().exit_code, 0);
}

TEST_F(InvalidPoints, WrongRule_IsAnArgumentError) {
    EXPECT_EQ(run({"a.xyz", "--invalid", "keep"}).exit_code, 2);
    folder_.write("v.yaml", "scanmill: 1\nname: v\nsteps: [{test-step: }]\n");
    const ProgramResult result = scanmill({"run", "v.yaml", "--invalid", "drop"});
    EXPECT_NE(result.exit_code, 0);
    EXPECT_THAT(result.err, HasSubstr("no input of points"));
}

TEST_F(InvalidPoints, Info_ReportsStrayPoints) {
    PointCloud cloud = random_cube(1000, 1);
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    positions[500] = Vec3(0, -40, 9);
    cloud.positions = std::move(positions);
    written(folder_ / "s.ply", cloud);
    written(folder_ / "c.ply", random_cube(1000, 1));
    EXPECT_THAT(
        scanmill({"info", "s.ply"}).out,
        AllOf(testing::ContainsRegex("stray +1\n"), HasSubstr("number 500 at 0 -40 9"), HasSubstr("robust-diagonal")));
    EXPECT_THAT(scanmill({"info", "c.ply"}).out,
                AllOf(testing::ContainsRegex("stray +0\n"), Not(HasSubstr("robust-diagonal"))));
    const Json info = Json::parse(scanmill({"info", "s.ply", "--json"}).out)["files"][0];
    EXPECT_EQ(info["stray"], 1);
    EXPECT_EQ(info["stray-points"][0]["number"], 500);
    EXPECT_EQ(info["stray-points"][0]["position"], Json({0, -40, 9}));
    EXPECT_LT(info["robust-diagonal"], 2);
    EXPECT_GT(info["diagonal"], 40);
}

TEST_F(InvalidPoints, Measure_DropsPointsOfTheTruth) {
    folder_.write("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    folder_.write("t.xyz", "0 0 0\nnan 0 0\n1 0 0\n0 1 0\n");
    const ProgramResult refused = scanmill({"measure", "m.off", "t.xyz"});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, HasSubstr("--invalid drop"));
    const ProgramResult dropped = scanmill({"measure", "m.off", "t.xyz", "--invalid", "drop"});
    EXPECT_EQ(dropped.exit_code, 0) << dropped.err;
    EXPECT_THAT(dropped.err, HasSubstr("1 of 4 points was dropped"));
}

}  // namespace
}  // namespace scanmill::test
