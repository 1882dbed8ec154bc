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
#include "scanmill/kinds/kind_traits.hpp"
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
    /// The unit of all is number.
    static void read(const Json& json, Metrics& metrics);
    static Json schema();
};
/// Names and values.
inline Json metrics_json(const Metrics& metrics) { return JsonByName<Metrics>::write(metrics); }

/// Throws Error for text that is not JSON (with the line), a key that is twice in one object, and nesting deeper than
/// 16 levels.
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

/// Throws Error as require_document() and read_json().
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

/// Moves the frame's origin of an object to 0, and to a point from which all positions are exact. The positions keep
/// their world coordinates.
void use_world_origin(Kind kind, void* object);
void use_near_origin(Kind kind, void* object);

/// Members of the traits of types with a JSON form. `Document` is a described struct; KindTraits<T>::document() makes
/// it from an object in world coordinates, and KindTraits<T>::object() the object from it.
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
