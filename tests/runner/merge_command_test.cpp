// SPDX-License-Identifier: GPL-3.0-or-later
// Views of one object in one command: the ready workflow merge-views, as its users see it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "scanmill/formats/files.hpp"
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
using testing::Not;

std::string merge_views() { return test::source_folder() + "/workflows/merge-views.yaml"; }

/// Two views, and poses in the other order: a quarter turn about z for `left`, against its quaternion.
class MergeCommand : public testing::Test {
protected:
    MergeCommand() {
        folder_.write("left.xyz", "1 2 3\n");
        folder_.write("right.xyz", "-2 1 3\n5 5 5\n");
        folder_.write("v.conf",
                      "camera 0 0 0 0 0 0 1\nbmesh right.ply 0 0 0 0 0 0 1\n"
                      "bmesh left.ply 0 0 0 0 0 -0.70710678 0.70710678\n");
    }
    ProgramResult run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"run", merge_views()});
        return scanmill_program(arguments, {.folder = folder_.path()});
    }
    TemporaryFolder folder_;
};

TEST_F(MergeCommand, Views_TakeTheirPosesByName) {
    const ProgramResult ran =
        run({"left.xyz", "right.xyz", "--set", "poses=v.conf", "--set", "within=0.001 u", "-o", "out"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, AllOf(HasSubstr("merge-views"), HasSubstr("dropped"), HasSubstr("out/merge-views.ply")));
    const auto points = read_points(folder_ / "out/merge-views.ply");
    ASSERT_EQ(points->size(), 2u) << "left's point is turned onto right's first";
    EXPECT_LT((points->positions[0] - Vec3(-2, 1, 3)).norm(), 1e-7);
    EXPECT_EQ(points->positions[1], Vec3(5, 5, 5));
    EXPECT_EQ(points->columns.find("source")->number(1), 1);
}

TEST_F(MergeCommand, EqualWarningsOfSeveralViews_AreOneWithTheirNumber) {
    folder_.write("a.xyz", "1 2 3\nnan nan nan\n");
    folder_.write("b.xyz", "4 5 6\nnan nan nan\n");
    folder_.write("c.xyz", "7 8 9\nnan nan nan\nnan nan nan\n");
    const ProgramResult ran = run({"a.xyz", "b.xyz", "c.xyz", "--invalid", "drop", "-o", "out", "--no-cache"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, AllOf(ContainsRegex("1 of 2 points was dropped.*\\(2 files\\)"),
                               HasSubstr("'c.xyz': 2 of 3 points were dropped")));
    const std::size_t first = ran.err.find("1 of 2 points");
    EXPECT_EQ(ran.err.find("1 of 2 points", first + 1), std::string::npos) << ran.err;
}

TEST_F(MergeCommand, WithoutPoses_KeepsThePlacesAndTellsTheFrames) {
    const ProgramResult ran = run({"left.xyz", "right.xyz", "-o", "out"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("1 of 2 inputs have another frame than 'left'"));
    EXPECT_EQ(read_points(folder_ / "out/merge-views.ply")->size(), 3u);
}

TEST_F(MergeCommand, ViewWithoutPose_FailsNamingIt) {
    folder_.write("top.xyz", "0 0 0\n");
    const ProgramResult ran = run({"left.xyz", "top.xyz", "--set", "poses=v.conf", "-o", "out"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, AllOf(ContainsRegex("no pose for input 1.* 'top'"), HasSubstr("in step 'merge'")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/merge-views.ply"));
}

/// Poses as JSON: `left` is moved, `top` is refused.
class MergeByTransform : public MergeCommand {
protected:
    MergeByTransform() {
        folder_.write("top.xyz", "0 0 0\n");
        folder_.write(
            "motions.json",
            "{\"scanmill\": 1, \"frame\": \"part\", \"poses\": [{\"scan\": \"right\", \"rotation\": [0, 0, 0, "
            "1], \"translation\": [0, 0, 0]}, {\"scan\": \"top\", \"refused\": \"no-overlap\"}, {\"scan\": "
            "\"left\", \"rotation\": [0, 0, 0, 1], \"translation\": [10, 0, 0]}]}");
    }
    ProgramResult merge(const std::string& step) const {
        folder_.write("by-port.yaml",
                      "scanmill: 1\nname: by-port\ninputs:\n  views: {kind: points, list: true, frame: '{stem}'}\n"
                      "  motions: transform\nsteps:\n" +
                          step + "outputs: {'merged.ply': merge}\n");
        return scanmill_program(
            {"run", "by-port.yaml", "left.xyz", "top.xyz", "right.xyz", "--in", "motions=motions.json", "-o", "out"},
            {.folder = folder_.path()});
    }
};

TEST_F(MergeByTransform, WiredByName_MovesTheViewsAndLeavesRefusedOnesOut) {
    const ProgramResult ran = merge("  - merge:\n    in: {points: views, transform: motions}\n");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("input 1 'top' (no-overlap)"));
    const auto points = read_points(folder_ / "out/merged.ply");
    ASSERT_EQ(points->size(), 3u);
    EXPECT_EQ(points->positions[0], Vec3(11, 2, 3));
    EXPECT_EQ(points->positions[1], Vec3(-2, 1, 3));
    EXPECT_EQ(points->columns.find("source")->number(1), 2);
    const ProgramResult from_file = merge("  - merge: {poses: motions.json}\n    in: {points: views}\n");
    ASSERT_EQ(from_file.exit_code, 0) << from_file.err;
    EXPECT_EQ(read_points(folder_ / "out/merged.ply")->positions[0], Vec3(11, 2, 3));
}

TEST_F(MergeByTransform, WithoutIn_DoesNotTakeAnEarlierTransform) {
    const ProgramResult ran = merge("  - merge:\n    in: {points: views}\n");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(read_points(folder_ / "out/merged.ply")->size(), 4u);
}

TEST_F(MergeByTransform, AndAFileOfPoses_AreRefused) {
    const ProgramResult ran = merge("  - merge: {poses: v.conf}\n    in: {points: views, transform: motions}\n");
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("v.conf"), HasSubstr("`transform`"), HasSubstr("hint")));
}

TEST_F(MergeCommand, MissingPoses_FailNamingTheFile) {
    const ProgramResult ran = run({"left.xyz", "--set", "poses=absent.conf", "-o", "out"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, HasSubstr("'absent.conf': there is no such file"));
}

TEST_F(MergeCommand, ViewsOfDifferentUnits_AreRefused) {
    folder_.write("mm.xyz", "# unit mm\n0 0 0\n");
    folder_.write("m.xyz", "# unit m\n0 0 0\n");
    const ProgramResult ran = run({"mm.xyz", "m.xyz", "-o", "out"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("different units: mm"), HasSubstr("--to-unit")));
}

TEST_F(MergeCommand, ViewWithoutAUnit_IsTakenToBeInThatOfTheOthers_WhereverItStands) {
    folder_.write("mm.xyz", "# unit mm\n0 0 0\n");
    for (const std::vector<std::string>& views :
         {std::vector<std::string>{"mm.xyz", "left.xyz"}, std::vector<std::string>{"left.xyz", "mm.xyz"}}) {
        const ProgramResult ran = run({views[0], views[1], "-o", "out"});
        EXPECT_EQ(ran.exit_code, 0);
        EXPECT_THAT(ran.err, ContainsRegex("no unit.* other inputs .*mm"));
        EXPECT_EQ(read_points(folder_ / "out/merge-views.ply")->frame.unit, LengthUnit::millimetre);
    }
    EXPECT_THAT(run({"mm.xyz", "left.xyz", "--unit", "mm", "-o", "out"}).err, Not(HasSubstr("declares no unit")));
}

TEST_F(MergeCommand, AnyThreads_WriteEqualBytes) {
    for (const char* threads : {"1", "2"})
        ASSERT_EQ(
            run({"left.xyz", "right.xyz", "--set", "poses=v.conf", "--threads", threads, "-o", threads}).exit_code, 0);
    EXPECT_EQ(content_of(folder_ / "1/merge-views.ply"), content_of(folder_ / "2/merge-views.ply"));
    EXPECT_FALSE(content_of(folder_ / "1/merge-views.ply").empty());
}

TEST_F(MergeCommand, BunnysTenViews_AreOneCloud) {
    SCANMILL_REAL_SCAN(conf, shared_data, "1-bunny/raw/bun.conf");
    std::vector<std::string> arguments{"--set", "poses=" + conf.string(), "--json", "-o", "out"};
    std::vector<std::string> views;
    for (const auto& entry : std::filesystem::directory_iterator(conf.parent_path()))
        if (entry.path().extension() == ".ply") views.push_back(entry.path().string());
    std::ranges::sort(views);  // the alphabet's order, which is not the file's
    ASSERT_EQ(views.size(), 10u);
    arguments.insert(arguments.end(), views.begin(), views.end());
    const ProgramResult ran = run(arguments);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json report = json::parse(ran.out);
    ASSERT_EQ(report.at("cells").size(), 1u);
    EXPECT_EQ(report.at("cells").at(0).at("outputs").at(0).at("properties").at("points"), 362272);
}

}  // namespace
}  // namespace scanmill::test
