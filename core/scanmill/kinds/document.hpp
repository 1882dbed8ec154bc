// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The common parts of the JSON forms of all kinds.
///
/// A document is an object with `"scanmill": 1`, a `unit` and the member that identifies its kind. Errors use our
/// words, not those of the JSON library.

#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/metrics.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/kinds/kind.hpp"
#include "scanmill/record/json.hpp"

namespace scanmill {

// Forms of small types.

/// Its name.
template <>
struct JsonForm<Kind> {
    static Json write(Kind kind) { return kind.name(); }
    static void read(const Json& json, Kind& kind);
    static Json schema() { return schema::type("string"); }
};

/// Its symbol; null: unknown.
template <>
struct JsonForm<LengthUnit> {
    static Json write(LengthUnit unit) { return unit == LengthUnit::unknown ? Json() : Json(symbol(unit)); }
    static void read(const Json& json, LengthUnit& unit);
    static Json schema();
};

/// As people write it.
template <class Quantity>
struct QuantityForm {
    static Json write(const Quantity& quantity) { return quantity.text(); }
    static void read(const Json& json, Quantity& quantity) {
        std::string text;
        JsonForm<std::string>::read(json, text);
        quantity = Quantity::parse(text);
    }
    static Json schema() { return schema::type("string"); }
};
template <>
struct JsonForm<Length> : QuantityForm<Length> {};
template <>
struct JsonForm<Angle> : QuantityForm<Angle> {};
template <>
struct JsonForm<Ratio> : QuantityForm<Ratio> {};

/// Numbers, true and false; counts are integers, and a number that is not finite is null.
template <>
struct JsonByName<Metrics> {
    static Json write(const Metrics& metrics);
    static Json schema();
};

/// Throws Error for text that is not JSON (with the line), a key that is twice in one object, and nesting deeper than
/// 16 levels.
Json parse_document(std::string_view text);

/// Throws Error unless the document is an object with "scanmill": 1 and no keys but `known`.
void require_document(const Json& document, const std::vector<std::string>& known);
/// Throws Error unless the object has no keys but `known`. `place` begins the message.
void require_keys(const Json& object, const std::string& place, const std::vector<std::string>& known);

/// The member, or null if there is none.
const Json& member(const Json& object, std::string_view key);
/// The member as text; empty if there is none or it is null. Throws Error for another type.
std::string text_member(const Json& object, std::string_view key, const std::string& place);
/// The member `unit`; unknown if it is null or absent. Throws Error for any other text than a unit's symbol.
LengthUnit unit_member(const Json& document);
/// The member as a list. Throws Error for another type.
const Json& list_member(const Json& object, std::string_view key, const std::string& place);

/// Throws Error unless `list` is a list of `count` numbers. `what` begins the message: "pose 2: 'rotation'".
std::vector<double> numbers_of(const Json& list, std::size_t count, const std::string& what);
Vec3 vector_of(const Json& list, const std::string& what);

/// The symbol; null if the unit is unknown.
Json unit_json(LengthUnit unit);
Json json_of(const Vec3& vector);
/// Names and values; a value that is not finite is null.
inline Json metrics_json(const Metrics& metrics) { return JsonByName<Metrics>::write(metrics); }

}  // namespace scanmill
