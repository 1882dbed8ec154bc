// SPDX-License-Identifier: GPL-3.0-or-later
// The JSON Schema of workflows, as an editor uses it: it accepts what check accepts, and rejects what check rejects at
// one place of the file.

#include "scanmill/engine/workflow_schema.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "scanmill/engine/plan.hpp"
#include "support/declared_filters.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill {
namespace {

using nlohmann::json;

/// YAML as editors see it: plain scalars are numbers, booleans and null where they look like it.
json to_json(const YAML::Node& node) {
    if (node.IsSequence()) {
        json list = json::array();
        for (const YAML::Node& item : node) list.push_back(to_json(item));
        return list;
    }
    if (node.IsMap()) {
        json map = json::object();
        for (const auto& entry : node) map[entry.first.Scalar()] = to_json(entry.second);
        return map;
    }
    if (node.IsNull() || !node.IsDefined()) return nullptr;
    const std::string& text = node.Scalar();
    if (node.Tag() == "!") return text;  // it stood in quotes
    if (text == "true" || text == "false") return text == "true";
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return text;
    if (number == static_cast<double>(static_cast<std::int64_t>(number)) && text.find('.') == std::string::npos)
        return static_cast<std::int64_t>(number);
    return number;
}

class Schema {
public:
    explicit Schema(const FilterLibrary& library) : text_(workflow_schema(library)) {
        const json document = json::parse(text_);
        valijson::SchemaParser(valijson::SchemaParser::kDraft7)
            .populateSchema(valijson::adapters::NlohmannJsonAdapter(document), schema_);
    }
    bool accepts(const std::string& workflow) {
        const json document = to_json(YAML::Load(workflow));
        return valijson::Validator(valijson::Validator::kStrongTypes)
            .validate(schema_, valijson::adapters::NlohmannJsonAdapter(document), nullptr);
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
    valijson::Schema schema_;
};

class WorkflowSchema : public testing::Test {
protected:
    bool check_accepts(const std::string& workflow) {
        Diagnostics diagnostics("w");
        make_plan(parse_workflow(workflow, diagnostics), library_, {}, diagnostics);
        return !diagnostics.has_errors();
    }

    test::DeclaredFilters filters_;
    FilterLibrary library_ = filters_.library();
    Schema schema_{library_};
};

std::string with_steps(const std::string& steps) {
    return "scanmill: 1\ninputs: {scan: points}\nparameters: {n: 3}\nsteps:\n" + steps;
}

TEST_F(WorkflowSchema, WhatCheckAccepts_IsAccepted) {
    for (const std::string& workflow :
         {with_steps("  - thin: {count: $n}\n"),
          with_steps("  - thin: {size: 0.1 %diag, axis: [1, 0, 0], count: $n}\n"),
          with_steps("  - thin: {size: +1e-3 mm, rule: random, count: $n}\n"),
          with_steps("  - thin: {count: {sweep: [1, $n, 9]}}\n    expect: {kept: '> 3', points: [1, 9]}\n"),
          with_steps(
              "  - thin: {count: $n}\n  - tetrahedralise:\n  - solid: {alpha: auto, coverage: 0.5, angle: 0 deg}\n"
              "    expect: {closed: true, alpha: < 3 %diag, bending: < 40 deg}\n"),
          with_steps("  - one-of:\n      - thin: {count: $n}\n      - id: b\n        thin:\n"
                     "      - name: twice\n        steps: [{thin: }, {id: again, thin: }]\n    id: any\n"),
          std::string("scanmill: 1\nname: w\nsummary: Nothing.\ninputs: {a: {kind: points, unit: mm, help: It.}, "
                      "b: [points]}\nsteps: [{combine: , in: {points: [a, b]}}]\n"
                      "outputs: {'{scan}.ply': combine}\n"),
          std::string(
              "scanmill: 1\ninputs: {scan: points}\nparameters: {s: {default: {sweep: [1 u, 2 u]}, help: It.}}\n"
              "steps: [{thin: {size: $s}, in: scan}]\n")}) {
        EXPECT_TRUE(check_accepts(workflow)) << workflow;
        EXPECT_TRUE(schema_.accepts(workflow)) << workflow;
    }
}

TEST_F(WorkflowSchema, WhatIsWrongAtOnePlace_IsRejectedAsByCheck) {
    const std::string n = "parameters: {n: 3}\n";
    for (const std::string& workflow :
         {std::string("inputs: {scan: points}\nsteps: [{thin: }]\n"),
          std::string("scanmill: 2\ninputs: {scan: points}\nsteps: [{thin: }]\n"),
          std::string("scanmill: 1\ninputs: {scan: points}\n"),
          std::string("scanmill: 1\ninputs: {scan: points}\nsteps: []\n"),
          std::string("scanmill: 1\ninputs: {scan: cloud}\nsteps: [{thin: }]\n"),
          std::string("scanmill: 1\ninputs: {scan: {unit: mm}}\nsteps: [{thin: }]\n"),
          std::string("scanmill: 1\ninputs: {scan: {kind: points, unit: yard}}\nsteps: [{thin: }]\n"),
          std::string("scanmill: 1\ninput: {scan: points}\nsteps: [{thin: }]\n"),
          std::string("scanmill: 1\nname: no name\ninputs: {scan: points}\nsteps: [{thin: }]\n"),
          with_steps("  - thinn:\n"),
          with_steps("  - thin: {siz: 1 u}\n"),
          with_steps("  - thin: {size: 0.5}\n"),
          with_steps("  - thin: {size: 0 mm}\n"),
          with_steps("  - thin: {size: -1 mm}\n"),
          with_steps("  - thin: {size: 1 yard}\n"),
          with_steps("  - thin: {size: mm}\n"),
          with_steps("  - thin: {count: 0}\n"),
          with_steps("  - thin: {count: 1.5}\n"),
          with_steps("  - thin: {count: [1, 2]}\n"),
          with_steps("  - thin: {rule: farthest}\n"),
          with_steps("  - thin: {axis: [1, 2]}\n"),
          with_steps("  - thin: {axis: 1}\n"),
          with_steps("  - thin: {count: {sweep: []}}\n"),
          with_steps("  - thin: {count: {sweep: [0]}}\n"),
          with_steps("  - thin: {count: {swept: [1]}}\n"),
          with_steps("  - thin:\n  - tetrahedralise:\n  - solid: {coverage: 3}\n"),
          with_steps("  - thin:\n  - tetrahedralise:\n  - solid: {angle: 40}\n"),
          with_steps("  - thin:\n  - tetrahedralise:\n  - solid: {alpha: automatic}\n"),
          with_steps("  - thin:\n    inn: scan\n"),
          with_steps("  - thin:\n    in: {mesh: scan}\n"),
          with_steps("  - thin:\n    expect: {keptt: 1}\n"),
          with_steps("  - thin:\n    expect: {closed: true}\n"),
          with_steps("  - thin:\n    expect: {kept: [1, 2, 3]}\n"),
          with_steps("  - thin:\n    tetrahedralise:\n"),
          with_steps("  - id: a\n"),
          with_steps("  - one-of: []\n"),
          with_steps("  - one-of: [{thin: }]\n    in: scan\n"),
          with_steps("  - thin:\n  - tetrahedralise:\n  - solid:\n  - simplify:\n")}) {
        EXPECT_FALSE(check_accepts(workflow)) << workflow;
        EXPECT_FALSE(schema_.accepts(workflow)) << workflow;
    }
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
    const FilterLibrary library({SCANMILL_PLUGIN_DIR});
    Schema schema(library);
    std::size_t found = 0;
    for (const auto& file : std::filesystem::directory_iterator(SCANMILL_SOURCE_DIR "/workflows")) {
        if (file.path().extension() != ".yaml") continue;
        ++found;
        const std::string workflow = test::content_of(file.path());
        EXPECT_TRUE(schema.accepts(workflow)) << file.path();
        Diagnostics diagnostics(file.path().string());
        make_plan(parse_workflow(workflow, diagnostics), library, {}, diagnostics);
        EXPECT_THAT(diagnostics.sorted(), testing::IsEmpty()) << file.path();
    }
    EXPECT_GE(found, 1u);
}

}  // namespace
}  // namespace scanmill
