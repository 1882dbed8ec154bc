// SPDX-License-Identifier: GPL-3.0-or-later
// A run whose scans are streamed is the run that reads them whole: the same outputs, reports and keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/run/streamed_run_fixture.hpp"
#include "support/point_files.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(StreamedRun, GivesWhatReadingWholeGives) {
    const std::string ply = written(folder_ / "a.ply", helix(150'000));
    expect_the_same(ply, "bin-size: 0.1 u");
    expect_the_same(ply, "bin-size: 2 %diag, margin: 0.01 u, min-points: 2");
    expect_the_same(written(folder_ / "far.ply", helix(70'000, Vec3(4e6, 5e6, -7e6))), "bin-size: 2 %diag");
    expect_the_same(written(folder_ / "a.xyz", without_columns(helix(70'000))), "bin-size: 2 %diag");
}

TEST_F(StreamedRun, TakesUnitFrameAndWarningsAlong) {
    const std::string file = scan("a.xyz", "# unit furlong\n# unit mm\n# frame lab\n" + small_scan);
    expect_the_same(file, "bin-size: 0.5 mm");
    expect_the_same(file, "bin-size: 50 um", "{scan: {kind: points, unit: m, frame: part}}");
    const RunReport report = run_thin("bin-size: 0.5 mm", file, false, "{scan: {kind: points, frame: part}}");
    EXPECT_THAT(report.nodes[0].warnings, ElementsAre(HasSubstr("furlong"), HasSubstr("'lab'")));
    EXPECT_EQ(read_points(folder_ / "out/a.ply")->frame.name, "part");
}

TEST_F(StreamedRun, RefusesWhatReadingWholeRefuses) {
    const std::string ply = written(folder_ / "a.ply", helix(1000));
    expect_the_same(ply, "bin-size: 1e-9 u");
    expect_the_same(ply, "bin-size: 0.1 mm");
    expect_the_same(ply, "bin-size: 0.1 u, min-points: 1000");
    expect_the_same(ply, "bin-size: 0.1 u, rule: adaptive");
    expect_the_same(scan("one.xyz", "1 2 3\n"), "bin-size: 1 %diag");
    EXPECT_THAT(run_thin("bin-size: 1e-9 u", ply).cells[0].failure.whole().what(), HasSubstr("voxels"));
    expect_the_same(scan("same.xyz", "1 2 3\n1 2 3\n"), "bin-size: 1 %diag");
    EXPECT_THAT(run_thin("bin-size: 1 %diag", scan("one.xyz", "1 2 3\n")).cells[0].failure.whole().what(),
                HasSubstr("the diagonal is 0"));
}

TEST_F(StreamedRun, FileThatTurnsOutToNeedIt_IsReadWhole) {
    const std::string nan = scan("nan.xyz", small_scan + "1 2 nan\n");
    expect_the_same(nan, "bin-size: 0.1 u");
    EXPECT_THAT(run_thin("bin-size: 0.1 u", nan).cells[0].failure.whole().what(), HasSubstr("NaN"));
    expect_the_same(scan("late.xyz", small_scan + "1 2 3 4\n"), "bin-size: 0.1 u");
    const std::string mixed = scan("mixed.xyz", small_scan + "1, 2 3\n");
    expect_the_same(mixed, "bin-size: 0.1 u");
    use_cache("logging");
    prepare("  - test-stream: {length: 1 %diag, log: " + log() + "}\n", {nan}, "",
            "{scan: {kind: points, invalid: drop}}");
    const std::vector<std::string> log = run_graph().nodes[0].effort.log;
    EXPECT_THAT(log, ElementsAre(HasSubstr("could not be streamed and was loaded whole")));
    EXPECT_THAT(run_logging(scan("a.xyz")).nodes[0].effort.log, testing::IsEmpty());
    EXPECT_THAT(logged(), testing::MatchesRegex("whole .*\nstream .*\n"));
}

TEST_F(StreamedRun, HandsTheFilterAStream) {
    const RunReport report = run_logging(scan("a.xyz"));
    EXPECT_TRUE(report.outcome() == Outcome::ok) << report.cells[0].failure.whole().what();
    EXPECT_EQ(logged(), "stream 0.03 u 4\n") << "the diagonal is 3";
    EXPECT_EQ(report.nodes[0].properties.find("points")->value, 4);
}

TEST_F(StreamedRun, WithoutACache_HandsTheFilterAStream) {
    settings_.cache = nullptr;
    EXPECT_TRUE(run_logging(scan("a.xyz")).outcome() == Outcome::ok);
    EXPECT_EQ(logged(), "stream 0.03 u 4\n");
}

}  // namespace
}  // namespace scanmill::test
