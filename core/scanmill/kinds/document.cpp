// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/document.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

/// Refuses repeated keys, of which nlohmann's parser would keep one, and nesting too deep for recursive readers.
class StrictStructure {
public:
    bool operator()(int depth, Json::parse_event_t event, Json& value) {
        if (depth > deepest) throw Error("is nested more than {} levels deep", deepest);
        if (event == Json::parse_event_t::object_start) open_.emplace_back();
        if (event == Json::parse_event_t::object_end) open_.pop_back();
        if (event == Json::parse_event_t::key && !open_.back().insert(value.get<std::string>()).second)
            throw Error("the key '{}' is twice in one object", value.get<std::string>());
        return true;
    }

private:
    static constexpr int deepest = 16;
    std::vector<std::set<std::string>> open_;
};

}  // namespace

void JsonForm<Kind>::read(const Json& json, Kind& kind) {
    std::string name;
    JsonForm<std::string>::read(json, name);
    const std::optional<Kind> found = kind_named(name);
    if (!found) throw JsonMismatch{{}, fmt::format("is '{}'; expected one of {}", name, kind_names())};
    kind = *found;
}

void JsonForm<LengthUnit>::read(const Json& json, LengthUnit& unit) {
    unit = LengthUnit::unknown;
    if (json.is_null()) return;
    std::string text;
    JsonForm<std::string>::read(json, text);
    const std::optional<LengthUnit> found = length_unit(text);
    if (!found)
        throw JsonMismatch{{},
                           fmt::format("is the unknown unit '{}'; expected one of {}", text, length_unit_symbols())};
    unit = *found;
}

Json JsonForm<LengthUnit>::schema() {
    return schema::described("The unit of lengths; null: not declared.", "",
                             {{"enum", {"um", "mm", "cm", "m", "in", "ft", nullptr}}});
}

Json JsonByName<Metrics>::write(const Metrics& metrics) {
    Json json = Json::object();
    for (const auto& [name, value, unit] : metrics.values) {
        if (unit == Unit::boolean)
            json[name] = value != 0;
        else if (!std::isfinite(value))
            json[name] = nullptr;
        else if (unit == Unit::count && value == std::round(value) && std::abs(value) < 1e15)
            json[name] = static_cast<std::int64_t>(value);
        else
            json[name] = value;
    }
    return json;
}

Json JsonByName<Metrics>::schema() {
    return schema::described("Numbers by name; null: not finite.", "",
                             schema::map_of({{"type", {"number", "boolean", "null"}}}));
}

Json parse_document(std::string_view text) {
    try {
        return Json::parse(text, StrictStructure());
    } catch (const Json::out_of_range&) {
        throw Error("contains a number that is too large");
    } catch (const Json::parse_error& error) {
        const std::size_t end = std::min(error.byte, text.size());
        throw Error("line {}: invalid JSON", 1 + std::ranges::count(text.substr(0, end), '\n'));
    }
}

void require_keys(const Json& object, const std::string& place, const std::vector<std::string>& known) {
    for (const auto& [key, value] : object.items())
        if (std::ranges::find(known, key) == known.end())
            throw Error("{}: unknown key '{}'; expected {}{}", place, key, enumerated(known), did_you_mean(key, known));
}

void require_document(const Json& document, const std::vector<std::string>& known) {
    if (!document.is_object() || member(document, "scanmill") != Json(1))
        throw Error("is not a Scanmill document; expected an object with \"scanmill\": 1");
    require_keys(document, "the document", known);
}

const Json& member(const Json& object, std::string_view key) {
    static const Json none;
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

std::string text_member(const Json& object, std::string_view key, const std::string& place) {
    const Json& text = member(object, key);
    if (text.is_null()) return {};
    if (!text.is_string()) throw Error("{}: '{}' is not a text", place, key);
    return text.get<std::string>();
}

LengthUnit unit_member(const Json& document) {
    const std::string text = text_member(document, "unit", "the document");
    if (text.empty()) return LengthUnit::unknown;
    const std::optional<LengthUnit> unit = length_unit(text);
    if (!unit) throw Error("unknown unit '{}'; expected one of {}", text, length_unit_symbols());
    return *unit;
}

const Json& list_member(const Json& object, std::string_view key, const std::string& place) {
    const Json& list = member(object, key);
    if (!list.is_array()) throw Error("{}: '{}' is not a list", place, key);
    return list;
}

std::vector<double> numbers_of(const Json& list, std::size_t count, const std::string& what) {
    const bool sound = list.is_array() && list.size() == count &&
                       std::ranges::all_of(list, [](const Json& item) { return item.is_number(); });
    if (!sound) throw Error("{} is not a list of {} numbers", what, count);
    return list.get<std::vector<double>>();
}

Vec3 vector_of(const Json& list, const std::string& what) { return Vec3(numbers_of(list, 3, what).data()); }

Json unit_json(LengthUnit unit) { return unit == LengthUnit::unknown ? Json(nullptr) : Json(symbol(unit)); }

Json json_of(const Vec3& vector) { return Json::array({vector.x(), vector.y(), vector.z()}); }

}  // namespace scanmill
