// SPDX-License-Identifier: GPL-3.0-or-later
// `$name` among the items of a list: its value, where it is allowed, and the position of errors.

#include <gmock/gmock.h>

#include "engine/batch/batch_support.hpp"
#include "engine/run/run_fixture.hpp"
#include "scanmill/filter/declare.hpp"
#include "scanmill/plan/plan.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

struct ListParams {
    std::vector<Length> thresholds;
    std::vector<std::filesystem::path> files;
    std::vector<std::string> names;
};

class ListValues : public test::Batches {
protected:
    ListValues() {
        filters_.add(Declare<ListParams>("lists", 1)
                         .summary("Takes lists.")
                         .source("Hand-made for tests")
                         .ties("There are none.")
                         .not_finite("Nothing is asked.")
                         .in<PointCloud>("points", "As its name says.")
                         .out<PointCloud>("points", "As its name says.")
                         .param("thresholds", &ListParams::thresholds, "As its name says.", above(0))
                         .param("files", &ListParams::files, "As its name says.")
                         .param("names", &ListParams::names, "As its name says.")
                         .
                         operator FilterDeclaration()
                         .spec);
        library_ = filters_.library();
    }
    /// The workflow's findings; its one step, in line 4, has the parameters in braces.
    std::vector<std::string> check_step(const std::string& parameters, const std::string& values,
                                        const Settings& settings = {}) {
        Diagnostics diagnostics("f/w");
        plan_ = make_plan(parse_workflow("scanmill: 1\ninputs: {scan: points}\nparameters: {" + parameters +
                                             "}\nsteps: [{lists: {" + values + "}}]\n",
                                         diagnostics),
                          library_, settings, diagnostics);
        std::vector<std::string> texts;
        for (const Diagnostic& diagnostic : diagnostics.sorted()) texts.push_back(text(diagnostic, "w"));
        return texts;
    }
    /// What the step got in every variant, behind the variant's name.
    std::vector<std::string> values_of(const std::string& parameter) const {
        std::vector<std::string> texts;
        for (const PlannedVariant& variant : plan_.variants)
            texts.push_back(variant.name + ": " + text(*plan_.steps[variant.steps[0]].parameters.find(parameter)));
        return texts;
    }
    static Settings set(const std::string& name, const std::string& value) {
        Diagnostics diagnostics("--set");
        return {{name, parse_value_expression(value, diagnostics)}};
    }

    Plan plan_;
};

TEST_F(ListValues, Name_IsReplacedAmongTheItems) {
    EXPECT_THAT(check_step("a: 1 u, b: 2 spacing", "thresholds: [$a, 3 %diag, $b, $a]"), IsEmpty());
    EXPECT_THAT(values_of("thresholds"), ElementsAre("default: [1 u, 3 %diag, 2 spacing, 1 u]"));
    EXPECT_THAT(check_step("a: 1 u", "thresholds: [$a]", set("a", "5 u")), IsEmpty());
    EXPECT_THAT(values_of("thresholds"), ElementsAre("default: [5 u]"));
}

TEST_F(ListValues, TwoDollars_AreATextThatBeginsWithOne) {
    EXPECT_THAT(check_step("a: x", "names: [$$a, $a, a$a, '$$$a']"), IsEmpty());
    EXPECT_THAT(values_of("names"), ElementsAre("default: [$a, x, a$a, $$a]"));
}

TEST_F(ListValues, SweptName_SpansVariantsOnceAndNamesThem) {
    EXPECT_THAT(check_step("a: {sweep: [1 u, 2 u]}", "thresholds: [$a, 9 u, $a]"), IsEmpty());
    EXPECT_THAT(values_of("thresholds"), ElementsAre("a=1u: [1 u, 9 u, 1 u]", "a=2u: [2 u, 9 u, 2 u]"));
}

TEST_F(ListValues, SweepOverListsWithNames_NamesVariantsByTheirValues) {
    EXPECT_THAT(check_step("a: 1 u", "thresholds: {sweep: [[$a, 5 u], [6 u]]}"), IsEmpty());
    EXPECT_THAT(values_of("thresholds"), ElementsAre("thresholds=1u_5u: [1 u, 5 u]", "thresholds=6u: [6 u]"));
    EXPECT_THAT(check_step("a: {sweep: [1 u, 2 u]}", "thresholds: {sweep: [[$a, 5 u], [$a]]}"), IsEmpty());
    EXPECT_THAT(values_of("thresholds"),
                ElementsAre("a=1u+thresholds=1u_5u: [1 u, 5 u]", "a=2u+thresholds=2u_5u: [2 u, 5 u]",
                            "a=1u+thresholds=1u: [1 u]", "a=2u+thresholds=2u: [2 u]"));
}

TEST_F(ListValues, UnknownName_IsReportedAtItsPositionAndIsAUse) {
    EXPECT_THAT(check_step("size: 1 u", "thresholds: [1 u, $siz, $size, $so]"),
                ElementsAre(AllOf(StartsWith("w:4:36: "), HasSubstr("no parameter 'siz'"), HasSubstr("mean 'size'?")),
                            AllOf(StartsWith("w:4:49: "), HasSubstr("no parameter 'so'"))));
    EXPECT_THAT(check_step("size: 1 u", "thresholds: [1 u, $, {sweep: [1 u]}]"),
                ElementsAre(HasSubstr("no step uses the parameter 'size'"),
                            AllOf(StartsWith("w:4:36: "), HasSubstr("'$' is not the name of a parameter")),
                            AllOf(StartsWith("w:4:39: "), HasSubstr("found a map; expected a value or $name"))));
}

TEST_F(ListValues, NameBesideWhatCannotBeRead_IsUsed) {
    EXPECT_THAT(check_step("size: 1 u", "thresholds: [$size, $]"),
                ElementsAre(HasSubstr("'$' is not the name of a parameter")));
    EXPECT_THAT(check_step("size: 1 u", "thresholds: [{sweep: [1 u]}, $size]"),
                ElementsAre(HasSubstr("found a map; expected a value or $name")));
    EXPECT_THAT(check_step("size: 1 u", "thresholds: {sweep: [[$size, [1 u]]]}"),
                ElementsAre(HasSubstr("found a list; expected a value or $name")));
    EXPECT_THAT(check_step("size: 1 u", "thresholds: {sweep: $size}"), ElementsAre(HasSubstr("a list of values")));
    EXPECT_THAT(check_step("size: 1 u", "thresholds: [1 u, $$size]"),
                ElementsAre(HasSubstr("no step uses the parameter 'size'"), HasSubstr("'$size'")))
        << "a text that begins with a dollar";
}

TEST_F(ListValues, ValueThatIsNotAnItem_IsReportedAtTheName) {
    EXPECT_THAT(check_step("a: 1 yard, b: 1 u", "thresholds: [$b, $a]"),
                ElementsAre(AllOf(StartsWith("w:4:35: "), HasSubstr("thresholds (from $a): 'yard' is not a unit"))));
    EXPECT_THAT(check_step("a: 0 u", "thresholds: [$a]"),
                ElementsAre(AllOf(StartsWith("w:4:31: "), HasSubstr("thresholds (from $a): 0 u is out of range"))));
    EXPECT_THAT(check_step("a: 1 u", "thresholds: [$a, 5]"),
                ElementsAre(AllOf(StartsWith("w:4:30: "), HasSubstr("thresholds: '5' has no unit"))));
}

TEST_F(ListValues, ListWithinAList_IsRefusedAtItsPlace) {
    const std::string sentence =
        "$a is a list, which cannot be part of a list; expected a single value, or the whole list as `thresholds: "
        "$a`";
    EXPECT_THAT(check_step("a: [1 u, 2 u]", "thresholds: [3 u, $a]"), ElementsAre("w:4:36: " + sentence));
    EXPECT_THAT(check_step("a: 1 u", "thresholds: [3 u, $a]", set("a", "[1 u]")), ElementsAre("w:4:36: " + sentence));
    EXPECT_THAT(check_step("a: [1 u, 2 u]", "thresholds: $a"), IsEmpty());
    EXPECT_THAT(values_of("thresholds"), ElementsAre("default: [1 u, 2 u]"));
}

TEST_F(ListValues, DefaultsAndSettings_CannotReferFromWithinAList) {
    EXPECT_THAT(check_step("a: 1 u, b: [2 u, $a]", "thresholds: $b"),
                ElementsAre(AllOf(StartsWith("w:3:31: "), HasSubstr("cannot refer to a parameter"))));
    EXPECT_THAT(rest("set: {s: [1 u, $n]}\n"), ElementsAre(AllOf(StartsWith("b:5:16: "), HasSubstr("cannot refer"))));
}

TEST_F(ListValues, ValueOfABatch_IsReportedAtItsPositionThere) {
    folder_.write("w.yaml",
                  "scanmill: 1\ninputs: {scan: points}\nparameters: {n: 1 u}\nsteps: [{lists: {thresholds: [2 u, $n]}}]"
                  "\n");
    EXPECT_THAT(check(head + "set: {n: 3 yard}\n"),
                ElementsAre(AllOf(StartsWith("b:5:10: $n is one of the thresholds of lists: 'yard' is not a unit"))));
}

TEST_F(ListValues, Paths_CountFromTheFileThatEachStandsIn) {
    EXPECT_THAT(check_step("p: x.txt, q: z.txt", "files: [$p, y.txt, $q, /r]", set("p", "outside.txt")), IsEmpty());
    EXPECT_THAT(values_of("files"), ElementsAre("default: [outside.txt, f/y.txt, f/z.txt, /r]"));
}

}  // namespace
}  // namespace scanmill
