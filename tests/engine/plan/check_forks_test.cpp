// SPDX-License-Identifier: GPL-3.0-or-later
// One mistake hides no other: not in forks that cannot be read, and not in workflows of too many variants.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scanmill/plan/plan.hpp"
#include "support/declared_filters.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class CheckForks : public testing::Test {
protected:
    /// The errors of a workflow with these steps (each line as in the file, from line 4 on).
    std::vector<std::string> findings(const std::string& lines) {
        Diagnostics diagnostics("w");
        plan_ = make_plan(parse_workflow("scanmill: 1\ninputs: {scan: points}\nsteps:\n" + lines, diagnostics),
                          library_, {}, diagnostics);
        std::vector<std::string> texts;
        for (const Diagnostic& diagnostic : diagnostics.sorted()) texts.push_back(text(diagnostic, "w"));
        return texts;
    }

    test::DeclaredFilters filters_;
    FilterLibrary library_ = filters_.library();
    Plan plan_;
};

TEST_F(CheckForks, UnknownWorkflowParameter_HidesNothingBehindIt) {
    EXPECT_THAT(findings("  - thin: {size: $nope}\n  - thinn:\n  - simplify: {max-error: 5}\n"),
                ElementsAre(AllOf(StartsWith("w:4:18: "), HasSubstr("no parameter 'nope'")),
                            AllOf(StartsWith("w:5:5: "), HasSubstr("no filter 'thinn'")),
                            AllOf(StartsWith("w:6:27: "), HasSubstr("'5' has no unit"))));
}

TEST_F(CheckForks, RequiredParameterByUnknownName_IsNotReportedAsMissingToo) {
    EXPECT_THAT(findings("  - tetrahedralise:\n  - solid:\n  - simplify: {max-error: $nope}\n"),
                ElementsAre(HasSubstr("no parameter 'nope'")));
}

TEST_F(CheckForks, EmptyFork_HidesNothingBehindItAndMayHaveGivenWhatIsMissing) {
    EXPECT_THAT(findings("  - one-of: []\n  - solid: {coverage: 300 %}\n"),
                ElementsAre(AllOf(StartsWith("w:4:5: "), HasSubstr("no alternatives")),
                            AllOf(StartsWith("w:5:23: "), HasSubstr("out of range"))));
}

TEST_F(CheckForks, AlternativesThatCannotBeRead_AreTheOnlyOnesReported) {
    EXPECT_THAT(findings("  - one-of:\n      - 5\n      - [x]\n      - {steps: []}\n  - solid:\n"),
                ElementsAre(AllOf(StartsWith("w:5:9: "), HasSubstr("found '5'")),
                            AllOf(StartsWith("w:6:10: "), HasSubstr("found 'x'")),
                            AllOf(StartsWith("w:7:17: "), HasSubstr("the list of steps is empty"))));
}

TEST_F(CheckForks, TooManyVariants_AreStillCheckedInEveryAlternative) {
    std::string lines;
    for (int i = 0; i < 30; ++i)
        lines += "  - one-of: [{id: a" + std::to_string(i) + ", thin: }, {id: b" + std::to_string(i) +
                 ", thin: " + (i == 17 ? "{siz: 1 u}" : "") + "}]\n";
    lines += "  - thin: {count: {sweep: [1, 2, 30]}}\n";
    EXPECT_THAT(findings(lines), ElementsAre(AllOf(StartsWith("w: "), HasSubstr("more than 10000 variants")),
                                             AllOf(StartsWith("w:21:"), HasSubstr("did you mean 'size'?")),
                                             AllOf(StartsWith("w:34:"), HasSubstr("30 is out of range"))));
}

TEST_F(CheckForks, ForksWithinForksOfTooManyVariants_AreCheckedInEveryAlternative) {
    std::string lines =
        "  - one-of:\n      - thin:\n      - name: two\n        steps:\n"
        "          - one-of: [{id: bad, no-such-filter: }, {id: good, thin: }]\n";
    for (int i = 0; i < 14; ++i) lines += "  - id: s" + std::to_string(i) + "\n    thin: {count: {sweep: [1, 2]}}\n";
    EXPECT_THAT(findings(lines), Contains(HasSubstr("no filter 'no-such-filter'")));
}

TEST_F(CheckForks, DefaultThatIsAReference_IsAnErrorAndNotUsed) {
    Diagnostics diagnostics("w");
    make_plan(parse_workflow("scanmill: 1\ninputs: {scan: points}\nparameters: {b: $b}\n"
                             "steps: [{thin: {size: $b}}]\n",
                             diagnostics),
              library_, {}, diagnostics);
    ASSERT_EQ(diagnostics.errors(), 1u);
    EXPECT_THAT(diagnostics.sorted().front().message, HasSubstr("cannot refer to a parameter"));
}

TEST_F(CheckForks, TenThousandVariants_AreNotTooMany) {
    std::string sweep;
    for (int i = 1; i <= 100; ++i) sweep += (i > 1 ? ", " : "") + std::to_string(i) + " u";
    const std::string first = "  - thin: {size: {sweep: [" + sweep + "]}}\n";
    const std::string second = "  - id: b\n    thin: {size: {sweep: [" + sweep;
    EXPECT_THAT(findings(first + second + "]}}\n"), testing::IsEmpty());
    EXPECT_EQ(plan_.variants.size(), 10'000u);
    EXPECT_THAT(findings(first + second + ", 101 u]}}\n"), ElementsAre(HasSubstr("more than 10000 variants")));
}

TEST_F(CheckForks, FewVariantsOfTooManySteps_AreRefusedBeforeTheirMemoryIsTaken) {
    std::string lines = "  - thin: {count: {sweep: [1, 2, 3, 4, 5, 6, 7, 8, 9]}}\n";
    lines += "  - {id: b, thin: {count: {sweep: [1, 2, 3, 4, 5, 6, 7, 8, 9]}}}\n";
    for (int i = 0; i < 6300; ++i) lines += "  - {id: s" + std::to_string(i) + ", thin: }\n";
    EXPECT_THAT(findings(lines), ElementsAre(HasSubstr("more than 500000 steps in all its variants")));
    EXPECT_LE(plan_.variants.size(), 9u) << "each swept value once";
}

TEST_F(CheckForks, ThousandsOfSteps_AreOneAfterTheOther) {
    std::string lines;
    for (int i = 0; i < 5000; ++i) lines += "  - id: s" + std::to_string(i) + "\n    thin:\n";
    EXPECT_THAT(findings(lines), testing::IsEmpty());
    EXPECT_EQ(plan_.steps.size(), 5000u);
}

TEST_F(CheckForks, SweepOverAParameterAndAValue_NamesEveryVariant) {
    Diagnostics diagnostics("w");
    const Plan plan = make_plan(parse_workflow("scanmill: 1\ninputs: {scan: points}\nparameters: {n: {sweep: [1, 2]}}\n"
                                               "steps:\n  - thin: {count: $n}\n"
                                               "  - id: b\n    thin: {count: {sweep: [$n, 9]}}\n",
                                               diagnostics),
                                library_, {}, diagnostics);
    EXPECT_FALSE(diagnostics.has_errors());
    std::vector<std::string> names;
    for (const PlannedVariant& variant : plan.variants) names.push_back(variant.name);
    EXPECT_THAT(names, ElementsAre("n=1+count=1", "n=1+count=9", "n=2+count=2", "n=2+count=9"));
}

}  // namespace
}  // namespace scanmill
