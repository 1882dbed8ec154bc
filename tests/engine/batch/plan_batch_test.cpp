// SPDX-License-Identifier: GPL-3.0-or-later
// A batch together with its workflows: who runs under which plan, and what is wrong between them.

#include "engine/batch/batch_support.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::Contains;
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

TEST_F(PlanBatch, FilesThatAreNoWorkflows_AreReportedAtTheirPosition) {
    folder_.write("b2.yaml", "scanmill: 1\nbatch: b\n");
    folder_.write("big.yaml", std::string((16u << 20) + 1, '#'));
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [scans/a.ply]\nworkflows: [b2.yaml, big.yaml]\n"),
                ElementsAre(AllOf(StartsWith("b:4:13: "), HasSubstr("b2.yaml' is a batch")),
                            AllOf(StartsWith("b:4:22: "), HasSubstr("has more than 16777216 bytes"))));
}

TEST_F(PlanBatch, WorkflowWithoutInputs_RunsOnce) {
    folder_.write("none.yaml", "scanmill: 1\nname: none\nsteps: [{make: }]\noutputs: {'{scan}.ply': make}\n");
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [scans/*.ply]\nworkflows: [none.yaml, w.yaml]\n"), IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(2));
    EXPECT_THAT(checked_.parts[0].scans, IsEmpty());
    EXPECT_THAT(checked_.parts[1].scans, SizeIs(4));
    EXPECT_EQ(checked_.cells(), 5u);
}

TEST_F(PlanBatch, WithoutTheKeyScans_RunsWorkflowsWithoutInputs) {
    folder_.write("none.yaml", "scanmill: 1\nparameters: {n: 1}\nsteps: [{make: }, {thin: {count: $n, size: 1 u}}]\n");
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nworkflows: none.yaml\nset: {n: {sweep: [1, 2, 3]}}\n"), IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(1));
    EXPECT_THAT(checked_.parts[0].scans, IsEmpty());
    EXPECT_EQ(checked_.cells(), 3u) << "one of each variant";
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nworkflows: none.yaml\nmeasure:\n"),
                Contains(HasSubstr("no scan has a truth")));
}

TEST_F(PlanBatch, WorkflowThatReadsAScan_IsRefusedWithoutTheKeyScans) {
    folder_.write("none.yaml", "scanmill: 1\nsteps: [{make: }]\n");
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nworkflows: [none.yaml, w.yaml]\n"),
                ElementsAre(AllOf(StartsWith("b:3:24: the workflow '"),
                                  HasSubstr("w.yaml' reads a scan, but the batch has no scans; expected `scans:`"))));
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nworkflows: w.yaml\ngate: {points: exact}\n"), SizeIs(1))
        << "the gate is not checked without a cell";
}

TEST_F(PlanBatch, ScansThatNoWorkflowTakes_AreRefusedWithTheirNumber) {
    folder_.write("none.yaml", "scanmill: 1\nsteps: [{make: }]\n");
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [scans/*.ply]\nworkflows: none.yaml\n"),
                ElementsAre("b:3:9: no workflow of the batch takes scans; scans given: 4"));
    EXPECT_TRUE(checked_.has_errors());
}

class FurtherInputs : public PlanBatch {
protected:
    FurtherInputs() {
        folder_.write("two.yaml",
                      "scanmill: 1\ninputs: {scan: points, target: points}\nsteps: [{register: {}, in: {source: scan, "
                      "target: target}}]\n");
        folder_.write("t.ply", "x");
    }
    std::vector<std::string> check_two(const std::string& scans, const std::string& workflows = "two.yaml") {
        return check("scanmill: 1\nbatch: b\nworkflows: [" + workflows + "]\nscans: " + scans + "\n");
    }
};

TEST_F(FurtherInputs, AreFedByTheScans) {
    EXPECT_THAT(check_two("[{path: scans/*.ply, in: {target: t.ply}}]", "two.yaml, w.yaml"), IsEmpty())
        << "w.yaml has no such input";
    ASSERT_THAT(checked_.parts, SizeIs(2));
    EXPECT_THAT(checked_.parts[0].scans, SizeIs(4));
}

TEST_F(FurtherInputs, ThatNothingFeeds_AreReportedAtTheWorkflow) {
    EXPECT_THAT(
        check_two("[{path: scans/a.ply, in: {target: t.ply}}, 'scans/[b-d].ply']"),
        ElementsAre(AllOf(StartsWith("b:3:13: the input 'target' of '"), HasSubstr("has no file for the scan '"),
                          HasSubstr("scans/b.ply' and 2 more; expected `in: {target: FILE}` at the scan"))));
}

TEST_F(FurtherInputs, ThatNoWorkflowHas_AreReportedWithTheClosest) {
    EXPECT_THAT(check_two("[{path: scans/a.ply, in: {target: t.ply, taget: t.ply}}]"),
                ElementsAre(AllOf(StartsWith("b:4:49: no workflow has an input 'taget'"), HasSubstr("they have target"),
                                  HasSubstr("did you mean 'target'?"))));
    EXPECT_THAT(check_two("[{path: scans/a.ply, in: {scan: t.ply, target: t.ply}}]"),
                ElementsAre(AllOf(StartsWith("b:4:34: the scan itself feeds 'scan'"), HasSubstr("as `path`"))));
    EXPECT_THAT(check_two("[{path: scans/a.ply, in: {x: t.ply}}]", "w.yaml"), ElementsAre(HasSubstr("they have none")));
}

TEST_F(FurtherInputs, OfOneFile_TakeNoList) {
    EXPECT_THAT(
        check_two("[{path: scans/a.ply, in: {target: [t.ply, t.ply]}}]"),
        ElementsAre(AllOf(StartsWith("b:4:34: the input 'target' of '"), HasSubstr("takes one file; found 2"))));
    folder_.write("two.yaml",
                  "scanmill: 1\ninputs: {scan: points, more: [points]}\nsteps: [{combine: {}, in: {points: more}}]\n");
    EXPECT_THAT(check_two("[{path: scans/a.ply, in: {more: [t.ply, scans/b.ply]}}]"), IsEmpty());
}

TEST_F(FurtherInputs, OfAListOfScans_AreTheSameForAll) {
    folder_.write("two.yaml",
                  "scanmill: 1\ninputs: {views: [points], target: points}\nsteps: [{combine: {}, in: {points: views}}, "
                  "{register: {}, in: "
                  "{source: combine, target: target}}]\n");
    EXPECT_THAT(check_two("[{path: scans/*.ply, in: {target: t.ply}}]"), IsEmpty());
    EXPECT_EQ(checked_.cells(), 1u);
    EXPECT_THAT(check_two("[{path: scans/a.ply, in: {target: t.ply}}, {path: scans/b.ply, in: {target: scans/c.ply}}]"),
                ElementsAre(AllOf(StartsWith("b:4:76: '"), HasSubstr("needs the same files for the input 'target'"))));
}

class SharedFiles : public PlanBatch {
protected:
    std::vector<std::string> check_outputs(const std::string& outputs, const std::string& scans) {
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps: [thin: ]\noutputs: " + outputs);
        return check("scanmill: 1\nbatch: b\nscans: [" + scans + "]\nworkflows: w.yaml\n");
    }
};

TEST_F(SharedFiles, OfScansOfOneName_AreReported) {
    folder_.write("scans/a.xyz", "x");
    const auto both = AllOf(HasSubstr("scans/a.ply' under variant 'default' and scan '"),
                            HasSubstr("scans/a.xyz' under"), HasSubstr("would both write 'a.ply'"),
                            HasSubstr("rename one of the scans"), testing::Not(HasSubstr("{folder}")));
    EXPECT_THAT(check_outputs("{'{scan}.ply': thin}\n", "scans/a.ply, scans/a.xyz"),
                ElementsAre(AllOf(StartsWith("b:3:22: scan '"), both)));
    folder_.write("other/a.ply", "x");
    EXPECT_THAT(check_outputs("{'{scan}.ply': thin}\n", "scans/a.ply, other/a.ply"),
                ElementsAre(HasSubstr("put {folder} into")));
    EXPECT_THAT(check_outputs("{'{folder}/{scan}.ply': thin}\n", "scans/a.ply, other/a.ply"), IsEmpty());
}

TEST_F(SharedFiles, OfAnOutputAndADescription_AreReported) {
    folder_.write("scans/a.ply.xyz", "x");
    EXPECT_THAT(check_outputs("{'{scan}': scan, '{scan}.json.ply': thin}\n", "scans/a.ply"), testing::Not(IsEmpty()));
    EXPECT_THAT(check_outputs("{'{scan}/x.ply': thin, '{scan}.ply': thin}\n", "scans/a.ply, scans/a.ply.xyz"),
                ElementsAre(HasSubstr("a.ply")));
}

TEST_F(SharedFiles, OfManyCells_AreTenAtMost) {
    for (int i = 0; i < 30; ++i) folder_.write("many/" + std::to_string(i) + ".ply", "x");
    EXPECT_THAT(check_outputs("{'all.ply': thin}\n", "many/*.ply"), SizeIs(testing::Le(10u)));
    EXPECT_TRUE(checked_.has_errors());
}

TEST_F(SharedFiles, OfTwoOutputsOfOneValue_AreAllowed) {
    EXPECT_THAT(check_outputs("{'{scan}.ply': thin, '{scan}.xyz': thin}\n", "scans/*.ply"), IsEmpty());
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
