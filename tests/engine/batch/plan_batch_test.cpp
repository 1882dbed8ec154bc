// SPDX-License-Identifier: GPL-3.0-or-later
// A batch together with its workflows: who runs under which plan, and what is wrong between them.

#include "engine/batch/batch_support.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class PlanBatch : public test::Batches {
protected:
    PlanBatch() {
        for (const char* scan : {"c.ply", "d.ply"}) folder_.write(std::string("scans/") + scan, "x");
    }
    /// What the step of the part has in its parameter.
    std::string value(std::size_t part, const std::string& parameter) const {
        return text(*checked_.parts.at(part).plan->steps.at(0).parameters.find(parameter));
    }
};

TEST_F(PlanBatch, ScansOfEqualValues_ShareAPart) {
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans:\n  - {path: scans/a.ply, set: {n: 2}}\n  - scans/b.ply\n"
                      "  - {path: scans/c.ply, set: {n: 2}}\n  - {path: scans/d.ply, set: {n: 3}}\nworkflows: w.yaml\n"
                      "set: {n: 3, s: 5 u}\n"),
                IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(2));
    EXPECT_THAT(checked_.parts[0].scans, ElementsAre(0, 2));
    EXPECT_THAT(checked_.parts[1].scans, ElementsAre(1, 3)) << "the same value, from the batch and from the scan";
    EXPECT_EQ(value(0, "count"), "2");
    EXPECT_EQ(value(1, "count"), "3");
    EXPECT_EQ(value(0, "size"), "5 u") << "what a scan does not set is the batch's";
    EXPECT_FALSE(checked_.has_errors());
    EXPECT_THAT(checked_.diagnostics, SizeIs(2));
}

TEST_F(PlanBatch, WorkflowsOnlyTakeTheNamesTheyDeclare) {
    folder_.write("v.yaml",
                  "scanmill: 1\ninputs: {scan: points}\nparameters: {size: 1 u}\nsteps: [{thin: {size: $size}}]\n");
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [{path: scans/a.ply, set: {n: 2}}, 'scans/[b-d].ply']\n"
                      "workflows: [w.yaml, v.yaml]\nset: {size: {sweep: [2 u, 3 u]}}\n"),
                IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(3)) << "n is nothing to v.yaml, so all its scans are one part";
    EXPECT_EQ(checked_.parts[2].workflow, 1u);
    EXPECT_THAT(checked_.parts[2].scans, ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(checked_.parts[2].plan->variants, SizeIs(2));
    EXPECT_EQ(checked_.variants(), 3u);
}

TEST_F(PlanBatch, BadValue_IsReportedAtItsPositionInTheBatch) {
    const auto found = check(
        "scanmill: 1\nbatch: b\nscans:\n  - {path: scans/a.ply, set: {n: 12}}\n  - scans/b.ply\nworkflows: w.yaml\n"
        "set: {n: {sweep: [1, x]}, s: 0.5}\n");
    EXPECT_THAT(found, ElementsAre("b:4:34: $n is the count of thin: 12 is out of range; expected a whole number of at "
                                   "least 1 and at most 9",
                                   AllOf(StartsWith("b:7:22: $n is the count of thin: 'x' is not a whole number")),
                                   AllOf(StartsWith("b:7:30: $s is the size of thin: '0.5' has no unit"))));
    EXPECT_TRUE(checked_.has_errors());
}

TEST_F(PlanBatch, NameThatNoWorkflowDeclares_IsReportedWithTheClosest) {
    EXPECT_THAT(
        check("scanmill: 1\nbatch: b\nscans: [{path: scans/a.ply, set: {m: 1}}]\nworkflows: w.yaml\nset: {nn: 1}\n"),
        ElementsAre("b:3:35: none of the workflows has a parameter 'm'; they have n and s",
                    "b:5:7: none of the workflows has a parameter 'nn'; they have n and s; did you mean 'n'?"));
}

TEST_F(PlanBatch, MistakesOfAWorkflow_AreToldInItOnce) {
    folder_.write("w.yaml", "scanmill: 1\ninputs: {scan: points}\nparameters: {n: 1}\nsteps: [{thinn: {count: $n}}]\n");
    EXPECT_THAT(
        check("scanmill: 1\nbatch: b\nscans: [{path: scans/a.ply, set: {n: 2}}, scans/b.ply]\nworkflows: w.yaml\n"),
        ElementsAre(StartsWith("w:4:10: there is no filter 'thinn'")));
}

TEST_F(PlanBatch, WorkflowWithoutOneInput_IsReportedAtItsPosition) {
    folder_.write("none.yaml", "scanmill: 1\nsteps: [{make: }]\n");
    folder_.write(
        "two.yaml",
        "scanmill: 1\ninputs: {scan: points, target: points}\nsteps: [{register: {}, in: {source: scan, target: "
        "target}}]\n");
    folder_.write("b2.yaml", "scanmill: 1\nbatch: b\n");
    folder_.write("big.yaml", std::string((16u << 20) + 1, '#'));
    EXPECT_THAT(
        check("scanmill: 1\nbatch: b\nscans: [scans/a.ply]\nworkflows: [none.yaml, two.yaml, b2.yaml, big.yaml]\n"),
        ElementsAre(AllOf(StartsWith("b:4:13: "), HasSubstr("none.yaml' has no inputs")),
                    AllOf(StartsWith("b:4:24: "), HasSubstr("has 2 inputs"), HasSubstr("with a file for 'target'")),
                    AllOf(StartsWith("b:4:34: "), HasSubstr("b2.yaml' is a batch")),
                    AllOf(StartsWith("b:4:43: "), HasSubstr("has more than 16777216 bytes"))));
}

TEST_F(PlanBatch, FirstInputThatIsAList_TakesAllScansOfAPart) {
    folder_.write("w.yaml", "scanmill: 1\ninputs: {views: [points]}\nsteps: [{combine: }]\n");
    EXPECT_THAT(check(head), IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(1));
    EXPECT_THAT(checked_.parts[0].scans, SizeIs(4));
}

TEST_F(PlanBatch, WithoutScans_WorkflowsAreCheckedAllTheSame) {
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [absent/*.ply]\nworkflows: w.yaml\nset: {n: x}\n"),
                ElementsAre(HasSubstr("no file matches"), HasSubstr("'x' is not a whole number")));
}

TEST(PlanSettings, WithoutAFileOfTheirOwn_AreToldAtTheStep) {
    const test::DeclaredFilters filters;
    const FilterLibrary library = filters.library();
    Diagnostics diagnostics("w"), settings("s");
    const Workflow workflow = parse_workflow(
        "scanmill: 1\ninputs: {scan: points}\nparameters: {n: 1}\nsteps: [{thin: {count: $n}}]\n", diagnostics);
    const Settings given{{"n", parse_value_expression("x", diagnostics)}};
    make_plan(workflow, library, given, settings, &diagnostics);
    EXPECT_TRUE(diagnostics.has_errors());
    EXPECT_FALSE(settings.has_errors());
    Diagnostics alone("w");
    make_plan(workflow, library, given, alone);
    ASSERT_EQ(alone.errors(), 1u);
    EXPECT_THAT(alone.sorted()[0].message, StartsWith("count (from $n): 'x'"));
    EXPECT_THAT(undeclared({{"n", {}}, {"m", {}}}, workflow), ElementsAre("m"));
}

}  // namespace
}  // namespace scanmill
