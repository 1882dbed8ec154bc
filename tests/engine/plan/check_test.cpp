// SPDX-License-Identifier: GPL-3.0-or-later
// All errors of a workflow are found at once, before any scan is opened, each with its position.

#include "engine/plan/workflow_findings.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class Check : public test::WorkflowFindings {};

TEST_F(Check, SevenMistakes_AreAllFoundInOneGoWithPlaceAndProposal) {
    const auto found = findings(R"(scanmill: 1
inputs: {scan: points}
steps:
  - thinn: {size: 1 %diag}
  - thin: {siz: 1 %diag}
  - thin: {size: 0.5}
  - tetrahedralise:
  - solid: {coverage: 300 %}
    in: {tets: scan}
  - id: a
    simplify: {max-error: 1 mm, max-error: 2 mm}
outputs:
  "../{scan}.stl": a
)");
    EXPECT_THAT(
        found,
        ElementsAre(AllOf(StartsWith("w:4:5: "), HasSubstr("no filter 'thinn'"), HasSubstr("did you mean 'thin'?")),
                    AllOf(StartsWith("w:5:12: "), HasSubstr("no parameter 'siz'"), HasSubstr("did you mean 'size'?")),
                    AllOf(StartsWith("w:6:18: "), HasSubstr("'0.5' has no unit"), HasSubstr("0.1 %diag")),
                    AllOf(StartsWith("w:8:23: "), HasSubstr("300 % is out of range"), HasSubstr("at most 1")),
                    AllOf(StartsWith("w:9:16: "), HasSubstr("'scan' is points"), HasSubstr("takes tets"),
                          HasSubstr("'tetrahedralise'")),
                    AllOf(StartsWith("w:11:33: "), HasSubstr("'max-error' is repeated")),
                    AllOf(StartsWith("w:13:3: "), HasSubstr("outside the output folder"))));
}

TEST_F(Check, SoundWorkflow_HasNoFindings) {
    EXPECT_THAT(steps("  - thin: {size: 0.1 %diag, axis: [1, 0, 0], rule: random}\n  - tetrahedralise:\n  - solid: "
                      "{alpha: auto}\n"),
                IsEmpty());
}

TEST_F(Check, RuleForInvalidRows_IsDropOrRefuseAndForPoints) {
    const auto input = [&](const std::string& text) {
        return findings("scanmill: 1\ninputs: {scan: " + text + "}\nsteps: [{make: }]\n");
    };
    EXPECT_THAT(input("{kind: points, invalid: drop}"), IsEmpty());
    EXPECT_EQ(plan_.workflow.inputs[0].invalid, InvalidRows::drop);
    EXPECT_THAT(input("{kind: [points], invalid: refuse}"), IsEmpty());
    EXPECT_THAT(
        input("{kind: points, invalid: ignore}"),
        ElementsAre(AllOf(StartsWith("w:2:40: "), HasSubstr("'ignore'"), HasSubstr("expected drop or refuse"))));
    EXPECT_THAT(input("{kind: mesh, invalid: drop}"),
                ElementsAre(AllOf(StartsWith("w:2:29: "), HasSubstr("`invalid` is for points"), HasSubstr("mesh"))));
}

TEST_F(Check, MissingGrammarVersion_IsAnError) {
    EXPECT_THAT(findings("steps: [{make: }]\n"),
                ElementsAre(HasSubstr("w:1:1: has no grammar version; expected `scanmill: 1`")));
    EXPECT_THAT(findings("scanmill: 2\nsteps: [{make: }]\n"),
                ElementsAre(AllOf(StartsWith("w:1:11"), HasSubstr("'2'"))));
}

TEST_F(Check, UnknownTopLevelKey_ProposesTheClosest) {
    EXPECT_THAT(findings("scanmill: 1\nstep: [{make: }]\n"),
                testing::Contains(AllOf(StartsWith("w:2:1: "), HasSubstr("did you mean 'steps'?"))));
}

TEST_F(Check, NoSteps_IsAnError) {
    EXPECT_THAT(findings("scanmill: 1\n"), ElementsAre(HasSubstr("has no steps")));
    EXPECT_THAT(findings("scanmill: 1\nsteps: []\n"), ElementsAre(HasSubstr("the list of steps is empty")));
}

TEST_F(Check, EmptyFile_IsAnError) {
    EXPECT_THAT(findings(""), ElementsAre(HasSubstr("is empty; expected a workflow")));
}

TEST_F(Check, NotYaml_NamesThePlace) {
    EXPECT_THAT(findings("scanmill: 1\nsteps: [\n"), testing::Contains(HasSubstr("invalid YAML")));
}

TEST_F(Check, TwoFiltersInOneStep_SaysHowToBeginAnotherStep) {
    EXPECT_THAT(steps("  - thin: {}\n    make: {}\n"),
                ElementsAre(AllOf(StartsWith("w:5:5: "), HasSubstr("found 'make' beside 'thin'"))));
}

TEST_F(Check, StepsThatCannotBeRead_AreNotReportedToShareAnId) {
    EXPECT_THAT(steps("  - x\n  - y\n"), ElementsAre(HasSubstr("found 'x'"), HasSubstr("found 'y'")));
}

TEST_F(Check, StepWithoutFilter_IsAnError) {
    EXPECT_THAT(steps("  - id: a\n"), ElementsAre(AllOf(StartsWith("w:4:5: "), HasSubstr("the step has no filter"))));
}

TEST_F(Check, RequiredParameterLeftOut_SaysWhatItTakes) {
    EXPECT_THAT(steps("  - tetrahedralise:\n  - solid:\n  - simplify:\n"),
                ElementsAre(AllOf(StartsWith("w:6:5: "), HasSubstr("needs the parameter 'max-error'"),
                                  HasSubstr("a length above 0"))));
}

TEST_F(Check, WrongTypes_SayWhatWasExpected) {
    EXPECT_THAT(
        steps("  - thin: {count: many, rule: nearst, axis: [1, 2], size: [1 u]}\n"),
        ElementsAre(AllOf(HasSubstr("count: 'many' is not a whole number"), HasSubstr("of at least 1 and at most 9")),
                    AllOf(HasSubstr("rule: 'nearst'"), HasSubstr("did you mean 'nearest'?")),
                    AllOf(HasSubstr("axis: has 2 values"), HasSubstr("a list of 3 values")),
                    AllOf(HasSubstr("size: is a list"), HasSubstr("a length above 0"))));
    EXPECT_THAT(steps("  - thin: {size: }\n"), ElementsAre(HasSubstr("found nothing; expected a value")));
    EXPECT_THAT(steps("  - thin: {size: 0 u, count: 0}\n"),
                ElementsAre(HasSubstr("size: 0 u is out of range"), HasSubstr("count: 0 is out of range")));
    EXPECT_THAT(
        steps("  - tetrahedralise:\n  - solid: {alpha: atuo, angle: 40}\n"),
        ElementsAre(HasSubstr("did you mean 'auto'?"), HasSubstr("'40' has no unit; expected 40 deg or 0.7 rad")));
}

TEST_F(Check, IdsAndInputs_HaveDifferentNames) {
    EXPECT_THAT(steps("  - id: scan\n    thin:\n"), ElementsAre(HasSubstr("already the name of an input")));
    EXPECT_THAT(steps("  - id: a\n    thin: {size: 1 u}\n  - id: a\n    thin: {size: 2 u}\n"),
                ElementsAre(HasSubstr("'a' is used twice")));
    EXPECT_THAT(steps("  - id: 1a\n    thin:\n"), ElementsAre(HasSubstr("'1a' is not a name")));
}

TEST_F(Check, InputKinds_AreThoseThatFilesHold) {
    EXPECT_THAT(findings("scanmill: 1\ninputs: {scan: point}\nsteps: [{thin: }]\n"),
                ElementsAre(HasSubstr("did you mean 'points'?")));
    EXPECT_THAT(findings("scanmill: 1\ninputs: {scan: points, t: tets}\nsteps: [{thin: }]\n"),
                ElementsAre(HasSubstr("cannot be read from a file")));
    EXPECT_THAT(findings("scanmill: 1\ninputs: {scan: {kind: points, unit: yard}}\nsteps: [{thin: }]\n"),
                ElementsAre(AllOf(HasSubstr("'yard' is not a unit"), HasSubstr("mm"))));
}

TEST_F(Check, WorkflowParameters_AreTypedWhereTheyAreUsed) {
    const std::string head =
        "scanmill: 1\ninputs: {scan: points}\nparameters:\n  s: {default: 2, help: Size.}\nsteps:\n";
    EXPECT_THAT(findings(head + "  - thin: {size: $s}\n"),
                ElementsAre(AllOf(StartsWith("w:6:18: "), HasSubstr("size (from $s): '2' has no unit"))));
    EXPECT_THAT(findings(head + "  - thin: {count: $s}\n"), IsEmpty());
    EXPECT_THAT(findings(head + "  - thin: {count: $t}\n"),
                ElementsAre(HasSubstr("no step uses the parameter 's'"), HasSubstr("no parameter 't'; it has s")));
}

TEST_F(Check, WorkflowParameterThatOnlyTextsMention_IsUsedByNoStep) {
    EXPECT_THAT(
        findings("scanmill: 1\nsummary: $s\ninputs: {scan: points}\nparameters:\n  s: {default: 2, help: $s}\nsteps:\n"
                 "  - thin: {count: 3}\n"),
        ElementsAre(HasSubstr("no step uses the parameter 's'")));
}

TEST_F(Check, DollarWithoutAName_IsAnError) {
    EXPECT_THAT(steps("  - thin: {size: $}\n"),
                ElementsAre(AllOf(StartsWith("w:4:18: "), HasSubstr("'$' is not the name of a parameter"))));
    EXPECT_THAT(steps("  - thin: {count: {sweep: [1, $]}}\n"),
                ElementsAre(HasSubstr("'$' is not the name of a parameter")));
    Diagnostics diagnostics("--set");
    EXPECT_TRUE(parse_value_expression("$", diagnostics).values.empty());
    EXPECT_TRUE(diagnostics.has_errors());
}

TEST_F(Check, Expect_KnowsFactsAndMetricsOfTheStep) {
    EXPECT_THAT(steps("  - thin:\n    expect: {points: '> 3', kept: [1, 9]}\n"), IsEmpty());
    EXPECT_THAT(steps("  - thin:\n    expect: {keptt: 1}\n"),
                ElementsAre(AllOf(StartsWith("w:5:14: "), HasSubstr("did you mean 'kept'?"))));
    EXPECT_THAT(steps("  - thin:\n    expect: {closed: true}\n"),
                ElementsAre(HasSubstr("has no metric or property 'closed'")));
    EXPECT_THAT(steps("  - tetrahedralise:\n  - solid:\n    expect: {closed: 1, alpha: '< 2', bending: < 40 deg}\n"),
                ElementsAre(HasSubstr("expect closed: '1' is neither true nor false"),
                            HasSubstr("expect alpha: '2' has no unit")));
    EXPECT_THAT(steps("  - thin:\n    expect: {kept: [1, 2, 3]}\n"), ElementsAre(HasSubstr("a range has two ends")));
    EXPECT_THAT(steps("  - thin:\n    expect: {kept: [9, 1]}\n"), ElementsAre(HasSubstr("the lower end first")));
    EXPECT_THAT(steps("  - thin:\n    expect: {kept: 0.5}\n"), ElementsAre(HasSubstr("a count is never 0.5")));
    for (const char* other : {">=", "<=", "==", "!=", "=", "≥"})
        EXPECT_THAT(steps(std::string("  - thin:\n    expect: {kept: '") + other + " 3'}\n"),
                    ElementsAre(HasSubstr(std::string("expect kept: '") + other +
                                          "' is not supported; expected a value, `< value`, `> value`, or [low, high], "
                                          "which includes both ends")));
}

TEST_F(Check, OutputTemplates_AreCheckedBeforeTheRun) {
    const std::string head = "scanmill: 1\ninputs: {scan: points}\nsteps: [{thin: }, {tetrahedralise: }]\noutputs:\n";
    EXPECT_THAT(findings(head + "  '{scan}.ply': thin\n"), IsEmpty());
    EXPECT_THAT(findings(head + "  '{scna}.ply': thin\n"), ElementsAre(HasSubstr("did you mean 'scan'?")));
    EXPECT_THAT(findings(head + "  '{scan.ply': thin\n"), ElementsAre(HasSubstr("without its }")));
    EXPECT_THAT(findings(head + "  '/tmp/{scan}.ply': thin\n"), ElementsAre(HasSubstr("outside the output folder")));
    EXPECT_THAT(findings(head + "  'a/../../{scan}.ply': thin\n"), ElementsAre(HasSubstr("outside the output folder")));
    EXPECT_THAT(findings(head + "  '{scan}.stl': thin\n"),
                ElementsAre(AllOf(HasSubstr("no '.stl' file can hold"), HasSubstr("ply"))));
    EXPECT_THAT(findings(head + "  '{scan}.ply': tetrahedralise\n"), ElementsAre(HasSubstr("is tets")));
    EXPECT_THAT(findings(head + "  'a//b/../{scan}.ply': thin\n"), ElementsAre(HasSubstr("expected 'a/{scan}.ply'")));
    EXPECT_THAT(findings(head + "  '{scan}.ply': thin\n  '{scan}.ply/x/y.ply': thin\n"),
                ElementsAre(AllOf(StartsWith("w:5:3: "), HasSubstr("and also the folder of '{scan}.ply/x/y.ply'"))));
    EXPECT_THAT(findings(head + "  '{scan}.ply': thn\n"), ElementsAre(HasSubstr("did you mean 'thin'?")));
}

TEST_F(Check, OutputNamesLongerThanAnyFileSystemTakes_AreErrors) {
    const std::string head = "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - thin:\noutputs:\n";
    const auto findings_of = [&](std::size_t bytes) {
        return findings(head + "  'a/{scan}" + std::string(bytes - 4, 'x') + ".ply': thin\n");
    };
    EXPECT_THAT(findings_of(255), IsEmpty());
    EXPECT_THAT(findings_of(256), ElementsAre(HasSubstr("a file's name has 256 bytes; expected at most 255")));
}

TEST_F(Check, OutputThatIsAnothersFolder_IsAnError) {
    const std::string head = "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - thin:\noutputs:\n";
    EXPECT_THAT(findings(head + "  'a.ply': thin\n  'a.ply/b.ply': thin\n  'a.ply!.ply': thin\n"),
                ElementsAre(HasSubstr("'a.ply' is an output and also the folder of 'a.ply/b.ply'")));
}

TEST_F(Check, OutputWhereAnotherIsWrittenIfItFails_IsAnError) {
    const std::string head = "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - thin:\noutputs:\n";
    EXPECT_THAT(findings(head + "  'failed/{scan}.ply': thin\n  '{scan}.ply': thin\n"),
                ElementsAre(AllOf(StartsWith("w:6:3: "), HasSubstr("'failed/{scan}.ply' is where '{scan}.ply'"),
                                  HasSubstr("another folder"))));
    EXPECT_THAT(findings(head + "  'failed/{scan}.ply': thin\n  'failed/a/{scan}.ply': thin\n"), IsEmpty());
}

TEST_F(Check, VariantsThatWouldWriteOneFile_AskForVariantInTheName) {
    const std::string head =
        "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - thin: {count: {sweep: [1, 2]}}\noutputs:\n";
    EXPECT_THAT(findings(head + "  '{scan}.ply': thin\n"),
                ElementsAre(AllOf(StartsWith("w:6:3"), HasSubstr("put {variant} into the name"))));
    EXPECT_THAT(findings(head + "  '{scan}-{variant}.ply': thin\n"), IsEmpty());
    EXPECT_THAT(findings(head + "  'copy.ply': scan\n"), IsEmpty()) << "all variants share this value";
}

TEST_F(Check, UnusableModule_IsAnErrorOnlyForWorkflowsThatUseIt) {
    filters_.folder().write("scanmill-broken.json", "{");
    library_ = filters_.library();
    EXPECT_THAT(steps("  - thin:\n"), IsEmpty());
    EXPECT_THAT(steps("  - broken:\n"), ElementsAre(HasSubstr("the filter 'broken' cannot be used")));
}

}  // namespace
}  // namespace scanmill
