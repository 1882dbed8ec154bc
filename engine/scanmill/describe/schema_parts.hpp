// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Functions that return parts of JSON Schemas (draft 7).

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "scanmill/data/metrics.hpp"

namespace scanmill::schema_parts {

using Json = nlohmann::ordered_json;

inline Json text() { return {{"type", "string"}}; }
inline Json flag() { return {{"type", "boolean"}}; }
inline Json number() { return {{"type", "number"}}; }
inline Json count() { return {{"type", "integer"}, {"minimum", 0}}; }
inline Json list_of(Json item) { return {{"type", "array"}, {"items", std::move(item)}}; }
inline Json map_of(Json value) { return {{"type", "object"}, {"additionalProperties", std::move(value)}}; }
inline Json described(const char* description, Json schema) {
    schema["description"] = description;
    return schema;
}

/// The schema of an object with these members and no others. A member whose name ends in ? is optional.
inline Json object(std::initializer_list<std::pair<std::string, Json>> members) {
    Json required = Json::array(), properties = Json::object();
    for (const auto& [name, schema] : members) {
        const bool is_optional = name.ends_with('?');
        const std::string key = name.substr(0, name.size() - is_optional);
        properties[key] = schema;
        if (!is_optional) required.push_back(key);
    }
    return {{"type", "object"},
            {"required", std::move(required)},
            {"additionalProperties", false},
            {"properties", std::move(properties)}};
}

/// The schema of an object with the members of both schemas.
inline Json joined(Json one, const Json& other) {
    one["properties"].update(other["properties"]);
    for (const Json& name : other["required"]) one["required"].push_back(name);
    return one;
}

/// The schema of a whole document with these members.
inline Json document(const char* title, const Json& members) {
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
    schema.update(joined(object({{"scanmill", {{"const", 1}}}}), members));
    return schema;
}

/// The names of the values of an enumeration from `first` to `last`. Pre: the values have no gaps.
template <class Enum>
Json names(Enum first, Enum last) {
    Json all = Json::array();
    for (int i = static_cast<int>(first); i <= static_cast<int>(last); ++i)
        all.push_back(name_of(static_cast<Enum>(i)));
    return {{"enum", std::move(all)}};
}

inline Json unit() { return names(Unit::count, Unit::boolean); }
inline Json length_unit_or_null() {
    return described("The unit of lengths; null: not declared.",
                     {{"enum", {"um", "mm", "cm", "m", "in", "ft", nullptr}}});
}
inline Json metrics() {
    return described("Numbers by name; null: not finite.", map_of({{"type", {"number", "boolean", "null"}}}));
}

}  // namespace scanmill::schema_parts
