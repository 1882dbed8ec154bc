// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/workflow_schema.hpp"

#include <algorithm>

#include "scanmill/describe/parameter_schema.hpp"
#include "scanmill/describe/schema_parts.hpp"
#include "scanmill/plan/expectation.hpp"
#include "scanmill/workflow/length_power.hpp"

namespace scanmill {

namespace {

using schema::Json;
using schema::map_from_names;
using schema::object_of;

Json reference_to(const char* definition) { return {{"$ref", std::string("#/definitions/") + definition}}; }

Json input_schema() {
    const Json kind{{"enum", Json::array({"points", "mesh"})}, {"description", "What the file holds."}};
    const Json list{{"type", "array"}, {"items", kind}, {"minItems", 1}, {"maxItems", 1}};
    Json details = object_of({{"kind", {{"anyOf", Json::array({kind, list})}}},
                              {"list", {{"type", "boolean"}, {"description", "Takes any number of files."}}},
                              {"unit", schema::unit()},
                              {"frame", schema::text("The name of the coordinate system.")},
                              {"help", schema::text("What the input is for.")}});
    details["required"] = Json::array({"kind"});
    return {{"anyOf", Json::array({kind, list, std::move(details)})}};
}

/// Of a workflow parameter, whose type only its use decides.
Json any_value_schema() {
    const Json given = schema::any_value();
    Json details = object_of({{"default", given}, {"help", schema::text("What the parameter is for.")}});
    details["required"] = Json::array({"default"});
    Json alternatives = given["anyOf"];
    alternatives.push_back(std::move(details));
    return {{"anyOf", std::move(alternatives)}};
}

std::string sentence_of(const FilterSpec& spec) { return spec.summary + " (" + spec.source + ")"; }

Json filter_schema(const FilterSpec& spec) {
    Json properties = Json::object();
    Json required = Json::array();
    for (const ParameterSpec& parameter : spec.parameters) {
        properties[parameter.name] = parameter_schema(parameter);
        if (parameter.required) required.push_back(parameter.name);
    }
    Json schema = object_of(std::move(properties));
    schema["description"] = sentence_of(spec);
    if (required.empty())
        schema["type"] = Json::array({"object", "null"});
    else
        schema["required"] = std::move(required);
    return schema;
}

/// `in:` of a filter: a map from its ports, or a name alone when there is one port.
Json in_schema(const FilterSpec& spec) {
    const Json reference{{"type", "string"}};
    Json ports = Json::object();
    for (const PortSpec& port : spec.inputs) {
        ports[port.name] = {{"description", kinds_text(port) + ": " + port.help},
                            {"anyOf", Json::array({reference, Json{{"type", "array"}, {"items", reference}}})}};
    }
    Json map = object_of(std::move(ports));
    return spec.inputs.size() == 1 ? Json{{"anyOf", Json::array({reference, std::move(map)})}} : map;
}

Json expect_schema(const FilterSpec& spec) {
    Json properties = Json::object();
    Json patterns = Json::object();
    for (const MetricSpec& metric : expectable(spec)) {
        const int power = power_of_length(metric.unit);
        const Json value = power > 1 ? length_power_schema(power) : value_schema(written_as(metric.unit));
        const Json expected{
            {"description", metric.help},
            {"anyOf", Json::array({value, Json{{"type", "string"}, {"pattern", "^[<>] *[^<>= ]"}},
                                   Json{{"type", "array"}, {"items", value}, {"minItems", 2}, {"maxItems", 2}}})}};
        properties[metric.name] = expected;
        if (metric.numbered) patterns[fmt::format("^{}@([2-9]|[1-9][0-9]+)$", metric.name)] = expected;
    }
    Json schema = object_of(std::move(properties));
    if (!patterns.empty()) schema["patternProperties"] = std::move(patterns);
    return schema;
}

/// A step has one filter; what `in` and `expect` take depends on which.
Json step_schema(const FilterLibrary& library) {
    Json properties{{"id", schema::name_of("How later steps and outputs refer to this step.")},
                    {"in", {{"description", "Which values feed the ports; without it, the nearest earlier ones."}}},
                    {"expect", {{"description", "What must be true of the result, else the scan fails."}}}};
    Json one_filter = Json::array(), by_filter = Json::array();
    for (const std::string& name : library.names()) {
        const FilterSpec& spec = *library.find(name);
        properties[name] = filter_schema(spec);
        one_filter.push_back({{"required", Json::array({name})}});
        by_filter.push_back({{"if", {{"required", Json::array({name})}}},
                             {"then", {{"properties", {{"in", in_schema(spec)}, {"expect", expect_schema(spec)}}}}}});
    }
    Json schema = object_of(std::move(properties));
    schema["oneOf"] = std::move(one_filter);
    schema["allOf"] = std::move(by_filter);
    return schema;
}

Json one_of_schema() {
    Json named = object_of({{"name", schema::name_of("How variants are named that take this alternative.")},
                            {"steps", reference_to("steps")}});
    named["required"] = Json::array({"steps"});
    const Json alternative{{"anyOf", Json::array({reference_to("step"), reference_to("one-of"), reference_to("steps"),
                                                  std::move(named)})}};
    Json schema = object_of(
        {{"id", schema::name_of("How later steps and outputs refer to the end of whichever alternative ran.")},
         {"one-of",
          {{"type", "array"},
           {"minItems", 1},
           {"description", "Alternatives: everything below runs once for each."},
           {"items", alternative}}}});
    schema["required"] = Json::array({"one-of"});
    return schema;
}

}  // namespace

std::string workflow_schema(const FilterLibrary& library) {
    Json properties{
        {"scanmill", {{"const", 1}, {"description", "The version of the grammar."}}},
        {"name", schema::name_of("The workflow's name.")},
        {"summary", schema::text("What the workflow does, in a sentence.")},
        {"inputs",
         map_from_names(reference_to("input"), "Files; the scans feed the first, files named for the run the others.")},
        {"parameters",
         map_from_names(reference_to("parameter"), "Values that steps refer to by $name; a run can replace them.")},
        {"steps", reference_to("steps")},
        {"outputs",
         {{"type", Json::array({"object", "null"})},
          {"description", "Files to write: names over {scan}, {variant} and {workflow}, each with its step."},
          {"additionalProperties", {{"type", "string"}}}}}};
    Json whole = schema::document("Scanmill workflow", Json::array({"scanmill", "steps"}), std::move(properties));
    whole["definitions"] = {{"input", input_schema()},
                            {"parameter", any_value_schema()},
                            {"steps",
                             {{"type", "array"},
                              {"minItems", 1},
                              {"items", {{"anyOf", Json::array({reference_to("step"), reference_to("one-of")})}}}}},
                            {"step", step_schema(library)},
                            {"one-of", one_of_schema()}};
    return whole.dump(2) + "\n";
}

}  // namespace scanmill
