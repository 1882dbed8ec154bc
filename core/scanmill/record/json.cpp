// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/record/json.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

JsonMismatch JsonMismatch::in(std::string_view name) && {
    if (!path.empty() && path.front() != '[') path.insert(0, ".");
    path.insert(0, name);
    return std::move(*this);
}

JsonMismatch JsonMismatch::in(std::size_t index) && {
    if (!path.empty() && path.front() != '[') path.insert(0, ".");
    path.insert(0, fmt::format("[{}]", index));
    return std::move(*this);
}

void throw_mismatch(const JsonMismatch& mismatch, std::string_view subject) {
    if (mismatch.path.empty()) throw Error("{} {}", subject, mismatch.sentence);
    throw Error("{}: '{}' {}", subject, mismatch.path, mismatch.sentence);
}

std::string cbor_of(const Json& json) {
    std::string bytes;
    Json::to_cbor(json, bytes);
    return bytes;
}

Json json_from_cbor(std::string_view bytes, std::string_view subject) {
    try {
        return Json::from_cbor(bytes);
    } catch (const Json::exception&) {
        throw Error("{} cannot be read: it is not CBOR", subject);
    }
}

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

void require_object(const Json& json) {
    if (!json.is_object()) throw JsonMismatch{{}, "is not an object"};
}

void require_size(const Json& items, std::size_t size) {
    if (!items.is_array() || items.size() != size)
        throw JsonMismatch{{}, fmt::format("is not a list of {} values", size)};
}

void require_known(const Json& object, const std::vector<std::string_view>& known) {
    for (const auto& [name, value] : object.items()) {
        if (std::ranges::find(known, name) != known.end()) continue;
        const std::vector<std::string> names(known.begin(), known.end());
        throw JsonMismatch{name,
                           fmt::format("is unknown; expected {}{}", enumerated(names), did_you_mean(name, names))};
    }
}

void require_meaning(Meaning meaning, double number) {
    if (meaning == Meaning::length && !(number >= 0)) throw JsonMismatch{{}, "is not a length of 0 or more"};
}

void require_meaning(Meaning meaning, const Eigen::Vector3d& vector) {
    constexpr double most = 1e-4;
    if (meaning == Meaning::direction && !(std::abs(vector.norm() - 1) <= most))
        throw JsonMismatch{{}, fmt::format("has the length {:.6g}; a direction's is 1", vector.norm())};
}

std::string expected_names(std::span<const std::string_view> names, std::string_view found) {
    const std::vector<std::string> all(names.begin(), names.end());
    return fmt::format("is '{}'; expected {}{}", found, enumerated(all), did_you_mean(std::string(found), all));
}

namespace schema {

Json described(std::string_view text, std::string_view unit, Json schema) {
    std::string description(text);
    if (!unit.empty()) description += fmt::format("{}In {}.", text.empty() ? "" : " ", unit);
    if (!description.empty()) schema["description"] = description;
    return schema;
}

Json or_null(Json schema) {
    if (const auto values = schema.find("enum"); values != schema.end()) {
        if (std::ranges::find(*values, Json()) == values->end()) values->push_back(nullptr);
    } else if (const auto type = schema.find("type"); type != schema.end() && type->is_string()) {
        *type = Json::array({*type, "null"});
    } else if (type == schema.end()) {
        return {{"anyOf", {std::move(schema), Json{{"type", "null"}}}}};
    }
    return schema;
}

Json names(std::span<const std::string_view> names) {
    Json all = Json::array();
    for (const std::string_view name : names) all.push_back(name);
    return {{"enum", std::move(all)}};
}

Json tuple_of(std::size_t size, Json item) {
    Json items = list_of(std::move(item));
    items["minItems"] = size;
    items["maxItems"] = size;
    return items;
}

Json object() {
    return {{"type", "object"},
            {"required", Json::array()},
            {"additionalProperties", false},
            {"properties", Json::object()}};
}

void add(Json& object, const std::string& name, Json schema, bool is_required) {
    object["properties"][name] = std::move(schema);
    if (is_required) object["required"].push_back(name);
}

Json document(std::string_view title, const Json& members) {
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
    Json all = object();
    add(all, "scanmill", {{"const", 1}});
    all["properties"].update(members["properties"]);
    for (const Json& name : members["required"]) all["required"].push_back(name);
    schema.update(all);
    return schema;
}

}  // namespace schema

}  // namespace scanmill
