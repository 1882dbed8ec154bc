// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/schema_parts.hpp"

#include "scanmill/data/frame.hpp"

namespace scanmill::schema {

Json name_of(const char* description) {
    return {{"type", "string"}, {"pattern", name_pattern}, {"description", description}};
}

Json text(const char* description) {
    return {{"type", Json::array({"string", "number", "boolean"})}, {"description", description}};
}

Json object_of(Json properties) {
    return {{"type", "object"}, {"additionalProperties", false}, {"properties", std::move(properties)}};
}

Json map_from_names(Json values, const char* description) {
    return {{"type", Json::array({"object", "null"})},
            {"description", description},
            {"propertyNames", {{"pattern", name_pattern}}},
            {"additionalProperties", std::move(values)}};
}

Json unit() {
    Json symbols = Json::array();
    for (const LengthUnit unit : {LengthUnit::micrometre, LengthUnit::millimetre, LengthUnit::centimetre,
                                  LengthUnit::metre, LengthUnit::inch, LengthUnit::foot})
        symbols.push_back(symbol(unit));
    return {{"enum", std::move(symbols)}, {"description", "The unit of the file's numbers."}};
}

Json any_value() {
    const Json scalar{{"type", Json::array({"string", "number", "boolean"})}};
    Json literal = scalar;  // $name would be a reference, for which there is nothing here; $$ begins a text with one $
    literal["pattern"] = R"(^(?!\$(?!\$)))";
    const Json value{{"anyOf", Json::array({literal, Json{{"type", "array"}, {"items", literal}}})}};
    Json sweep = object_of({{"sweep", {{"type", "array"}, {"minItems", 1}, {"items", value}}}});
    sweep["required"] = Json::array({"sweep"});
    return {{"anyOf", Json::array({value, std::move(sweep)})}};
}

Json document(const char* title, Json required, Json properties) {
    return {{"$schema", "http://json-schema.org/draft-07/schema#"},
            {"title", title},
            {"type", "object"},
            {"required", std::move(required)},
            {"additionalProperties", false},
            {"properties", std::move(properties)}};
}

}  // namespace scanmill::schema
