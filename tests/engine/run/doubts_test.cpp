// SPDX-License-Identifier: GPL-3.0-or-later
/// Cells whose filters doubt their results.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/run/cached_run_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class DoubtfulRun : public CachedRun {
protected:
    RunReport run_with_output(const std::string& mode, const std::string& port) {
        return run("  - id: first\n    test-step: {mode: " + mode + "}\n", {scan("a.xyz")},
                   "outputs: {'{scan}.ply': first." + port + "}\n");
    }
    nlohmann::json description() { return nlohmann::json::parse(content_of(folder_ / "out/a.ply.json")); }
};

TEST_F(DoubtfulRun, Cell_IsDoubtfulAndItsOutputIsWritten) {
    const RunReport report = run_with_output("doubt", "points");
    EXPECT_EQ(report.cells[0].outcome, Outcome::doubtful);
    EXPECT_EQ(report.outcome(), Outcome::doubtful);
    EXPECT_THAT(report.cells[0].doubts, ElementsAre("first: was asked to doubt"));
    EXPECT_EQ(report.cells[0].outputs[0].outcome, Outcome::ok);
    EXPECT_EQ(description().at("doubts"), nlohmann::json({"first: was asked to doubt"}));
}

TEST_F(DoubtfulRun, CachedResult_IsStillDoubtful) {
    run_with_output("doubt", "points");
    const RunReport again = run_with_output("doubt", "points");
    EXPECT_THAT(origins(again), ElementsAre(Origin::cached, Origin::cached));
    EXPECT_EQ(again.cells[0].outcome, Outcome::doubtful);
    EXPECT_THAT(again.cells[0].doubts, ElementsAre("first: was asked to doubt"));
}

TEST_F(DoubtfulRun, DoubtAboutOnePort_ConcernsOnlyCellsThatUseIt) {
    EXPECT_EQ(run_with_output("doubt-mesh", "mesh").cells[0].outcome, Outcome::doubtful);
    const RunReport unused = run_with_output("doubt-mesh", "points");
    EXPECT_EQ(unused.cells[0].outcome, Outcome::ok);
    EXPECT_THAT(unused.cells[0].doubts, IsEmpty());
    EXPECT_THAT(description().at("doubts"), IsEmpty());
}

TEST_F(DoubtfulRun, EarlierStep_MakesLaterOutputsDoubtful) {
    const RunReport report = run_two("mode: doubt", "factor: 2");
    EXPECT_EQ(report.cells[0].outcome, Outcome::doubtful);
    EXPECT_THAT(report.cells[0].doubts, ElementsAre("first: was asked to doubt"));
    EXPECT_EQ(run_two("mode: doubt-mesh", "factor: 2").cells[0].outcome, Outcome::ok) << "the points are used";
}

TEST_F(DoubtfulRun, OtherVariants_AreNotDoubtful) {
    const RunReport report =
        run("  - id: x\n    one-of:\n      - {id: good, test-step: {factor: 2}}\n      - {id: bad, test-step: {mode: "
            "doubt}}\n",
            {scan("a.xyz")}, "outputs: {'{scan}-{variant}.ply': x.points}\n");
    ASSERT_EQ(report.cells.size(), 2u);
    EXPECT_EQ(report.cells[0].outcome, Outcome::ok);
    EXPECT_EQ(report.cells[1].outcome, Outcome::doubtful);
}

TEST_F(DoubtfulRun, FailedCell_IsFailedWithItsDoubts) {
    const RunReport report = run_two("mode: doubt", "mode: fail");
    EXPECT_EQ(report.cells[0].outcome, Outcome::failed);
    EXPECT_EQ(report.outcome(), Outcome::failed);
    EXPECT_THAT(report.cells[0].doubts, ElementsAre("first: was asked to doubt"));
}

}  // namespace
}  // namespace scanmill::test
