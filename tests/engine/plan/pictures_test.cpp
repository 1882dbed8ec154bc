// SPDX-License-Identifier: GPL-3.0-or-later
// The step and the output that make_plan_with_picture() adds.

#include "scanmill/plan/pictures.hpp"

#include "engine/plan/workflow_findings.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Pictures : public testing::Test {
protected:
    Pictures() { filters_.add(test::drawing_filter("draw")); }

    /// The findings of a workflow of these steps and outputs.
    std::vector<std::string> with_picture(const std::string& steps, const std::string& outputs,
                                          const std::string& inputs = "{scan: points}") {
        const FilterLibrary library = filters_.library();
        Diagnostics diagnostics("w");
        Workflow workflow = parse_workflow(
            "scanmill: 1\ninputs: " + inputs + "\nsteps:\n" + steps + "outputs: {" + outputs + "}\n", diagnostics);
        plan_ = make_plan_with_picture(std::move(workflow), library, {}, diagnostics);
        std::vector<std::string> texts;
        for (const Diagnostic& diagnostic : diagnostics.sorted()) texts.push_back(text(diagnostic, "w"));
        return texts;
    }
    /// "file <- step <- drawn value" for every picture of a variant.
    std::vector<std::string> pictures(std::size_t variant = 0) const {
        std::vector<std::string> found;
        for (const PlannedOutput& output : plan_.variants.at(variant).outputs) {
            if (kind_of(plan_, output.source) != kind_of<Picture>()) continue;
            const PlannedStep& step = plan_.steps[*output.source.step];
            found.push_back(output.file + " <- " + step.label + " <- " +
                            describe(plan_, step.inputs.front().sources.front()));
        }
        return found;
    }

    test::DeclaredFilters filters_;
    Plan plan_;
};

const std::string solid = "  - thin:\n  - tetrahedralise:\n  - solid:\n";

TEST_F(Pictures, Surface_IsDrawnBesideItsOutput) {
    EXPECT_THAT(with_picture(solid, "'sub/{scan}.{variant}.stl': solid"), IsEmpty());
    EXPECT_THAT(pictures(), ElementsAre("sub/{scan}.{variant}.png <- picture-solid <- solid"));
    EXPECT_EQ(plan_.steps.size(), 4u);
}

TEST_F(Pictures, LastSurface_IsDrawnEvenIfPointsFollow) {
    EXPECT_THAT(with_picture(solid + "  - simplify: {max-error: 1 u}\n",
                             "'{scan}.stl': solid, '{scan}-small.stl': simplify, '{scan}.ply': thin"),
                IsEmpty());
    EXPECT_THAT(pictures(), ElementsAre("{scan}-small.png <- picture-simplify <- simplify"));
}

TEST_F(Pictures, WithoutASurface_TheLastOtherValueIsDrawn) {
    EXPECT_THAT(with_picture("  - thin:\n  - pair:\n", "'a.ply': thin, '{scan}.ply': pair.right"), IsEmpty());
    EXPECT_THAT(pictures(), ElementsAre("{scan}.png <- picture-pair-right <- pair.right"));
}

TEST_F(Pictures, InputThatIsAnOutput_IsDrawn) {
    EXPECT_THAT(with_picture("  - thin:\n", "'{scan}.ply': scan"), IsEmpty());
    EXPECT_THAT(pictures(), ElementsAre("{scan}.png <- picture-scan <- scan"));
}

TEST_F(Pictures, NamesThatAreTaken_GetOtherOnes) {
    EXPECT_THAT(
        with_picture(solid + "  - id: picture-solid\n    draw:\n", "'{scan}.stl': solid, '{scan}.png': picture-solid"),
        IsEmpty());
    EXPECT_THAT(pictures(),
                ElementsAre("{scan}.png <- picture-solid <- solid", "{scan}-picture.png <- picture-solid <- solid"))
        << "an equal step is not run twice";
    EXPECT_TRUE(plan_.variants[0].steps_by_name.contains("picture-solid-2"));
    EXPECT_EQ(plan_.steps.size(), 4u);
}

TEST_F(Pictures, VariantWithoutADrawableValue_HasNone) {
    FilterSpec edges = test::drawing_filter("edges");
    edges.draws.reset();
    edges.outputs.front() = {"features", kind_of<FeatureGraph>(), "All edges.", false, false};
    filters_.add(edges);
    EXPECT_THAT(with_picture("  - id: last\n    one-of:\n      - edges:\n        in: {scene: scan}\n      - register:\n"
                             "        in: {source: scan, target: scan}\n",
                             "'{scan}.{variant}.json': last"),
                IsEmpty());
    EXPECT_THAT(pictures(0), ElementsAre("{scan}.{variant}.png <- picture-last <- edges"));
    EXPECT_THAT(pictures(1), IsEmpty());
    EXPECT_EQ(plan_.variants[1].steps.size(), 1u);
}

TEST_F(Pictures, WorkflowWithoutADrawableOutput_IsAnError) {
    const std::string steps = "  - register:\n    in: {source: scan, target: scan}\n";
    EXPECT_THAT(with_picture(steps, "'{scan}.json': register"),
                ElementsAre(AllOf(HasSubstr("has no output for a picture"), HasSubstr("mesh or points or features"))));
    EXPECT_THAT(with_picture(solid, ""), ElementsAre(HasSubstr("has no output for a picture")));
}

TEST_F(Pictures, ErrorsOfTheWorkflow_AreReportedOnce) {
    EXPECT_THAT(with_picture("  - thim:\n", "'{scan}.ply': thim"), ElementsAre(HasSubstr("no filter 'thim'")));
}

TEST_F(Pictures, SeveralDrawingFilters_AreAnErrorThatNamesThem) {
    filters_.add(test::drawing_filter("sketch"));
    EXPECT_THAT(with_picture(solid, "'{scan}.stl': solid"), ElementsAre(HasSubstr("draw and sketch draw pictures")));
}

TEST_F(Pictures, DrawingFilterThatNeedsMore_IsNotChosen) {
    FilterSpec more = test::drawing_filter("sketch");
    more.inputs.back().optional = false;
    filters_.add(more);
    EXPECT_THAT(drawing_filters(filters_.library()), ElementsAre("draw"));
    EXPECT_THAT(with_picture(solid, "'{scan}.stl': solid"), IsEmpty());
}

TEST(PicturesWithoutADrawingFilter, AreAnError) {
    const test::DeclaredFilters filters;
    const FilterLibrary library = filters.library();
    Diagnostics diagnostics("w");
    Workflow workflow = parse_workflow(
        "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - thin:\noutputs: {'a.ply': thin}\n", diagnostics);
    make_plan_with_picture(std::move(workflow), library, {}, diagnostics);
    ASSERT_EQ(diagnostics.errors(), 1u);
    EXPECT_THAT(diagnostics.sorted().front().message, HasSubstr("no installed filter draws pictures"));
}

}  // namespace
}  // namespace scanmill
