// SPDX-License-Identifier: GPL-3.0-or-later
// Outputs of cells that fail because a step does not meet its expectation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/run/cached_run_fixture.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class Evidence : public Run {
protected:
    /// A step `a`, then `b` that is expected to give `points`, then `c`.
    RunReport run_three(const std::string& points, const std::vector<std::string>& scans) {
        return run(
            "  - id: a\n    test-step: {factor: 2}\n  - id: b\n    test-step: {factor: 3}\n    expect: {points: " +
                points + "}\n  - id: c\n    test-step: {log: " + log() + "}\n",
            scans,
            "outputs: {'{scan}-a.ply': a, 'sub/{scan}-b.ply': b, '{scan}-mesh.ply': b.mesh, '{scan}-c.ply': "
            "c}\n");
    }
    /// A step `a` that all variants share, then `b` with the lengths 1 u and 2 u.
    RunReport run_variants(const std::string& length) {
        return run(
            "  - id: a\n    test-step: {factor: 2}\n  - id: b\n    test-step: {length: {sweep: [1 u, 2 u]}}\n"
            "    expect: {length: '" +
                length + "'}\n",
            {scan("s.xyz")}, "outputs: {'{scan}-a.ply': a, '{scan}.{variant}.ply': b}\n");
    }
    double second_x(const std::string& name) const {
        const auto points = read_points(folder_ / "out" / name);
        return points->frame.origin.x() + points->positions[1].x();
    }
    bool exists(const std::string& name) const { return fs::exists(folder_ / "out" / name); }
    nlohmann::json description(const std::string& name) const {
        return nlohmann::json::parse(content_of(folder_ / "out" / (name + ".json")), nullptr, false);
    }
};

TEST_F(Evidence, UnmetExpectation_LeavesEveryOutputMadeBeforeIt) {
    const RunReport report = run_three("'> 4'", {scan("s.xyz")});
    const CellReport& cell = report.cells[0];
    EXPECT_EQ(cell.outcome, Outcome::failed);
    EXPECT_EQ(cell.failure.cause, Cause::expectation);
    EXPECT_EQ(runs_logged(), 0u) << "no step takes a result that is not as expected";
    ASSERT_EQ(cell.outputs.size(), 4u);
    for (const OutputReport& output : cell.outputs) {
        EXPECT_NE(output.outcome, Outcome::ok) << output.file;
        EXPECT_FALSE(fs::exists(output.file)) << output.file;
        const std::string name = output.file.filename().string();
        if (name == "s-c.ply") {
            EXPECT_TRUE(output.evidence.empty());
            continue;
        }
        const fs::path expected =
            graph_.output_folder / "failed" / output.file.lexically_relative(graph_.output_folder);
        EXPECT_EQ(output.evidence, expected);
        ASSERT_TRUE(fs::exists(expected)) << expected;
        EXPECT_EQ(output.bytes, fs::file_size(expected));
        EXPECT_FALSE(output.sha256.empty());
    }
    EXPECT_TRUE(exists("failed/sub/s-b.ply"));
    EXPECT_FALSE(exists("failed/s-c.ply"));
    EXPECT_FALSE(exists("s-a.ply.json"));
    // 1 in the scan, then times 2 in `a` and times 3 in `b`
    EXPECT_EQ(second_x("failed/s-a.ply"), 2);
    EXPECT_EQ(second_x("failed/sub/s-b.ply"), 6);
}

TEST_F(Evidence, Description_NamesTheUnmetExpectation) {
    run_three("'> 4'", {scan("s.xyz")});
    for (const char* name : {"failed/s-a.ply", "failed/sub/s-b.ply", "failed/s-mesh.ply"}) {
        const nlohmann::json described = description(name);
        ASSERT_TRUE(described.is_object() && described.contains("unmet")) << name;
        ASSERT_EQ(described["unmet"].size(), 1u) << name;
        EXPECT_THAT(described["unmet"][0].get<std::string>(),
                    AllOf(HasSubstr("b: "), HasSubstr("> 4"), HasSubstr("found 4")));
    }
    run_three("4", {scan("s.xyz")});
    EXPECT_FALSE(description("s-a.ply").contains("unmet"));
}

TEST_F(Evidence, FileOfACompleteCell_StaysAlthoughAnotherCellFails) {
    const RunReport report = run_variants("< 1.5 u");
    ASSERT_EQ(report.cells.size(), 2u);
    EXPECT_EQ(report.cells[0].outcome, Outcome::ok);
    EXPECT_EQ(report.cells[1].outcome, Outcome::failed);
    EXPECT_TRUE(exists("s-a.ply"));
    EXPECT_FALSE(exists("failed/s-a.ply"));
    EXPECT_EQ(report.cells[1].outputs[0].outcome, Outcome::ok);
    EXPECT_TRUE(fs::exists(report.cells[0].outputs[1].file));
    EXPECT_FALSE(fs::exists(report.cells[1].outputs[1].file));
    EXPECT_TRUE(fs::exists(report.cells[1].outputs[1].evidence));
}

TEST_F(Evidence, FileThatOnlyFailedCellsShare_IsMovedInTheReportsOfAll) {
    const RunReport report = run_variants("< 0.5 u");
    ASSERT_EQ(report.cells.size(), 2u);
    for (const CellReport& cell : report.cells) {
        EXPECT_EQ(cell.failure.cause, Cause::expectation);
        EXPECT_EQ(cell.outputs[0].evidence, graph_.output_folder / "failed/s-a.ply");
    }
    EXPECT_FALSE(exists("s-a.ply"));
    EXPECT_TRUE(exists("failed/s-a.ply"));
    EXPECT_EQ(description("failed/s-a.ply")["unmet"].size(), 2u);
}

TEST_F(Evidence, NextSuccess_RemovesTheFilesOfItsCellOnly) {
    run_three("'> 4'", {scan("s.xyz")});
    ASSERT_TRUE(exists("failed/sub/s-b.ply"));
    folder_.write("out/failed/mine.txt", "x");
    run_three("4", {scan("s.xyz")});
    EXPECT_TRUE(exists("sub/s-b.ply"));
    EXPECT_FALSE(exists("failed/sub"));
    EXPECT_FALSE(exists("failed/s-a.ply.json"));
    EXPECT_TRUE(exists("failed/mine.txt"));

    run_three("'> 4'", {scan("s.xyz")});
    fs::remove(folder_ / "out/failed/mine.txt");
    run_three("4", {scan("s.xyz")});
    EXPECT_FALSE(exists("failed"));
}

TEST_F(Evidence, OutputThatTheNextFailureDoesNotReach_IsRemoved) {
    const auto run_two = [&](const std::string& first, const std::string& second) {
        return run("  - id: a\n    test-step:\n    expect: {points: " + first +
                       "}\n  - id: b\n    test-step:\n    expect: {points: " + second + "}\n",
                   {scan("s.xyz")}, "outputs: {'{scan}-a.ply': a, '{scan}-b.ply': b}\n");
    };
    run_two("4", "5");
    EXPECT_TRUE(exists("failed/s-b.ply"));
    run_two("5", "4");
    EXPECT_TRUE(exists("failed/s-a.ply"));
    EXPECT_FALSE(exists("failed/s-b.ply"));
}

TEST_F(Evidence, FailFast_StillWritesTheFailedCell) {
    settings_.fail_fast = true;
    const RunReport report = run_three("'> 4'", {scan("s.xyz"), scan("t.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 3\n")});
    EXPECT_EQ(report.cells[0].outcome, Outcome::failed);
    EXPECT_EQ(report.cells[1].outcome, Outcome::skipped);
    EXPECT_TRUE(exists("failed/s-a.ply"));
    EXPECT_TRUE(exists("failed/sub/s-b.ply"));
    EXPECT_FALSE(exists("t-a.ply"));
}

/// The width of a picture of test-draw is the number of points that it shows.
u32 width_of(const fs::path& file) { return read_file(file).value.get<Picture>()->width; }

TEST_F(Evidence, PictureOfTheUnmetValue_IsDrawnBelowFailed) {
    const RunReport report =
        run("  - id: a\n    test-step: {factor: 2}\n    expect: {points: '> 4'}\n  - id: seen\n    test-draw:\n"
            "  - id: c\n    test-step: {log: " +
                log() + "}\n  - id: late\n    test-draw:\n    in: {scene: c}\n",
            {scan("s.xyz")},
            "outputs: {'{scan}.ply': a, '{scan}.png': seen, '{scan}-c.ply': c, '{scan}-late.png': late}\n");
    const CellReport& cell = report.cells[0];
    EXPECT_EQ(cell.outcome, Outcome::failed);
    EXPECT_EQ(cell.failure.cause, Cause::expectation);
    EXPECT_EQ(runs_logged(), 0u) << "other steps do not take the value";
    ASSERT_TRUE(exists("failed/s.png"));
    EXPECT_EQ(width_of(folder_ / "out/failed/s.png"), 4u);
    EXPECT_TRUE(exists("failed/s.ply"));
    EXPECT_FALSE(exists("s.png"));
    EXPECT_FALSE(exists("failed/s-late.png")) << "its input was not made";
    EXPECT_EQ(description("failed/s.png")["unmet"].size(), 1u);
    EXPECT_EQ(cell.outputs[1].evidence, graph_.output_folder / "failed/s.png");
}

TEST_F(Evidence, PictureThatCannotBeDrawn_LeavesTheExpectationAsTheCause) {
    const RunReport report =
        run("  - id: a\n    test-step:\n    expect: {points: '> 4'}\n  - id: seen\n    test-draw: {fails: true}\n",
            {scan("s.xyz")}, "outputs: {'{scan}.ply': a, '{scan}.png': seen}\n");
    EXPECT_EQ(report.cells[0].failure.cause, Cause::expectation);
    EXPECT_TRUE(exists("failed/s.ply"));
    EXPECT_FALSE(exists("failed/s.png"));
}

TEST_F(Evidence, FailFast_StillDrawsTheFailedCell) {
    settings_.fail_fast = true;
    const RunReport report =
        run("  - id: a\n    test-step:\n    expect: {points: '> 4'}\n  - id: seen\n    test-draw:\n",
            {scan("s.xyz"), scan("t.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 3\n")}, "outputs: {'{scan}.png': seen}\n");
    EXPECT_EQ(report.cells[0].outcome, Outcome::failed);
    EXPECT_EQ(report.cells[1].outcome, Outcome::skipped);
    EXPECT_TRUE(exists("failed/s.png"));
    EXPECT_FALSE(exists("t.png"));
    EXPECT_FALSE(exists("failed/t.png"));
}

TEST_F(CachedRun, PictureOfAnUnmetValue_IsTakenFromTheCache) {
    const std::string steps = "  - id: a\n    test-step:\n    expect: {points: '> 4'}\n  - test-draw:\n";
    const std::string outputs = "outputs: {'{scan}.png': test-draw}\n";
    run(steps, {scan("a.xyz")}, outputs);
    const std::string before = content_of(folder_ / "out/failed/a.png");
    EXPECT_NE(before, "");
    fs::remove_all(folder_ / "out");
    const RunReport again = run(steps, {scan("a.xyz")}, outputs);
    EXPECT_EQ(again.nodes.back().origin, Origin::cached);
    EXPECT_EQ(again.cells[0].failure.cause, Cause::expectation);
    EXPECT_EQ(content_of(folder_ / "out/failed/a.png"), before);
}

TEST_F(Evidence, OtherFailures_WriteNothingToFailed) {
    const RunReport report = run("  - id: a\n    test-step:\n  - id: b\n    test-step: {mode: fail}\n", {scan("s.xyz")},
                                 "outputs: {'{scan}-a.ply': a, '{scan}-b.ply': b}\n");
    EXPECT_EQ(report.cells[0].failure.cause, Cause::refused);
    EXPECT_TRUE(exists("s-a.ply"));
    EXPECT_FALSE(exists("failed"));
}

struct NodeWarnings : RunObserver {
    void node_warning(const RunNode&, std::string_view text) override { all.emplace_back(text); }
    std::vector<std::string> all;
};

TEST_F(Evidence, FailedFolderThatCannotBeWritten_IsOneWarning) {
    folder_.write("out/failed", "x");
    prepare("  - id: a\n    test-step: {factor: 2}\n  - id: b\n    test-step:\n    expect: {points: '> 4'}\n",
            {scan("s.xyz"), scan("t.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 3\n")},
            "outputs: {'{scan}-a.ply': a, '{scan}-b.ply': b}\n");
    NodeWarnings warnings;
    const RunReport report = run_graph(warnings);
    ASSERT_EQ(warnings.all.size(), 1u);
    EXPECT_THAT(warnings.all[0], HasSubstr((graph_.output_folder / "failed").string() + "'"));
    EXPECT_EQ(report.cells[0].failure.cause, Cause::expectation);
    EXPECT_EQ(report.cells[0].outputs[1].outcome, Outcome::failed);
    EXPECT_TRUE(report.cells[0].outputs[1].evidence.empty());
    EXPECT_TRUE(exists("s-a.ply")) << "an output that cannot be moved stays";
    EXPECT_EQ(content_of(folder_ / "out/failed"), "x");
}

TEST_F(CachedRun, UnmetExpectationOfACachedResult_WritesEvidence) {
    const auto expecting = [&](const std::string& points) {
        return run("  - test-step: {factor: 2}\n    expect: {points: " + points + "}\n", {scan("a.xyz")},
                   "outputs: {'{scan}.ply': test-step}\n");
    };
    ASSERT_TRUE(expecting("4").outcome() == Outcome::ok);
    const std::string before = content_of(folder_ / "out/a.ply");
    const RunReport unmet = expecting("'> 4'");
    EXPECT_EQ(unmet.nodes[1].origin, Origin::cached);
    EXPECT_EQ(unmet.cells[0].failure.cause, Cause::expectation);
    EXPECT_EQ(content_of(folder_ / "out/failed/a.ply"), before);
    EXPECT_EQ(content_of(folder_ / "out/a.ply.previous"), before) << "the result of the run before";
    EXPECT_FALSE(fs::exists(folder_ / "out/a.ply"));
}

}  // namespace
}  // namespace scanmill::test
