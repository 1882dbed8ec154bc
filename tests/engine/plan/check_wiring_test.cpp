// SPDX-License-Identifier: GPL-3.0-or-later
// The source of every port is found before any scan is opened, and so are wrong ones.

#include "engine/plan/workflow_findings.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class CheckWiring : public test::WorkflowFindings {};

TEST_F(CheckWiring, PortWithoutAnyValue_NamesTheFiltersThatGiveOne) {
    EXPECT_THAT(steps("  - solid:\n"),
                ElementsAre(AllOf(StartsWith("w:4:5: "), HasSubstr("solid needs tets for its port 'tets'"),
                                  HasSubstr("'tetrahedralise'"))));
}

TEST_F(CheckWiring, AfterAnUnknownFilter_MissingValuesAreNotBlamedOnTheNextStep) {
    EXPECT_THAT(steps("  - tetrahedralize:\n  - solid:\n"), ElementsAre(HasSubstr("no filter 'tetrahedralize'")));
}

TEST_F(CheckWiring, TwoCandidatesInTheNearestStep_AskForIn) {
    EXPECT_THAT(steps("  - pair:\n  - thin:\n"),
                ElementsAre(AllOf(StartsWith("w:5:5: "), HasSubstr("left and right"), HasSubstr("`in: {points: …}`"))));
    EXPECT_THAT(steps("  - pair:\n  - thin:\n    in: {points: pair.right}\n"), IsEmpty());
    EXPECT_THAT(steps("  - pair:\n  - thin:\n    in: pair.right\n"), IsEmpty());
}

TEST_F(CheckWiring, TwoInputsOfOneKind_AskForIn) {
    EXPECT_THAT(findings("scanmill: 1\ninputs: {a: points, b: points}\nsteps:\n  - thin:\n"),
                ElementsAre(AllOf(StartsWith("w:4:5: "), HasSubstr("inputs a and b"))));
}

TEST_F(CheckWiring, FilterWithTwoPortsOfOneKind_AsksForBoth) {
    const std::string head = "scanmill: 1\ninputs: {a: points, b: points}\nsteps:\n  - register:\n";
    EXPECT_THAT(findings(head), ElementsAre(HasSubstr("in: {source: …}"), HasSubstr("in: {target: …}")));
    EXPECT_THAT(findings(head + "    in: {source: a, target: b}\n"), IsEmpty());
}

TEST_F(CheckWiring, UnknownSourceOrPort_ProposesTheClosest) {
    EXPECT_THAT(steps("  - thin:\n    in: {points: scam}\n"), ElementsAre(HasSubstr("did you mean 'scan'?")));
    EXPECT_THAT(steps("  - thin:\n    in: {point: scan}\n"), ElementsAre(HasSubstr("did you mean 'points'?")));
    EXPECT_THAT(steps("  - pair:\n  - thin:\n    in: {points: pair.lfet}\n"),
                ElementsAre(HasSubstr("did you mean 'left'?")));
}

TEST_F(CheckWiring, LaterStepAsSource_IsNoEarlierStep) {
    EXPECT_THAT(steps("  - thin:\n    in: {points: later}\n  - id: later\n    pair:\n"),
                ElementsAre(HasSubstr("'later' is neither an earlier step nor an input")));
}

TEST_F(CheckWiring, NameOfTwoSteps_StandsForNone) {
    EXPECT_THAT(steps("  - thin: {size: 1 u}\n  - thin: {size: 2 u}\n  - pair:\n    in: {points: thin}\n"),
                ElementsAre(HasSubstr("'thin' is the name of several steps; give one of them an `id`")));
}

TEST_F(CheckWiring, SeveralValuesForASinglePort_AreAnError) {
    EXPECT_THAT(steps("  - thin:\n    in: {points: [scan, scan]}\n"),
                ElementsAre(HasSubstr("takes one value; found 2")));
    EXPECT_THAT(steps("  - pair:\n  - combine:\n    in: {points: [pair.left, pair.right, scan]}\n"), IsEmpty());
}

TEST_F(CheckWiring, ListInput_FeedsOnlyListPorts) {
    const std::string head = "scanmill: 1\ninputs: {scan: points, others: [points]}\nsteps:\n";
    EXPECT_THAT(findings(head + "  - thin:\n"), IsEmpty());
    EXPECT_THAT(findings(head + "  - thin:\n    in: {points: others}\n"),
                ElementsAre(HasSubstr("is a list of points")));
    EXPECT_THAT(findings(head + "  - combine:\n    in: {points: others}\n"), IsEmpty());
    EXPECT_THAT(findings("scanmill: 1\ninputs: {scans: [points]}\nsteps:\n  - combine:\n"), IsEmpty());
    EXPECT_THAT(findings("scanmill: 1\ninputs: {scans: [points]}\nsteps:\n  - combine:\noutputs: {x.ply: scans}\n"),
                ElementsAre(AllOf(StartsWith("w:5:"), HasSubstr("'scans' is a list; a file holds one value"))));
    EXPECT_THAT(findings("scanmill: 1\ninputs: {s: {kind: points, frame: '{scan}'}}\nsteps:\n  - thin:\n"),
                ElementsAre(AllOf(StartsWith("w:2:"), HasSubstr("unknown placeholder"))));
}

/// With a filter `draw`: scene (mesh, points or features), scale: metrics? → picture.
class DrawingWiring : public test::WorkflowFindings {
protected:
    DrawingWiring() {
        filters_.add(test::drawing_filter("draw"));
        FilterSpec list = test::drawing_filter("named");
        list.draws.reset();
        list.outputs.front() = {"mesh", kind_of<TriangleMesh>(), "All triangles.", false, false};
        list.outputs.front().by_name = true;
        filters_.add(list);
        library_ = filters_.library();
    }
    /// The source of the scene in the last step.
    std::string drawn() const { return describe(plan_, plan_.steps.back().inputs.front().sources.front()); }
};

TEST_F(DrawingWiring, WithoutIn_TheLastGeometricValueIsDrawn) {
    EXPECT_THAT(steps("  - tetrahedralise:\n  - solid:\n  - draw:\n"), IsEmpty());
    EXPECT_EQ(drawn(), "solid");
    EXPECT_THAT(steps("  - thin:\n  - tetrahedralise:\n  - draw:\n"), IsEmpty()) << "tets are not drawn";
    EXPECT_EQ(drawn(), "thin");
    EXPECT_THAT(steps("  - pair:\n  - register:\n    in: {source: pair.left, target: pair.right}\n  - draw:\n"),
                IsEmpty())
        << "a transform is not geometric, and the first of two outputs is drawn";
    EXPECT_EQ(drawn(), "pair");
}

TEST_F(DrawingWiring, WithoutAnEarlierValue_TheFirstInputThatFitsIsDrawn) {
    EXPECT_THAT(steps("  - tetrahedralise:\n  - draw:\n"), IsEmpty());
    EXPECT_EQ(drawn(), "scan");
    EXPECT_THAT(findings("scanmill: 1\ninputs: {m: metrics, l: [points], a: points, b: mesh}\nsteps:\n  - draw:\n"),
                IsEmpty())
        << "neither two inputs of different kinds nor lists are a question";
    EXPECT_EQ(drawn(), "a");
}

TEST_F(DrawingWiring, OtherOutputsAndValuesByName_AreNotDrawn) {
    EXPECT_THAT(steps("  - thin:\n  - named:\n    in: {scene: thin}\n  - draw:\n"), IsEmpty());
    EXPECT_EQ(drawn(), "thin");
}

TEST_F(DrawingWiring, In_SelectsAnyValueThatFits) {
    EXPECT_THAT(steps("  - pair:\n  - thin:\n    in: {points: scan}\n  - draw:\n    in: {scene: pair.right}\n"),
                IsEmpty());
    EXPECT_EQ(drawn(), "pair.right");
    EXPECT_THAT(
        steps("  - tetrahedralise:\n  - draw:\n    in: {scene: tetrahedralise}\n"),
        ElementsAre(HasSubstr("'tetrahedralise' is tets; the port 'scene' of draw takes mesh or points or features")));
}

TEST_F(DrawingWiring, NothingToDraw_IsAnErrorThatNamesTheKinds) {
    EXPECT_THAT(findings("scanmill: 1\ninputs: {m: metrics}\nsteps:\n  - draw:\n"),
                ElementsAre(AllOf(StartsWith("w:4:5: "), HasSubstr("draw draws mesh or points or features"),
                                  HasSubstr("`in: {scene: …}`"))));
    EXPECT_THAT(findings("scanmill: 1\ninputs: {m: metrics}\nsteps:\n  - thim:\n  - draw:\n"),
                ElementsAre(HasSubstr("no filter 'thim'")))
        << "the unknown step may make the value";
}

}  // namespace
}  // namespace scanmill
