// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/schemas.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "scanmill/batch/batch.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/plan/expectation.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* length_units = "u|%diag|spacing|um|mm|cm|m|in|ft";

/// The definitions that both grammars use. A literal is any value except a reference `$name`; it may begin with `$$`,
/// which stands for one $.
const char* const common_definitions = R"json({
"unit": {"enum": ["um", "mm", "cm", "m", "in", "ft"], "description": "The unit of the file's numbers."},
"frame": {"type": ["string", "number", "boolean"], "description": "The coordinate system's name; may contain {stem}."},
"invalid": {"enum": ["drop", "refuse"],
            "description": "How to treat rows with a NaN, infinite or too distant coordinate. By default they are dropped if the file's format writes NaN for a missing return; otherwise the file is refused."},
"literal": {"type": ["string", "number", "boolean"], "pattern": "^(?!\\$(?!\\$))"},
"value": {"if": {"type": "array"}, "then": {"items": {"$ref": "#/definitions/literal"}},
          "else": {"$ref": "#/definitions/literal"}},
"sweep": {"type": "object", "required": ["sweep"], "additionalProperties": false,
          "properties": {"sweep": {"type": "array", "minItems": 1, "items": {"$ref": "#/definitions/value"}}}},
"value-or-sweep": {"if": {"type": "object"}, "then": {"$ref": "#/definitions/sweep"},
                   "else": {"$ref": "#/definitions/value"}}
})json";

const char* const workflow_grammar = R"json({
"$schema": "http://json-schema.org/draft-07/schema#",
"title": "Scanmill workflow",
"type": "object", "required": ["scanmill", "steps"], "additionalProperties": false,
"properties": {
  "scanmill": {"const": 1, "description": "The version of the grammar."},
  "name": {"type": "string", "pattern": "^[A-Za-z][A-Za-z0-9_-]*$", "description": "The workflow's name."},
  "summary": {"type": ["string", "number", "boolean"], "description": "What the workflow does, in a sentence."},
  "inputs": {"type": ["object", "null"], "description": "Input files. The first input takes the scans; the files of other inputs are named for the run.",
             "propertyNames": {"pattern": "^[A-Za-z][A-Za-z0-9_-]*$"},
             "additionalProperties": {"$ref": "#/definitions/input"}},
  "parameters": {"type": ["object", "null"], "description": "Values that steps refer to by $name; a run can replace them.",
                 "propertyNames": {"pattern": "^[A-Za-z][A-Za-z0-9_-]*$"},
                 "additionalProperties": {"$ref": "#/definitions/parameter"}},
  "steps": {"$ref": "#/definitions/steps"},
  "outputs": {"type": ["object", "null"], "additionalProperties": {"type": "string"},
              "description": "Output files: the step whose result is written, by file name. Names may contain {scan}, {folder}, {variant} and {workflow}."}
},
"definitions": {
  "kind-name": {"description": "The kind of value in the file."},
  "kind": {"if": {"type": "array"},
           "then": {"items": {"$ref": "#/definitions/kind-name"}, "minItems": 1, "maxItems": 1},
           "else": {"$ref": "#/definitions/kind-name"}},
  "input": {"if": {"type": "object"}, "else": {"$ref": "#/definitions/kind"}, "then": {
    "required": ["kind"], "additionalProperties": false,
    "properties": {
      "kind": {"$ref": "#/definitions/kind"},
      "list": {"type": "boolean", "description": "Takes any number of files."},
      "unit": {"$ref": "#/definitions/unit"},
      "frame": {"$ref": "#/definitions/frame"},
      "invalid": {"$ref": "#/definitions/invalid"},
      "help": {"type": ["string", "number", "boolean"], "description": "What the input is for."}}}},
  "parameter": {"if": {"type": "object", "not": {"required": ["sweep"]}},
                "else": {"$ref": "#/definitions/value-or-sweep"}, "then": {
    "required": ["default"], "additionalProperties": false,
    "properties": {
      "default": {"$ref": "#/definitions/value-or-sweep"},
      "help": {"type": ["string", "number", "boolean"], "description": "What the parameter is for."}}}},
  "steps": {"type": "array", "minItems": 1, "items": {"$ref": "#/definitions/item"}},
  "item": {"if": {"type": "object", "required": ["one-of"]}, "then": {"$ref": "#/definitions/one-of"},
           "else": {"$ref": "#/definitions/step"}},
  "step": {"type": "object", "additionalProperties": false, "properties": {
    "id": {"type": "string", "pattern": "^[A-Za-z][A-Za-z0-9_-]*$",
           "description": "The name by which later steps and outputs refer to this step."},
    "in": {"description": "The values for the ports. A port without one takes the nearest earlier value of its kind."},
    "expect": {"description": "Conditions on the result. If one is not met, the scan fails."}}},
  "one-of": {"required": ["one-of"], "additionalProperties": false, "properties": {
    "id": {"type": "string", "pattern": "^[A-Za-z][A-Za-z0-9_-]*$",
           "description": "The name by which later steps and outputs refer to the last step of the alternative that ran."},
    "one-of": {"type": "array", "minItems": 1, "items": {"$ref": "#/definitions/alternative"},
               "description": "Alternatives. All later steps run once for each alternative."}}},
  "alternative": {"if": {"type": "array"}, "then": {"$ref": "#/definitions/steps"},
                  "else": {"if": {"type": "object", "required": ["steps"]}, "else": {"$ref": "#/definitions/item"},
                           "then": {"additionalProperties": false, "properties": {
    "name": {"type": "string", "pattern": "^[A-Za-z][A-Za-z0-9_-]*$",
             "description": "The name of the alternative, which is part of the names of variants."},
    "steps": {"$ref": "#/definitions/steps"}}}}}
}})json";

const char* const batch_grammar = R"json({
"$schema": "http://json-schema.org/draft-07/schema#",
"title": "Scanmill batch",
"type": "object", "required": ["scanmill", "batch", "workflows"], "additionalProperties": false,
"properties": {
  "scanmill": {"const": 1, "description": "The version of the grammar."},
  "batch": {"type": "string", "pattern": "^[A-Za-z][A-Za-z0-9_-]*$", "description": "The batch's name."},
  "summary": {"type": ["string", "number", "boolean"], "description": "What the batch is for, in a sentence."},
  "scans": {"type": "array", "minItems": 1, "items": {"$ref": "#/definitions/scan"},
            "description": "The scans; paths count from the batch file's folder. Workflows without inputs need none."},
  "workflows": {"description": "The workflows that every scan runs under: files, whose paths count from the batch file's folder, or names of ready workflows.",
                "if": {"type": "string"}, "then": {"$ref": "#/definitions/workflow"},
                "else": {"type": "array", "minItems": 1, "items": {"$ref": "#/definitions/workflow"}}},
  "set": {"$ref": "#/definitions/settings"},
  "limits": {"type": ["object", "null"], "description": "Limits of memory and time for one scan under one variant.",
             "additionalProperties": false, "properties": {
    "memory": {"$ref": "#/definitions/memory"},
    "time": {"$ref": "#/definitions/time"},
    "step": {"type": "object", "description": "Limits of memory and time for one step.", "additionalProperties": false,
             "properties": {"memory": {"$ref": "#/definitions/memory"}, "time": {"$ref": "#/definitions/time"}}},
    "retries": {"type": "integer", "minimum": 0, "description": "How many times failed work is tried again."}}},
  "measure": {"type": ["object", "null"], "additionalProperties": false,
              "description": "Measures the results of every scan that has a truth. Other keys are parameters of the measuring filter.",
              "properties": {
    "of": {"description": "The steps to measure; without it, the outputs of the workflows.",
           "if": {"type": "array"}, "then": {"minItems": 1, "items": {"type": "string"}}, "else": {"type": "string"}},
    "filter": {"description": "The measuring filter, if several are installed."}}},
  "gate": {"type": "object", "minProperties": 1,
           "description": "Rules that limit by how much metrics, costs and outputs may differ from the accepted run.",
           "propertyNames": {"pattern": "^[a-z][A-Za-z0-9_@.-]*$"},
           "additionalProperties": {"$ref": "#/definitions/tolerance"},
           "properties": {
    "outputs": {"const": "exact", "description": "No byte of an output file may change."},
    "repeats": {"type": "integer", "minimum": 1, "description": "How many times a run measures its costs."}}}
},
"definitions": {
  "scan": {"if": {"type": "object"}, "else": {"$ref": "#/definitions/scan-path"}, "then": {
    "required": ["path"], "additionalProperties": false,
    "properties": {
      "path": {"$ref": "#/definitions/scan-path"},
      "by": {"const": "folder", "description": "Each folder with matching files is one object, and the files are its views."},
      "unit": {"$ref": "#/definitions/unit"},
      "frame": {"$ref": "#/definitions/frame"},
      "invalid": {"$ref": "#/definitions/invalid"},
      "pose": {"$ref": "#/definitions/pose"},
      "poses": {"type": "string", "minLength": 1,
                "description": "With by: folder, the file with the poses of the object's views; may contain {stem}, {folder} and wildcards. Without it, the one file *.conf or *poses.json in the object's folder, if there is one."},
      "truth": {"$ref": "#/definitions/truth"},
      "in": {"type": "object", "description": "The scan's files for the workflows' further inputs, by their names. Paths may have wildcards.",
             "additionalProperties": false,
             "patternProperties": {"^[A-Za-z][A-Za-z0-9_-]*$": {
               "if": {"type": "array"}, "then": {"minItems": 1, "items": {"$ref": "#/definitions/scan-file"}},
               "else": {"$ref": "#/definitions/scan-file"}}}},
      "set": {"$ref": "#/definitions/settings"}}}},
  "scan-file": {"type": "string", "minLength": 1, "description": "A file; may contain {stem} and {folder}."},
  "truth": {"description": "The correct result, a mesh or points: a file, or a file with its unit and frame.",
            "if": {"type": "object"}, "else": {"$ref": "#/definitions/scan-file"}, "then": {
    "required": ["path"], "additionalProperties": false,
    "properties": {"path": {"$ref": "#/definitions/scan-file"}, "unit": {"$ref": "#/definitions/unit"},
                   "frame": {"$ref": "#/definitions/frame"}}}},
  "tolerance": {"type": ["string", "number"], "pattern": "^(exact|= truth|[-+]? *[0-9.].*)$", "examples": ["+1 %", "-0.01 mm", "exact", "= truth"],
                "patternErrorMessage": "Expected an amount with its sign and unit, as +1 %, or exact, or = truth."},
  "scan-path": {"type": "string", "minLength": 1, "description": "A file, or several files matched by *, ?, […] and **."},
  "workflow": {"type": "string", "minLength": 1, "description": "A workflow file, or the name of a ready workflow."},
  "settings": {"type": ["object", "null"], "description": "Values of the workflows' parameters, by their names.",
               "additionalProperties": false,
               "patternProperties": {"^[A-Za-z][A-Za-z0-9_-]*$": {"$ref": "#/definitions/value-or-sweep"}}},
  "three-numbers": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
  "four-numbers": {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
  "pose": {"description": "The scan's position: a file of poses, which may contain {stem}, a matrix in rows, or a motion.",
           "if": {"type": "object"}, "then": {
    "required": ["translation", "rotation"], "additionalProperties": false,
    "properties": {
      "translation": {"description": "x, y, z in the scan's unit.", "allOf": [{"$ref": "#/definitions/three-numbers"}]},
      "rotation": {"description": "A quaternion of length 1: qx, qy, qz, qw.",
                   "allOf": [{"$ref": "#/definitions/four-numbers"}]}}},
           "else": {"if": {"type": "array"}, "else": {"type": "string", "minLength": 1},
                    "then": {"items": {"$ref": "#/definitions/four-numbers"}, "minItems": 4, "maxItems": 4}}},
  "memory": {"type": "string", "pattern": " *([KMGT]iB|[kMGT]?B)$", "examples": ["8 GiB"],
             "description": "Largest memory. Work that needs more is stopped."},
  "time": {"type": "string", "pattern": " *(ms|s|min|h)$", "examples": ["10 min"],
           "description": "Longest time. Work that takes longer is stopped."}
}})json";

/// A regular expression for the number at the beginning of a text with a unit. It excludes negative numbers and zero if
/// the lower bound excludes them.
std::string number_pattern(const std::optional<Bound>& low) {
    const bool no_negative = low && low->value >= 0;
    const bool no_zero = no_negative && !low->inclusive;
    return std::string("^") + (no_zero ? R"((?![+]?[0.]+([eE]|[^0-9.]|$)))" : "") + (no_negative ? "[+]?" : "[-+]?") +
           R"(([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?)";
}

Json either(Json condition, Json then, Json otherwise) {
    return {{"if", std::move(condition)}, {"then", std::move(then)}, {"else", std::move(otherwise)}};
}

Json list_of(Json item, std::optional<std::size_t> size) {
    Json list{{"type", "array"}, {"items", std::move(item)}};
    if (size) list["minItems"] = list["maxItems"] = *size;
    return list;
}

/// The schema of a number with a unit. Editors show `expected` instead of the pattern, and propose the examples.
Json text_with_unit(const std::optional<Bound>& low, const std::string& units, std::string_view expected,
                    Json examples) {
    return {{"type", "string"},
            {"pattern", number_pattern(low) + " *(" + units + ")$"},
            {"patternErrorMessage", fmt::format("Expected {}.", expected)},
            {"examples", std::move(examples)}};
}

/// The schema of one value, without the parameter's word and without lists.
Json scalar_schema(const ParameterSpec& parameter) {
    const auto text = [&](const char* units, Json examples) {
        return text_with_unit(parameter.low, units, expectation(parameter), std::move(examples));
    };
    const auto number = [&](const char* type) {
        Json schema{{"type", type}};
        if (parameter.low) schema[parameter.low->inclusive ? "minimum" : "exclusiveMinimum"] = parameter.low->value;
        if (parameter.high) schema[parameter.high->inclusive ? "maximum" : "exclusiveMaximum"] = parameter.high->value;
        return schema;
    };
    switch (parameter.type) {
        case ParameterType::boolean: return {{"type", "boolean"}};
        case ParameterType::integer: return number("integer");
        case ParameterType::number: return number("number");
        case ParameterType::length: return text(length_units, {"0.2 mm", "0.1 %diag", "3 spacing"});
        case ParameterType::angle: return text("deg|rad", {"40 deg"});
        case ParameterType::ratio: return either({{"type", "string"}}, text("%", {"5 %"}), number("number"));
        case ParameterType::text:
        case ParameterType::path: return {{"type", {"string", "number", "boolean"}}};
        case ParameterType::choice: break;
    }
    Json choices = Json::array();
    for (const Choice& choice : parameter.choices)
        choices.push_back({{"const", choice.name}, {"description", choice.help}});
    return {{"oneOf", std::move(choices)}};
}

/// The schema of a value: a single value, the parameter's word, or a list of `item`.
Json value_schema(const ParameterSpec& parameter, Json item) {
    Json value = scalar_schema(parameter);
    // A single value in place of a list means a list of one value, if the list may have that length.
    if (parameter.list && parameter.size.value_or(1) != 1)
        value = list_of(std::move(item), parameter.size);
    else if (parameter.list)
        value = either({{"type", "array"}}, list_of(std::move(item), parameter.size), std::move(value));
    if (!parameter.word.empty()) value = {{"anyOf", {{{"const", parameter.word}}, std::move(value)}}};
    return value;
}

/// The schema that `$name` matches.
Json parameter_reference() { return {{"type", "string"}, {"pattern", R"(^\$[A-Za-z])"}}; }

/// The schema of a value, `$name` or `{sweep: […]}`. Its description contains the parameter's help, range and default.
Json parameter_schema(const ParameterSpec& parameter) {
    const Json reference = parameter_reference();
    const Json value = either(reference, Json::object(),
                              value_schema(parameter, either(reference, Json::object(), scalar_schema(parameter))));
    const Json sweep{{"description", "Runs this step and all later steps once for each value."},
                     {"required", Json::array({"sweep"})},
                     {"additionalProperties", false},
                     {"properties", {{"sweep", {{"type", "array"}, {"minItems", 1}, {"items", value}}}}}};
    const std::string given = text(parameter.default_value);
    Json schema{{"description", fmt::format("{} Takes {}.{}", parameter.help, expectation(parameter),
                                            parameter.required ? " Required."
                                            : given.empty()    ? ""
                                                               : " Default: " + given + ".")}};
    schema.update(either({{"type", "object"}}, sweep, value));
    return schema;
}

Json filter_schema(const FilterSpec& spec) {
    Json schema{{"type", "object"},
                {"additionalProperties", false},
                {"properties", Json::object()},
                {"description", spec.summary + " (" + spec.source + ")"}};
    for (const ParameterSpec& parameter : spec.parameters) {
        schema["properties"][parameter.name] = parameter_schema(parameter);
        if (parameter.required) schema["required"].push_back(parameter.name);
    }
    if (!schema.contains("required")) schema["type"] = {"object", "null"};
    return schema;
}

/// The schema of a parameter under `measure`, which takes neither `$name` nor a sweep.
Json measuring_schema(const ParameterSpec& parameter) {
    Json schema = value_schema(parameter, scalar_schema(parameter));
    schema["description"] = parameter_schema(parameter)["description"];
    return schema;
}

/// The schema of `in:` for a filter: a map from its ports, or also a single name if the filter has one port.
Json in_schema(const FilterSpec& spec) {
    const Json source{{"type", "string"}};
    Json map{{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
    for (const PortSpec& port : spec.inputs) {
        Json& described = map["properties"][port.name];
        described = either({{"type", "array"}}, {{"items", source}}, source);
        described["description"] = kinds_text(port) + ": " + port.help;
    }
    return spec.inputs.size() == 1 ? either(source, Json::object(), std::move(map)) : map;
}

Json expect_schema(const FilterSpec& spec) {
    Json schema{{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
    const Json reference = parameter_reference();
    for (const MetricSpec& metric : expectable(spec)) {
        const int power = power_of_length(metric.unit);
        const std::string digit = std::to_string(power);
        const Json number =
            power > 1 ? text_with_unit({}, fmt::format("({})(\\^?{}|{})", length_units, power, power == 2 ? "²" : "³"),
                                       length_power_examples(power), {"12 mm" + digit, "0.5 u" + digit})
                      : scalar_schema(written_as(metric.unit));
        const Json value = either(reference, Json::object(), number);
        Json expected =
            either({{"type", "array"}}, list_of(value, 2),
                   either({{"type", "string"}, {"pattern", "^[<>]"}}, {{"pattern", "^[<>] *[^<>= ]"}}, value));
        if (metric.numbered) schema["patternProperties"]["^" + metric.name + "@([2-9]|[1-9][0-9]+)$"] = expected;
        schema["properties"][metric.name] = std::move(expected);
    }
    return schema;
}

std::string with_common_definitions(Json schema) {
    schema["definitions"].update(Json::parse(common_definitions));
    return schema.dump(2) + "\n";
}

}  // namespace

std::string workflow_schema(const FilterLibrary& library) {
    Json schema = Json::parse(workflow_grammar);
    schema["definitions"]["kind-name"]["enum"] = readable_kinds();
    Json& step = schema["definitions"]["step"];
    Json one_filter = Json::array(), names{"id", "in", "expect"};
    for (const std::string& name : library.names()) {
        const FilterSpec& spec = *library.find(name);
        step["properties"][name] = filter_schema(spec);
        names.push_back(name);
        one_filter.push_back({{"required", Json::array({name})}});
        step["allOf"].push_back(
            {{"if", {{"required", Json::array({name})}}},
             {"then", {{"properties", {{"in", in_schema(spec)}, {"expect", expect_schema(spec)}}}}}});
    }
    // The rule of one filter applies only if all keys are known: additionalProperties already reports unknown keys.
    step["if"] = {{"propertyNames", {{"enum", std::move(names)}}}};
    step["then"] = {{"oneOf", std::move(one_filter)}};
    return with_common_definitions(std::move(schema));
}

std::string batch_schema(const FilterLibrary& library) {
    Json schema = Json::parse(batch_grammar);
    Json& measure = schema["properties"]["measure"]["properties"];
    Json& gate = schema["properties"]["gate"]["properties"];
    Json measuring = Json::array();
    for (const char* cost : {"seconds", "cpu-seconds", "memory"})
        gate[cost] = {{"type", "string"},
                      {"pattern", "^\\+.*%$"},
                      {"description", "Largest rise of this cost of a cell, as +20 %."}};
    gate["repeats"]["maximum"] = most_repeats;
    for (const std::string& name : library.names()) {
        const FilterSpec& spec = *library.find(name);
        if (!spec.measures) continue;
        measuring.push_back(name);
        for (const ParameterSpec& parameter : spec.parameters)
            if (!measure.contains(parameter.name)) measure[parameter.name] = measuring_schema(parameter);
        for (const MetricSpec& metric : spec.metrics)
            if (!gate.contains(metric.name))
                gate[metric.name] = {{"description", metric.help},
                                     {"allOf", Json::array({{{"$ref", "#/definitions/tolerance"}}})}};
    }
    measure["filter"]["enum"] = std::move(measuring);
    schema["properties"]["limits"]["properties"]["retries"]["maximum"] = most_retries;
    for (const char* cap : {"memory", "time"}) {
        Json& pattern = schema["definitions"][cap]["pattern"];
        pattern = number_pattern(Bound{0, false}) + pattern.get<std::string>();
    }
    return with_common_definitions(std::move(schema));
}

}  // namespace scanmill
