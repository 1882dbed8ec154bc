// SPDX-License-Identifier: GPL-3.0-or-later
// `measure` of a batch: the steps that it adds to the workflows, and what it refuses.

#include "engine/batch/measuring_batches.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class MeasureOfABatch : public test::MeasuringBatches {};

TEST_F(MeasureOfABatch, EveryVariantGetsAStepForEveryOutputOfTheMeasuredKind) {
    EXPECT_THAT(check(batch("measure: {samples: 7}\n")), IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(1));
    const Plan& planned = plan();
    EXPECT_THAT(measuring(planned), ElementsAre("measure-surface <- surface", "measure-surface <- surface"));
    ASSERT_THAT(planned.variants, SizeIs(2));
    for (const PlannedVariant& variant : planned.variants) {
        const PlannedStep& step = planned.steps[variant.steps.back()];
        EXPECT_EQ(step.spec.name, "compare");
        EXPECT_EQ(text(*step.parameters.find("samples")), "7");
        EXPECT_EQ(text(*step.parameters.find("near")), "1 %diag") << "the default";
        EXPECT_EQ(step.file, file());
        EXPECT_EQ(step.position, (Position{5, 1}));
        ASSERT_THAT(step.inputs, SizeIs(2));
        EXPECT_EQ(step.inputs[0].sources.front().step, variant.steps_by_name.at("surface"));
        EXPECT_EQ(describe(planned, step.inputs[1].sources.front()), "truth");
    }
    ASSERT_THAT(planned.workflow.inputs, SizeIs(2));
    EXPECT_EQ(planned.workflow.inputs[1].name, "truth");
    EXPECT_EQ(planned.workflow.inputs[1].kind, kind_of<TriangleMesh>());
    EXPECT_THAT(planned.workflow.inputs[1].also, ElementsAre(kind_of<PointCloud>()));
}

TEST_F(MeasureOfABatch, ScansWithoutTruth_HaveAPlanWithoutTheSteps) {
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [scans/a.ply, {path: scans/b.ply, truth: truth/b.stl}]\n"
                      "workflows: w.yaml\nmeasure:\n"),
                IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(2));
    EXPECT_THAT(checked_.parts[0].scans, ElementsAre(0));
    EXPECT_THAT(measuring(plan(0)), IsEmpty());
    EXPECT_THAT(plan(0).workflow.inputs, SizeIs(1));
    EXPECT_THAT(checked_.parts[1].scans, ElementsAre(1));
    EXPECT_THAT(measuring(plan(1)), SizeIs(2));
    ASSERT_EQ(plan(0).steps.size() + 2, plan(1).steps.size());
    for (const PlannedStep& step : plan(0).steps)
        EXPECT_EQ(std::ranges::count(plan(1).steps, step.structure_key, &PlannedStep::structure_key), 1)
            << "so they share their results";
}

TEST_F(MeasureOfABatch, NamedValues_AreMeasuredInTheirPlace) {
    EXPECT_THAT(check(batch("measure: {of: [light]}\n")), IsEmpty());
    EXPECT_THAT(measuring(plan()), ElementsAre("measure-light <- light", "measure-light <- light"));
    EXPECT_THAT(check(batch("measure: {of: [surface.mesh, light]}\n")), IsEmpty());
    EXPECT_THAT(measuring(plan()),
                testing::UnorderedElementsAre("measure-surface-mesh <- surface", "measure-light <- light",
                                              "measure-surface-mesh <- surface", "measure-light <- light"));
    EXPECT_THAT(check(batch("measure: {of: [surface, surface.mesh]}\n")), IsEmpty());
    EXPECT_THAT(measuring(plan()), SizeIs(2)) << "one value under two names";
}

TEST_F(MeasureOfABatch, ValueOfSomeVariants_IsMeasuredInThese) {
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - tetrahedralise:\n  - id: end\n    one-of:\n"
                  "      - {name: whole, steps: [{id: body, solid: }]}\n"
                  "      - {name: light, steps: [solid: , {id: thin, simplify: {max-error: 1 u}}]}\n"
                  "outputs: {'{scan}.{variant}.stl': end}\n");
    EXPECT_THAT(check(batch("measure: {of: thin}\n")), IsEmpty());
    EXPECT_THAT(measuring(plan()), ElementsAre("measure-thin <- thin"));
    EXPECT_THAT(check(batch("measure:\n")), IsEmpty());
    EXPECT_THAT(measuring(plan()), ElementsAre("measure-end <- body", "measure-end <- thin"))
        << "by the name that the workflow refers to it";
}

TEST_F(MeasureOfABatch, OutputThatIsAnInput_IsMeasured) {
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: mesh}\nsteps: [{simplify: {max-error: 1 u}}]\n"
                  "outputs: {'{scan}.stl': scan, '{scan}.ply': scan, '{scan}.light.ply': simplify}\n");
    EXPECT_THAT(check(batch("measure:\n")), IsEmpty());
    EXPECT_THAT(measuring(plan()), ElementsAre("measure-scan <- scan", "measure-simplify <- simplify"));
}

TEST_F(MeasureOfABatch, Truth_IsWiredToNothingElse) {
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: mesh}\nsteps: [{simplify: {max-error: 1 u}}]\noutputs: {'{scan}.stl': "
                  "simplify}\n");
    EXPECT_THAT(check(batch("measure:\n")), IsEmpty()) << "two inputs of kind mesh would be ambiguous";
    EXPECT_EQ(describe(plan(), plan().steps.front().inputs.front().sources.front()), "scan");
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: mesh}\nsteps:\n  - simplify: {max-error: 1 u}\n    in: truth\n"
                  "outputs: {'{scan}.stl': simplify}\n");
    EXPECT_THAT(check(batch("measure:\n")), ElementsAre(HasSubstr("'truth' is neither an earlier step nor an input")));
}

TEST_F(MeasureOfABatch, NamesThatItAdds_MayNotBeTaken) {
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: mesh, truth: mesh}\nsteps: [{simplify: {max-error: 1 u}, in: "
                  "scan}]\noutputs: {'{scan}.stl': simplify}\n");
    const std::string fed =
        "scanmill: 1\nbatch: b\nscans: [{path: scans/a.ply, truth: truth/a.stl, in: {truth: "
        "truth/a.stl}}]\nworkflows: w.yaml\nmeasure:\n";
    EXPECT_THAT(check(fed), ElementsAre(AllOf(StartsWith("w:2:22: the input has the name 'truth'"),
                                              HasSubstr("rename the input"))));
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: mesh}\nsteps:\n  - id: measure-x\n    simplify: {max-error: 1 u}\n"
                  "  - id: x\n    simplify: {max-error: 2 u}\noutputs: {'{scan}.stl': x}\n");
    EXPECT_THAT(check(batch("measure:\n")), ElementsAre(AllOf(StartsWith("w:5:5: the step has the name 'measure-x'"),
                                                              HasSubstr("rename the step"))));
}

TEST_F(MeasureOfABatch, WrongParameters_AreReportedOnceInTheBatch) {
    EXPECT_THAT(check(batch("measure: {samples: 0}\nset: {alpha: 1 u}\n")),
                ElementsAre(AllOf(StartsWith("b:5:20: samples: 0 is out of range"))));
    EXPECT_THAT(check(batch("measure: {near: 3}\n")), ElementsAre(AllOf(StartsWith("b:5:17: near: '3' has no unit"))));
    EXPECT_THAT(check(batch("measure: {sampels: 3}\n")),
                ElementsAre(AllOf(StartsWith("b:5:11: compare has no parameter 'sampels'"),
                                  HasSubstr("did you mean 'samples'?"))));
    EXPECT_THAT(check(batch("measure: {samples: {sweep: [1, 2]}}\n")), ElementsAre(HasSubstr("has one value")));
    EXPECT_THAT(check(batch("measure: {samples: $n}\n")), ElementsAre(HasSubstr("cannot refer to a parameter")));
}

TEST_F(MeasureOfABatch, ValuesThatAreNone_AreRefused) {
    EXPECT_THAT(check(batch("measure: {of: [surfcae]}\n")),
                ElementsAre(AllOf(StartsWith("b:5:16: no workflow has a step 'surfcae' to measure"),
                                  HasSubstr("did you mean 'surface'?"))));
    EXPECT_THAT(check(batch("measure: {of: tetrahedralise}\n")),
                ElementsAre("b:5:15: 'tetrahedralise' is tets; compare measures mesh"));
    EXPECT_THAT(check(batch("measure: {of: [surface.mehs]}\n")),
                ElementsAre(AllOf(HasSubstr("'surface' has no output port 'mehs'"), HasSubstr("'mesh'?"))));
    EXPECT_THAT(check(batch("measure: {of: []}\n")), ElementsAre(HasSubstr("the list of values to measure is empty")));
    EXPECT_THAT(check(batch("measure: {of: [[a]]}\n")), ElementsAre(HasSubstr("expected the name of a step")));
    EXPECT_THAT(check(batch("measure: surface\n")), ElementsAre(HasSubstr("expected a map, as {of: [surface]")));
}

TEST_F(MeasureOfABatch, WithoutTruthOrWithoutAValue_IsRefused) {
    EXPECT_THAT(check(head + "measure: {}\n"),
                ElementsAre(AllOf(StartsWith("b:5:1: no scan has a truth"), HasSubstr("expected `truth: FILE`"))));
    folder_.write("w.yaml", "scanmill: 1\ninputs: {scan: points}\nsteps: [thin: ]\noutputs: {'{scan}.ply': thin}\n");
    EXPECT_THAT(
        check(batch("measure:\n")),
        ElementsAre(AllOf(StartsWith("b:5:1: no workflow has an output of kind mesh"), HasSubstr("`of: [STEP]`"))));
}

TEST_F(MeasureOfABatch, WorkflowOfWhichNothingIsMeasured_IsAWarning) {
    folder_.write("v.yaml", "scanmill: 1\ninputs: {scan: points}\nsteps: [thin: ]\noutputs: {'{scan}.ply': thin}\n");
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [{path: scans/a.ply, truth: truth/a.stl}]\nworkflows: [w.yaml, "
                      "v.yaml]\nmeasure:\n"),
                ElementsAre(AllOf(StartsWith("b:4:21: warning: no result of "), HasSubstr("no output of kind mesh"))));
    EXPECT_FALSE(checked_.has_errors());
}

TEST_F(MeasureOfABatch, TruthWithoutIt_IsAWarning) {
    EXPECT_THAT(check(batch("")), ElementsAre(AllOf(StartsWith("b:3:39: warning: `truth` has no effect"))));
}

TEST_F(MeasureOfABatch, SeveralMeasuringFilters_NeedAName) {
    filters_.add(test::measuring_filter("contrast"));
    library_ = filters_.library();
    EXPECT_THAT(check(batch("measure:\n")), ElementsAre(AllOf(StartsWith("b:5:1: compare and contrast measure results"),
                                                              HasSubstr("`filter: NAME`"))));
    EXPECT_THAT(check(batch("measure: {filter: contrast}\n")), IsEmpty());
    EXPECT_EQ(plan().steps.back().spec.name, "contrast");
    EXPECT_THAT(check(batch("measure: {filter: contrats}\n")),
                ElementsAre(AllOf(StartsWith("b:5:19: 'contrats' is not a filter that measures"),
                                  HasSubstr("did you mean 'contrast'?"))));
    EXPECT_THAT(check(batch("measure: {filter: thin}\n")),
                ElementsAre(HasSubstr("'thin' is not a filter that measures")));
    const test::DeclaredFilters without;
    library_ = without.library();
    EXPECT_THAT(check(batch("measure:\n")), ElementsAre(HasSubstr("no installed filter measures results")));
}

TEST_F(MeasureOfABatch, ListOfScans_IsMeasuredByTheTruthThatAllHave) {
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {views: [points]}\nsteps: [combine: , tetrahedralise: , solid: ]\noutputs: "
                  "{'{scan}.stl': solid}\n");
    const std::string end = "workflows: w.yaml\nmeasure:\n";
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [{path: scans/*.ply, truth: truth/a.stl}]\n" + end), IsEmpty());
    ASSERT_THAT(checked_.parts, SizeIs(1));
    EXPECT_THAT(checked_.parts[0].scans, SizeIs(2));
    EXPECT_THAT(measuring(plan()), ElementsAre("measure-solid <- solid"));
    EXPECT_THAT(check("scanmill: 1\nbatch: b\nscans: [{path: scans/*.ply, truth: 'truth/{stem}.stl'}]\n" + end),
                ElementsAre(AllOf(StartsWith("b:4:12: warning: "), HasSubstr("have different truths"))));
    ASSERT_THAT(checked_.parts, SizeIs(1));
    EXPECT_THAT(measuring(plan()), IsEmpty());
}

}  // namespace
}  // namespace scanmill
