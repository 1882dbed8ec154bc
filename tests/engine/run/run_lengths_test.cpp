// SPDX-License-Identifier: GPL-3.0-or-later
// Units and lengths on their way through a run, and positions far from zero.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/run/run_fixture.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::HasSubstr;

using test::Run;

TEST_F(Run, Lengths_AreResolvedOnceAgainstTheFirstInput) {
    const auto length_of = [&](const std::string& written) {
        const RunReport report =
            run("  - test-step: {length: " + written + "}\n", {scan("a.xyz", "# unit mm\n" + test::small_scan)});
        return report.nodes[1].metrics.find("length")->value;
    };
    EXPECT_DOUBLE_EQ(length_of("10 %diag"), 0.3);
    EXPECT_DOUBLE_EQ(length_of("0.5 u"), 0.5);
    EXPECT_DOUBLE_EQ(length_of("1 cm"), 10);
    EXPECT_DOUBLE_EQ(length_of("1 in"), 25.4);
    // Nearest neighbours: 1, 1, 2 and sqrt(8): of four the upper median is 2.
    EXPECT_DOUBLE_EQ(length_of("2 spacing"), 4);
}

TEST_F(Run, AbsoluteLengthOnAScanOfUnknownUnit_Fails) {
    const RunReport report = run("  - test-step: {length: 1 mm}\n", {scan("a.xyz")});
    EXPECT_THAT(report.cells[0].failure.whole().what(),
                AllOf(HasSubstr("unit is not declared"), HasSubstr("unit: mm"), HasSubstr("'length'")));
    request_.unit = LengthUnit::metre;
    EXPECT_DOUBLE_EQ(run("  - test-step: {length: 1 mm}\n", {scan("a.xyz")}).nodes[1].metrics.find("length")->value,
                     0.001);
}

TEST_F(Run, UnitOfTheWorkflowInput_IsTheScans) {
    const RunReport report =
        run("  - test-step: {length: 1 cm}\n", {scan("a.xyz")}, "outputs: {'{scan}.xyz': test-step}\n",
            "{scan: {kind: points, unit: m, frame: part}}");
    EXPECT_DOUBLE_EQ(report.nodes[1].metrics.find("length")->value, 0.01);
    const auto written = read_points(folder_ / "out/a.xyz");
    EXPECT_EQ(written->frame.unit, LengthUnit::metre);
    EXPECT_EQ(written->frame.name, "part");
}

TEST_F(Run, InputsOfDifferentUnits_AreRefused) {
    request_.inputs = {{"others", {scan("b.xyz", "# unit m\n" + test::small_scan)}}};
    const RunReport report =
        run("  - test-step:\n    in: {points: scan, more: others}\n", {scan("a.xyz", "# unit mm\n" + test::small_scan)},
            "", "{scan: points, others: [points]}");
    EXPECT_THAT(report.cells[0].failure.whole().what(), HasSubstr("different units: mm at 'points', m at 'more'"));
}

TEST_F(Run, DistantScan_KeepsItsCoordinatesThroughSteps) {
    const std::string distant =
        "500000.000001 4900000.25 0\n500001.5 4900000.5 0\n500000.125 4900002.75 1\n500001 4900001 2\n";
    const RunReport report = run("  - test-step:\n", {scan("a.xyz", distant)}, "outputs: {'{scan}.xyz': test-step}\n");
    EXPECT_TRUE(report.outcome() == Outcome::ok);
    EXPECT_EQ(test::content_of(folder_ / "out/a.xyz"), distant);
}

}  // namespace
}  // namespace scanmill
