// SPDX-License-Identifier: GPL-3.0-or-later
// The JSON Schema of workflows, as an editor uses it: it accepts what check accepts, and rejects what check rejects at
// one place of the file.

#include "scanmill/describe/schemas.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/describe/schema_support.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/describe/schemas.hpp"
#include "scanmill/plan/plan.hpp"
#include "support/declared_filters.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill {
namespace {

using nlohmann::json;
using test::known_only;
using test::Schema;
using testing::HasSubstr;

class WorkflowSchema : public testing::Test {
protected:
    std::vector<std::string> errors_of_check(const std::string& workflow) {
        Diagnostics diagnostics("w");
        make_plan(parse_workflow(workflow, diagnostics), library_, {}, diagnostics);
        std::vector<std::string> errors;
        for (const Diagnostic& diagnostic : diagnostics.sorted()) errors.push_back(diagnostic.message);
        return errors;
    }

    test::DeclaredFilters filters_;
    FilterLibrary library_ = filters_.library();
    Schema schema_{workflow_schema(library_)};
};

std::string steps(const std::string& steps) { return "scanmill: 1\ninputs: {scan: points}\nsteps:\n" + steps; }
std::string with_n(const std::string& text) { return "parameters: {n: 3}\n" + steps(text); }

TEST_F(WorkflowSchema, WhatCheckAccepts_IsAccepted) {
    for (const std::string& workflow :
         {with_n("  - thin: {count: $n}\n"), with_n("  - thin: {size: 0.1 %diag, axis: [1, 0, 0], count: $n}\n"),
          with_n("  - thin: {size: +1e-3 mm, rule: random, count: $n}\n"), with_n("  - thin: {axis: [$n, 0, $n]}\n"),
          with_n("  - thin: {axis: {sweep: [[$n, 0, 1], [1, 0, 0]]}}\n"),
          with_n("  - thin: {count: {sweep: [1, $n, 9]}}\n    expect: {kept: '> 3', points: [1, 9]}\n"),
          with_n("  - thin:\n    expect: {kept: '> $n', points: [1, $n]}\n"),
          with_n("  - thin:\n    expect: {kept: $n}\n"),
          with_n("  - thin: {count: $n}\n  - tetrahedralise:\n  - solid: {alpha: auto, coverage: 0.5, angle: 0 deg}\n"
                 "    expect: {closed: true, alpha: < 3 %diag, bending: < 40 deg, volume: [-2 mm3, 3 cm³], skin: 2 "
                 "u^2}\n"),
          with_n("  - one-of:\n      - thin: {count: $n}\n      - id: b\n        thin:\n"
                 "      - name: twice\n        steps: [{thin: }, {id: again, thin: }]\n    id: any\n"),
          std::string("scanmill: 1\nname: w\nsummary: Nothing.\ninputs: {a: {kind: points, unit: mm, invalid: drop, "
                      "help: It.}, "
                      "b: [points]}\nsteps: [{combine: , in: {points: [a, b]}}]\n"
                      "outputs: {'{scan}.ply': combine}\n"),
          std::string("scanmill: 1\nsummary: 5\ninputs: {scan: points}\nparameters:\nsteps: [{thin: }]\noutputs:\n"),
          std::string(
              "scanmill: 1\ninputs: {scan: points}\nparameters: {s: {default: {sweep: [1 u, 2 u]}, help: It.}}\n"
              "steps: [{thin: {size: $s}, in: scan}]\n")}) {
        EXPECT_THAT(errors_of_check(workflow), testing::IsEmpty()) << workflow;
        EXPECT_EQ(schema_.complaints(workflow), "") << workflow;
    }
}

struct WorkflowMistake {
    std::string workflow;
    std::string schema;  ///< a part of the schema's errors: position and reason
    std::string check;  ///< a part of the only error of check
};

/// One mistake each, so that neither of the two can reject it for another reason.
const std::vector<WorkflowMistake> workflow_mistakes{
    {"inputs: {scan: points}\nsteps: [{thin: }]\n", ": Missing required property 'scanmill'", "has no grammar version"},
    {"scanmill: 2\ninputs: {scan: points}\nsteps: [{thin: }]\n", "scanmill: Failed to match expected value",
     "the grammar is '2'"},
    {"scanmill: 1\ninputs: {scan: points}\n", ": Missing required property 'steps'", "has no steps"},
    {"scanmill: 1\ninputs: {scan: points}\nsteps: []\n", "steps: Array should contain no fewer than 1",
     "the list of steps is empty"},
    {"scanmill: 1\ninputs: {scan: cloud}\nsteps: [{thin: }]\n", "inputs scan: Failed to match against any enum",
     "'cloud' is not a kind"},
    {"scanmill: 1\ninputs: {scan: {unit: mm}}\nsteps: [{thin: }]\n", "inputs scan: Missing required property 'kind'",
     "the input 'scan' has no kind"},
    {"scanmill: 1\ninputs: {scan: {kind: points, invalid: keep}}\nsteps: [{thin: }]\n",
     "inputs scan invalid: Failed to match against any enum", "expected drop or refuse"},
    {"scanmill: 1\ninputs: {scan: {kind: points, unit: yard}}\nsteps: [{thin: }]\n",
     "inputs scan unit: Failed to match against any enum", "'yard' is not a unit"},
    {"scanmill: 1\noutput: {}\ninputs: {scan: points}\nsteps: [{thin: }]\n",
     ": Object contains a property" + known_only + "'output'", "a workflow has no key 'output'"},
    {"scanmill: 1\nname: no name\ninputs: {scan: points}\nsteps: [{thin: }]\n", "name: Failed to match regex",
     "'no name' is not a name"},
    {steps("  - thinn:\n"), "steps 0: Object contains a property" + known_only + "'thinn'",
     "there is no filter 'thinn'"},
    {steps("  - thin: {siz: 1 u}\n"), "steps 0 thin: Object contains a property" + known_only + "'siz'",
     "thin has no parameter 'siz'"},
    {steps("  - thin: {size: 0.5}\n"), "steps 0 thin size: Value type not permitted", "size: '0.5' has no unit"},
    {steps("  - thin: {size: 0 mm}\n"), "steps 0 thin size: Failed to match regex", "size: 0 mm is out of range"},
    {steps("  - thin: {size: -1 mm}\n"), "steps 0 thin size: Failed to match regex", "size: -1 mm is out of range"},
    {steps("  - thin: {size: 1 yard}\n"), "steps 0 thin size: Failed to match regex", "'yard' is not a unit"},
    {steps("  - thin: {size: mm}\n"), "steps 0 thin size: Failed to match regex", "'mm' is not a length"},
    {steps("  - thin: {count: 0}\n"), "steps 0 thin count: Expected number greater than or equal to 1",
     "count: 0 is out of range"},
    {steps("  - thin: {count: 1.5}\n"), "steps 0 thin count: Value type not permitted", "'1.5' is not a whole number"},
    {steps("  - thin: {count: [1, 2]}\n"), "steps 0 thin count: Value type not permitted", "count: is a list"},
    {steps("  - thin: {rule: farthest}\n"), "steps 0 thin rule: Failed to match expected value",
     "'farthest' is not one of"},
    {steps("  - thin: {axis: [1, 2]}\n"), "steps 0 thin axis: Array should contain no fewer than 3",
     "axis: has 2 values"},
    {with_n("  - thin: {axis: [1, $n]}\n"), "steps 0 thin axis: Array should contain no fewer than 3",
     "axis: has 2 values"},
    {steps("  - thin: {axis: [1, $, 0]}\n"), "steps 0 thin axis: ", "'$' is not the name of a parameter"},
    {"parameters: {n: [1, $m]}\n" + steps("  - thin: {axis: $n}\n"), "parameters n: ", "cannot refer to a parameter"},
    {steps("  - thin: {axis: 1}\n"), "steps 0 thin axis: Value type not permitted", "axis: has 1 value"},
    {steps("  - thin: {count: {sweep: []}}\n"), "steps 0 thin count sweep: Array should contain no fewer than 1",
     "the sweep has no values"},
    {steps("  - thin: {count: {sweep: [0]}}\n"),
     "steps 0 thin count sweep 0: Expected number greater than or equal to 1", "count: 0 is out of range"},
    {steps("  - thin: {count: {swept: [1]}}\n"),
     "steps 0 thin count: Object contains a property" + known_only + "'swept'", "a value has no key 'swept'"},
    {steps("  - thin:\n  - tetrahedralise:\n  - solid: {coverage: 3}\n"),
     "steps 2 solid coverage: Expected number less than or equal to 1", "coverage: 3 is out of range"},
    {steps("  - thin:\n  - tetrahedralise:\n  - solid: {angle: 40}\n"), "steps 2 solid angle: Value type not permitted",
     "angle: '40' has no unit"},
    {steps("  - thin:\n  - tetrahedralise:\n  - solid: {alpha: automatic}\n"),
     "steps 2 solid alpha: Failed to match expected value", "alpha: 'automatic' is not a length"},
    {steps("  - thin:\n    inn: scan\n"), "steps 0: Object contains a property" + known_only + "'inn'",
     "found 'inn' beside 'thin'"},
    {steps("  - thin:\n    in: {mesh: scan}\n"), "steps 0 in: Object contains a property" + known_only + "'mesh'",
     "thin has no input port 'mesh'"},
    {steps("  - thin:\n    expect: {keptt: 1}\n"),
     "steps 0 expect: Object contains a property" + known_only + "'keptt'", "has no metric or property 'keptt'"},
    {steps("  - thin:\n    expect: {closed: true}\n"),
     "steps 0 expect: Object contains a property" + known_only + "'closed'", "has no metric or property 'closed'"},
    {steps("  - thin:\n    expect: {kept: [1, 2, 3]}\n"), "steps 0 expect kept: Array should contain no more than 2",
     "a range has two ends"},
    {steps("  - thin:\n  - tetrahedralise:\n  - solid:\n    expect: {volume: 12}\n"),
     "steps 2 expect volume: ", "expect volume: '12' has no unit"},
    {steps("  - thin:\n  - tetrahedralise:\n  - solid:\n    expect: {skin: 12 mm3}\n"),
     "steps 2 expect skin: ", "expect skin: '12 mm3' is not an area"},
    {steps("  - thin:\n    expect: {kept: '>= 1'}\n"), "steps 0 expect kept: Failed to match regex", "expect kept:"},
    {steps("  - thin:\n    tetrahedralise:\n"), "steps 0: Failed to validate against exactly one child schema",
     "found 'tetrahedralise' beside 'thin'"},
    {steps("  - id: a\n"), "steps 0: Missing required property 'thin'", "the step has no filter"},
    {steps("  - one-of: []\n"), "steps 0 one-of: Array should contain no fewer than 1", "one-of has no alternatives"},
    {steps("  - one-of: [{thin: }]\n    in: scan\n"), "steps 0: Object contains a property" + known_only + "'in'",
     "a one-of step has no key 'in'"},
    {steps("  - thin:\n  - tetrahedralise:\n  - solid:\n  - simplify:\n"), "steps 3 simplify: Value type not permitted",
     "simplify needs the parameter 'max-error'"},
};

TEST_F(WorkflowSchema, WhatIsWrongAtOnePlace_IsRejectedThere_AsByCheck) {
    for (const WorkflowMistake& mistake : workflow_mistakes) {
        EXPECT_THAT(errors_of_check(mistake.workflow), testing::ElementsAre(HasSubstr(mistake.check)))
            << mistake.workflow;
        EXPECT_THAT("\n" + schema_.complaints(mistake.workflow), HasSubstr("\n" + mistake.schema)) << mistake.workflow;
    }
}

/// The errors without those that only repeat an error below them.
std::vector<std::string> causes(const std::string& complaints) {
    std::vector<std::string> result;
    std::istringstream lines(complaints);
    for (std::string line; std::getline(lines, line);)
        if (line.find(": Failed to validate item #") == std::string::npos &&
            line.find(": Failed to validate against schema associated with property name") == std::string::npos &&
            line.find(": Failed to validate against additional properties schema") == std::string::npos &&
            line.find(": Failed to validate against a conditional schema set by") == std::string::npos &&
            line.find(": Failed to validate against child schema #") == std::string::npos)
            result.push_back(line);
    return result;
}

TEST_F(WorkflowSchema, OneWrongValue_IsTheOnlyPositionWithErrors) {
    for (const auto& [workflow, position] : std::vector<std::pair<std::string, std::string>>{
             {steps("  - thin: {count: many}\n"), "steps 0 thin count: "},
             {steps("  - thin: {size: 1 yard}\n"), "steps 0 thin size: "},
             {steps("  - thin: {axis: [1, x, 0]}\n"), "steps 0 thin axis 1: "},
             {steps("  - thin: {count: {sweep: [1, many]}}\n"), "steps 0 thin count sweep 1: "},
             {steps("  - thin: {counts: 1}\n"), "steps 0 thin: "},
             {steps("  - thin:\n    in: {points: 3}\n"), "steps 0 in points: "},
             {steps("  - thin:\n    expect: {kept: many}\n"), "steps 0 expect kept: "},
             {steps("  - one-of: [{thin: }, {thin: {count: many}}]\n"), "steps 0 one-of 1 thin count: "},
             {steps("  - one-of: [{name: a, steps: [{thin: {count: many}}]}]\n"),
              "steps 0 one-of 0 steps 0 thin count: "},
             {"scanmill: 1\ninputs: {scan: {kind: cloud}}\nsteps: [{thin: }]\n", "inputs scan kind: "},
             {"parameters: {n: {default: {swep: [1]}}}\n" + steps("  - thin: {count: $n}\n"),
              "parameters n default: "}})
        EXPECT_THAT(causes(schema_.complaints(workflow)),
                    testing::AllOf(testing::Not(testing::IsEmpty()), testing::Each(testing::StartsWith(position))))
            << workflow;
}

TEST_F(WorkflowSchema, ParametersAndMetrics_CarryTheirHelpRangeAndDefault) {
    const json document = json::parse(schema_.text());
    const json& thin = document["definitions"]["step"]["properties"]["thin"];
    EXPECT_EQ(thin["description"], "Does what its name says. (Hand-made for tests)");
    const std::string described = thin["properties"]["count"]["description"];
    EXPECT_EQ(described, "As its name says. Takes a whole number of at least 1 and at most 9. Default: 1.");
}

TEST_F(WorkflowSchema, EqualFilters_GiveEqualBytes) { EXPECT_EQ(workflow_schema(library_), schema_.text()); }

TEST(ShippedWorkflows, AreAcceptedByTheSchemaAndByCheck) {
    const FilterLibrary library({test::plugin_folder()});
    Schema schema(workflow_schema(library)), schema_of_batches(batch_schema(library));
    std::size_t found = 0;
    for (const auto& file : std::filesystem::directory_iterator(test::source_folder() + "/workflows")) {
        if (file.path().extension() != ".yaml") continue;
        ++found;
        const std::string workflow = test::content_of(file.path());
        EXPECT_EQ((is_batch(workflow) ? schema_of_batches : schema).complaints(workflow), "") << file.path();
        Diagnostics diagnostics(file.path().string());
        if (is_batch(workflow)) {  // whose scans have to be fetched; all else must be right
            parse_batch(workflow, diagnostics);
            for (const Diagnostic& found_wrong : diagnostics.sorted())
                EXPECT_THAT(found_wrong.message, testing::HasSubstr("no file")) << file.path();
            continue;
        }
        make_plan(parse_workflow(workflow, diagnostics), library, {}, diagnostics);
        EXPECT_THAT(diagnostics.sorted(), testing::IsEmpty()) << file.path();
    }
    EXPECT_GE(found, 1u);
}

}  // namespace
}  // namespace scanmill
