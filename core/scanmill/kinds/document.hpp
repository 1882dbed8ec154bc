// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The common parts of the JSON forms of all kinds.
///
/// A document is an object with `"scanmill": 1`, a `unit` and the member that identifies its kind. Errors do not
/// contain messages of the JSON library.

#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/metrics.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/kinds/kind_traits.hpp"
#include "scanmill/record/json.hpp"

namespace scanmill {

// JSON forms of small types.

/// A kind's name.
template <>
struct JsonForm<Kind> {
    static Json write(Kind kind) { return kind.name(); }
    static void read(const Json& json, Kind& kind);
    static Json schema() { return schema::type("string"); }
};

/// A unit's symbol; null if unknown.
template <>
struct JsonForm<LengthUnit> {
    static Json write(LengthUnit unit) { return unit == LengthUnit::unknown ? Json() : Json(symbol(unit)); }
    static void read(const Json& json, LengthUnit& unit);
    static Json schema();
};

/// A quantity as people write it.
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

/// An object with a number, true or false for each metric. Counts are integers. A number that is not finite is null.
template <>
struct JsonByName<Metrics> {
    static Json write(const Metrics& metrics);
    /// All metrics get the unit `number`.
    static void read(const Json& json, Metrics& metrics);
    static Json schema();
};
/// The names and values of metrics, without units.
inline Json metrics_json(const Metrics& metrics) { return JsonByName<Metrics>::write(metrics); }

/// Parses JSON. Throws Error for text that is not JSON (with the line), a number that is too large, a key that occurs
/// twice in one object, and nesting deeper than 16 levels.
Json parse_document(std::string_view text);

/// A whole document: "scanmill": 1 and the members of a described struct.
template <Described Document>
Json document_of(const Document& content) {
    Json json{{"scanmill", 1}};
    JsonForm<Document>::write_members(json, content);
    return json;
}

/// Throws Error unless the document is an object with "scanmill": 1.
void require_document(const Json& document);

/// Reads a whole document. Throws Error under the conditions of require_document() and read_json().
template <Described Document>
Document from_document(const Json& json) {
    require_document(json);
    Document content{};
    try {
        require_known(json, JsonForm<Document>::names({"scanmill"}));
        JsonForm<Document>::read_members(json, content);
    } catch (const JsonMismatch& mismatch) {
        throw_mismatch(mismatch, "the document");
    }
    return content;
}

/// Move the frame's origin of an object: use_world_origin() to 0, use_near_origin() to a point relative to which all
/// positions are exact. World coordinates do not change.
void use_world_origin(Kind kind, void* object);
void use_near_origin(Kind kind, void* object);

/// Members of the traits of types with a JSON form. `Document` is a described struct; KindTraits<T>::document() makes
/// it from an object in world coordinates. KindTraits<T>::object() makes the object from it.
template <class T, Described Document>
struct HasDocument {
    static void to_json(const T& object, Json& json) {
        T world = object;
        use_world_origin(kind_of<T>(), &world);
        json = document_of<Document>(KindTraits<T>::document(world));
    }
    static T from_json(const Json& json, const OnWarning&) {
        T object = KindTraits<T>::object(from_document<Document>(json));
        use_near_origin(kind_of<T>(), &object);
        return object;
    }
    static Json schema() { return schema::document(KindTraits<T>::name, JsonForm<Document>::schema()); }
};

}  // namespace scanmill
