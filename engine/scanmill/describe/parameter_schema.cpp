// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/parameter_schema.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "scanmill/workflow/length_power.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view reference_pattern = R"(^\$[A-Za-z])";

/// A decimal number, of the sign and zeros that the lower bound allows.
std::string number_pattern(const std::optional<Bound>& low) {
    const bool no_negative = low && low->value >= 0;
    const bool no_zero = no_negative && !low->inclusive;
    return std::string("^") + (no_zero ? R"((?![+]?[0.]+([eE]|[^0-9.]|$)))" : "") + (no_negative ? "[+]?" : "[-+]?") +
           R"(([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?)";
}

constexpr std::string_view length_units = "u|%diag|spacing|um|mm|cm|m|in|ft";

/// The last two keys are for editors: what they say instead of the pattern, and what they propose.
Json text_with_unit(const std::optional<Bound>& low, const std::string& units, std::string_view expected,
                    Json examples) {
    return {{"type", "string"},
            {"pattern", number_pattern(low) + " *(" + units + ")$"},
            {"patternErrorMessage", fmt::format("Expected {}.", expected)},
            {"examples", std::move(examples)}};
}
Json text_with_unit(const ParameterSpec& parameter, std::string_view units, Json examples) {
    return text_with_unit(parameter.low, std::string(units), expectation(parameter), std::move(examples));
}

void bound(Json& schema, const ParameterSpec& parameter) {
    if (parameter.low) schema[parameter.low->inclusive ? "minimum" : "exclusiveMinimum"] = parameter.low->value;
    if (parameter.high) schema[parameter.high->inclusive ? "maximum" : "exclusiveMaximum"] = parameter.high->value;
}

Json number_of(std::string_view type, const ParameterSpec& parameter) {
    Json schema{{"type", type}};
    bound(schema, parameter);
    return schema;
}

Json choices_of(const ParameterSpec& parameter) {
    Json alternatives = Json::array();
    for (const Choice& choice : parameter.choices)
        alternatives.push_back({{"const", choice.name}, {"description", choice.help}});
    return {{"oneOf", std::move(alternatives)}};
}

/// One value, without words and lists.
Json scalar_of(const ParameterSpec& parameter) {
    switch (parameter.type) {
        case ParameterType::boolean: return {{"type", "boolean"}};
        case ParameterType::integer: return number_of("integer", parameter);
        case ParameterType::number: return number_of("number", parameter);
        case ParameterType::choice: return choices_of(parameter);
        case ParameterType::length:
            return text_with_unit(parameter, length_units, {"0.2 mm", "0.1 %diag", "3 spacing"});
        case ParameterType::angle: return text_with_unit(parameter, "deg|rad", {"40 deg"});
        case ParameterType::ratio:
            return {{"anyOf", Json::array({text_with_unit(parameter, "%", {"5 %"}), number_of("number", parameter)})}};
        case ParameterType::text:
        case ParameterType::path: break;
    }
    return {{"type", Json::array({"string", "number", "boolean"})}};
}

Json list_of(const ParameterSpec& parameter, Json item) {
    Json list{{"type", "array"}, {"items", std::move(item)}};
    if (parameter.size) list["minItems"] = list["maxItems"] = *parameter.size;
    return list;
}

std::string description_of(const ParameterSpec& parameter) {
    const std::string value = text(parameter.default_value);
    return parameter.help + " Takes " + expectation(parameter) + "." +
           (parameter.required ? " Required."
            : value.empty()    ? ""
                               : " Default: " + value + ".");
}

/// A value or a list whose items are such.
Json value_of(const ParameterSpec& parameter, Json item) {
    Json alternatives = Json::array();
    if (!parameter.word.empty()) alternatives.push_back({{"const", parameter.word}});
    // A single value in a list's place is the list of that value, unless the list must have another length.
    if (!parameter.list || !parameter.size || *parameter.size == 1) alternatives.push_back(scalar_of(parameter));
    if (parameter.list) alternatives.push_back(list_of(parameter, std::move(item)));
    return alternatives.size() == 1 ? alternatives.front() : Json{{"anyOf", std::move(alternatives)}};
}

}  // namespace

Json value_schema(const ParameterSpec& parameter) { return value_of(parameter, scalar_of(parameter)); }

Json length_power_schema(int power) {
    const std::string exponent = power == 2 ? "(\\^?2|²)" : "(\\^?3|³)", digit = std::to_string(power);
    return text_with_unit({}, fmt::format("({}){}", length_units, exponent), length_power_examples(power),
                          {"12 mm" + digit, "0.5 u" + digit});
}

Json parameter_schema(const ParameterSpec& parameter) {
    const Json reference{{"type", "string"}, {"pattern", reference_pattern}};
    const Json value = value_of(parameter, {{"anyOf", Json::array({scalar_of(parameter), reference})}});
    const Json sweep{
        {"type", "object"},
        {"description", "Runs everything from here on once for each value."},
        {"required", Json::array({"sweep"})},
        {"additionalProperties", false},
        {"properties",
         {{"sweep", {{"type", "array"}, {"minItems", 1}, {"items", {{"anyOf", Json::array({value, reference})}}}}}}}};
    return {{"description", description_of(parameter)}, {"anyOf", Json::array({value, reference, sweep})}};
}

}  // namespace scanmill
