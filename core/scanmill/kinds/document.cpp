// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/document.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

/// Refuses repeated keys, because nlohmann's parser would keep only one of them. Refuses nesting that is too deep for
/// recursive readers.
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
    return schema::described("The unit of lengths; null if not declared.", "",
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

void JsonByName<Metrics>::read(const Json& json, Metrics& metrics) {
    require_object(json);
    metrics.values.clear();
    for (const auto& [name, value] : json.items()) {
        if (!value.is_number() && !value.is_boolean() && !value.is_null())
            throw JsonMismatch{name, "is not a number, true, false or null"};
        metrics.set(name,
                    value.is_null()      ? std::numeric_limits<double>::quiet_NaN()
                    : value.is_boolean() ? static_cast<double>(value.get<bool>())
                                         : value.get<double>(),
                    Unit::number);
    }
}

Json JsonByName<Metrics>::schema() {
    return schema::described("Numbers by name; null for a number that is not finite.", "",
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

void require_document(const Json& document) {
    if (!document.is_object() || document.value("scanmill", Json()) != Json(1))
        throw Error("is not a Scanmill document; expected an object with \"scanmill\": 1");
}

namespace {

class MoveOrigin : public FieldVisitor {
public:
    explicit MoveOrigin(const Vec3& origin) : origin_(origin) {}
    void frame(const char*, Frame& frame) override {
        shift_ = frame.origin - origin_;
        frame.origin = origin_;
    }
    void positions(const char*, Buffer<Vec3>& positions) override { positions = translated(positions, shift_); }

private:
    Vec3 origin_, shift_ = Vec3::Zero();
};

struct FindBox : FieldVisitor {
    void positions(const char*, Buffer<Vec3>& positions) override {
        for (const Vec3& p : positions) box.add(p);
    }
    BoundingBox box;
};

}  // namespace

void use_world_origin(Kind kind, void* object) {
    MoveOrigin move(Vec3::Zero());
    kind.info().visit(move, object);
}

void use_near_origin(Kind kind, void* object) {
    FindBox found;
    kind.info().visit(found, object);
    const Vec3 origin = distant_origin(found.box);
    if (origin == Vec3::Zero()) return;  // adding 0 would change -0
    MoveOrigin move(origin);
    kind.info().visit(move, object);
}

}  // namespace scanmill
