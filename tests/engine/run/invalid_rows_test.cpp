// SPDX-License-Identifier: GPL-3.0-or-later
// A scan's invalid rows are refused, or dropped and counted, when it is read; stray points are reported.
#include <gmock/gmock.h>

#include "engine/run/streamed_run_fixture.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/cache/prediction.hpp"
#include "scanmill/formats/files.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf, testing::Contains, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty;

class InvalidRowsRun : public StreamedRun {
protected:
    static constexpr const char* step = "  - test-step: {factor: 2}\n";
    RunReport run_over(const std::string& file, const std::string& inputs = "{scan: points}") {
        return run(step, {file}, "outputs: {'{scan}.ply': test-step.points}\n", inputs);
    }
    std::string bytes(const std::string& name) const { return content_of(folder_ / ("out/" + name)); }

    const std::string with_nan_ = "0 0 0\nnan 1 1\n1 0 0\n0 2 0\n1 1 inf\n1 2 2\n";
};

TEST_F(InvalidRowsRun, ScanWithANan_IsRefusedWithTheWayOut) {
    for (const char* inputs : {"{scan: points}", "{scan: {kind: points, invalid: refuse}}"}) {
        const RunReport report = run_over(scan("a.xyz", with_nan_), inputs);
        EXPECT_FALSE(report.outcome() == Outcome::ok);
        const Error& error = report.nodes[0].failure.error;
        EXPECT_THAT(error.sentence(), AllOf(HasSubstr("a.xyz': "), HasSubstr("2 of 6 points have a NaN")));
        EXPECT_EQ(error.remedy(), Remedy::drop_invalid_rows);
    }
}

TEST_F(InvalidRowsRun, DroppedRows_AreCountedAndLeaveTheOthersUnchanged) {
    EXPECT_TRUE(run_over(scan("a.xyz", small_scan)).outcome() == Outcome::ok);
    for (const Origin origin : {Origin::ran, Origin::cached}) {
        const RunReport report = run_over(scan("b.xyz", with_nan_), "{scan: {kind: points, invalid: drop}}");
        EXPECT_TRUE(report.outcome() == Outcome::ok);
        EXPECT_EQ(report.nodes[0].origin, origin);
        EXPECT_EQ(report.nodes[0].properties.find("points")->value, 4);
        ASSERT_TRUE(report.nodes[0].properties.find("dropped-points"));
        EXPECT_EQ(report.nodes[0].properties.find("dropped-points")->value, 2);
        EXPECT_THAT(report.nodes[0].warnings,
                    ElementsAre(AllOf(HasSubstr("b.xyz': 2 of 6 points were dropped"), HasSubstr("NaN"))));
        EXPECT_EQ(bytes("b.ply"), bytes("a.ply"));
    }
}

TEST_F(InvalidRowsRun, ScanWithoutInvalidRows_HasNoCount) {
    const RunReport report = run_over(scan("a.xyz"), "{scan: {kind: points, invalid: drop}}");
    EXPECT_TRUE(report.outcome() == Outcome::ok);
    EXPECT_EQ(report.nodes[0].properties.find("dropped-points"), nullptr);
    EXPECT_THAT(report.nodes[0].warnings, IsEmpty());
}

TEST_F(InvalidRowsRun, TheRule_IsPartOfThePlanKey) {
    const std::string file = scan("a.xyz");
    prepare(step, {file});
    const std::string by_format = graph_.nodes[0].key;
    prepare(step, {file}, "", "{scan: {kind: points, invalid: drop}}");
    const std::string drop = graph_.nodes[0].key;
    prepare(step, {file}, "", "{scan: {kind: points, invalid: refuse}}");
    EXPECT_NE(by_format, drop);
    EXPECT_NE(graph_.nodes[0].key, drop);
    EXPECT_NE(graph_.nodes[0].key, by_format);
    EXPECT_THAT(declared_of(graph_.nodes[0].leaf), Contains(testing::Pair("invalid", "refuse")));
}

TEST_F(InvalidRowsRun, TheRun_OverridesTheWorkflowAndAScanTheRun) {
    const std::string file = scan("a.xyz");
    request_.invalid = InvalidRows::refuse;
    prepare(step, {file}, "", "{scan: {kind: points, invalid: drop}}");
    EXPECT_EQ(graph_.nodes[0].leaf.invalid, InvalidRows::refuse);
    request_.scans.front().invalid = InvalidRows::drop;
    graph_ = make_graph(plan_, library_, request_);
    EXPECT_EQ(graph_.nodes[0].leaf.invalid, InvalidRows::drop);
}

TEST_F(InvalidRowsRun, RuleForAWorkflowWithoutPoints_IsAnError) {
    request_.invalid = InvalidRows::drop;
    EXPECT_THROW(run("  - test-step: {factor: 2}\n", {}, "", "{}"), Error);
}

TEST_F(InvalidRowsRun, NoValidRow_IsRefused) {
    const RunReport report = run_over(scan("a.xyz", "nan 0 0\n0 inf 0\n"), "{scan: {kind: points, invalid: drop}}");
    EXPECT_FALSE(report.outcome() == Outcome::ok);
    EXPECT_THAT(report.nodes[0].failure.error.sentence(), HasSubstr("all 2 points have a NaN or an infinity"));
}

TEST_F(InvalidRowsRun, OneValidRow_IsAScan) {
    const RunReport report = run_over(scan("a.xyz", "nan 0 0\n1 2 3\n"), "{scan: {kind: points, invalid: drop}}");
    EXPECT_EQ(report.nodes[0].outcome, Outcome::ok);
    EXPECT_EQ(report.nodes[0].properties.find("points")->value, 1);
}

TEST_F(InvalidRowsRun, FarRow_IsRefusedOrDropped) {
    const std::string file = scan("a.xyz", small_scan + "0 0 1e300\n");
    EXPECT_THAT(run_over(file).nodes[0].failure.error.sentence(), HasSubstr("1 of 5 points lies farther than"));
    const RunReport report = run_over(file, "{scan: {kind: points, invalid: drop}}");
    EXPECT_TRUE(report.outcome() == Outcome::ok);
    EXPECT_EQ(report.nodes[0].properties.find("dropped-points")->value, 1);
}

TEST_F(InvalidRowsRun, PtxWithNan_DropsItUnlessRefusalIsAskedFor) {
    const std::string file = scan("a.ptx",
                                  "5\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
                                  "1 0 0 0.5\nnan nan nan 0.5\n0 2 0 0.5\n1 2 2 0.5\n1 1 0 0.5\n");
    const RunReport report = run_over(file);
    EXPECT_TRUE(report.outcome() == Outcome::ok);
    EXPECT_EQ(report.nodes[0].properties.find("points")->value, 4);
    EXPECT_EQ(report.nodes[0].properties.find("dropped-points")->value, 1);
    EXPECT_THAT(report.nodes[0].warnings, Contains(HasSubstr("1 of 5 points was dropped: no return")));
    EXPECT_FALSE(run_over(file, "{scan: {kind: points, invalid: refuse}}").outcome() == Outcome::ok);
}

/// Binary PLY or text, with a NaN and a row that is too far.
TEST_F(InvalidRowsRun, StreamableScanWithInvalidRows_IsReadWholeWithTheSameResult) {
    const PointCloud clean = helix(100'000);
    Array<Vec3> positions;
    Array<u32> rows;
    for (u32 row = 0; row < clean.size(); ++row) {
        if (row % 40'000 == 7) positions.push_back(row == 7 ? Vec3(0, nan, 0) : Vec3(0, 0, -1e300));
        positions.push_back(clean.positions[row]);
    }
    PointCloud flawed;
    flawed.positions = std::move(positions);
    for (const char* extension : {".ply", ".xyz"}) {
        const std::string a = written(folder_ / (std::string("a") + extension), without_columns(clean));
        const std::string b = written(folder_ / (std::string("b") + extension), flawed);
        const std::string inputs = "{scan: {kind: points, invalid: drop}}";
        for (const bool whole : {false, true}) {
            std::filesystem::remove_all(folder_ / "cache");
            EXPECT_TRUE(run_thin("bin-size: 2 %diag", a, whole, inputs).outcome() == Outcome::ok);
            const RunReport report = run_thin("bin-size: 2 %diag", b, whole, inputs);
            EXPECT_TRUE(report.outcome() == Outcome::ok);
            EXPECT_EQ(report.nodes[0].properties.find("dropped-points")->value, 3);
            EXPECT_EQ(bytes("b.ply"), bytes("a.ply"));
        }
        EXPECT_FALSE(run_thin("bin-size: 2 %diag", b).outcome() == Outcome::ok);
    }
}

class StrayPointRun : public StreamedRun {
protected:
    /// A sphere of radius 5 at survey coordinates, and `stray` points.
    std::string sphere(const std::string& name, std::size_t stray) {
        PointCloud cloud = random_sphere(20'000, 1, 5);
        cloud.frame.origin = Vec3(500'000, 4'500'000, 300);
        Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
        for (Vec3& p : positions) p = (p * 4096).array().round() / 4096;
        for (std::size_t i = 0; i < stray; ++i) positions.push_back(-cloud.frame.origin);
        cloud.positions = std::move(positions);
        return written(folder_ / name, cloud);
    }
};

TEST_F(StrayPointRun, RowOfZeros_ChangesNoLengthAndIsReported) {
    for (const bool whole : {false, true}) {
        const RunReport clean = run_thin("bin-size: 3 %diag", sphere("a.ply", 0), whole);
        const RunReport report = run_thin("bin-size: 3 %diag", sphere("b.ply", 2), whole);
        ASSERT_TRUE(report.outcome() == Outcome::ok);
        EXPECT_EQ(report.nodes[1].metrics.find("bin-size")->value, clean.nodes[1].metrics.find("bin-size")->value);
        EXPECT_EQ(report.nodes[1].metrics.find("kept")->value, clean.nodes[1].metrics.find("kept")->value + 1);
        EXPECT_THAT(clean.nodes[1].warnings, IsEmpty());
        EXPECT_THAT(report.nodes[1].warnings,
                    ElementsAre(AllOf(HasSubstr("without 2 stray points"), HasSubstr("number 20000 at (0, 0, 0)"),
                                      HasSubstr("17.3"), HasSubstr("remove them if"))));
    }
}

TEST_F(StrayPointRun, StreamedOrWhole_IsTheSame) {
    expect_the_same(sphere("b.ply", 1), "bin-size: 3 %diag");
    expect_the_same(sphere("b.xyz", 1), "bin-size: 3 %diag");
}

TEST_F(StrayPointRun, LengthInUnits_NeedsNoWarning) {
    for (const bool whole : {false, true})
        EXPECT_THAT(run_thin("bin-size: 1 u", sphere("b.ply", 1), whole).nodes[1].warnings, IsEmpty());
    EXPECT_THAT(run_logging(sphere("b.ply", 1), "length: 1 u").nodes[1].warnings, IsEmpty());
    EXPECT_EQ(run_logging(sphere("b.ply", 1)).nodes[1].warnings.size(), 1u);
}

}  // namespace
}  // namespace scanmill::test
