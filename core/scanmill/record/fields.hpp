// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The description of a struct's members, written once beside the struct:
///
///     struct Effort {
///         double seconds = 0;
///         u64 peak_memory = 0;
///     };
///     constexpr auto fields(const Effort*) {
///         return std::tuple{field("seconds", &Effort::seconds, "Wall-clock time.").unit("s"),
///                           field("peak-memory", &Effort::peak_memory, "Largest resident size.").unit("bytes")};
///     }
///
/// Messages, JSON, JSON Schema (json.hpp), the columns of tables and the fields of kinds derive from it. The function
/// is found by its argument's namespace. A derived struct joins its base's fields to its own with std::tuple_cat.

#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string_view>
#include <tuple>

namespace scanmill {

/// How numbers change if the frame changes by a motion, a shift of its origin or another unit.
enum class Meaning {
    plain,      ///< they do not change
    position,   ///< a point relative to the frame's origin; JSON has world coordinates
    direction,  ///< a unit vector, or zero; a motion rotates it
    length      ///< another unit scales it; not negative
};

template <class Owner, class Type>
struct Field {
    using Member = Type;

    const char* name;  ///< in lower case with hyphens
    Type Owner::*member;
    const char* doc;
    const char* unit_text = "";
    Meaning meaning = Meaning::plain;
    int exponent = 1;  ///< power of the length
    bool is_optional = false;
    bool is_nullable = false;
    bool is_flat = false;
    bool is_by_name = false;
    bool (*applies)(const Owner&) = nullptr;

    /// The unit of the number: "s", "bytes", "rad".
    constexpr Field unit(const char* text) const {
        Field field = *this;
        field.unit_text = text;
        return field;
    }
    constexpr Field means(Meaning what, int length_exponent = 1) const {
        Field field = *this;
        field.meaning = what;
        field.exponent = length_exponent;
        return field;
    }
    /// The member is absent in JSON if it has the value of a default-constructed object.
    constexpr Field optional() const {
        Field field = *this;
        field.is_optional = true;
        return field;
    }
    /// For a number that may be NaN, an index that may be the largest one, or a text that may be empty. JSON has null
    /// for these values. An absent member is read as null.
    constexpr Field nullable() const {
        Field field = *this;
        field.is_nullable = true;
        return field;
    }
    /// The member is a struct whose fields are written among those of its owner.
    constexpr Field flat() const {
        Field field = *this;
        field.is_flat = true;
        return field;
    }
    /// Metrics are written as an object of numbers by name, as results show them.
    constexpr Field by_name() const {
        Field field = *this;
        field.is_by_name = true;
        return field;
    }
    /// If the condition does not hold for an object, the member is null in JSON and is not changed by reading. The
    /// condition may use only fields without a condition.
    constexpr Field only_if(bool (*condition)(const Owner&)) const {
        Field field = *this;
        field.applies = condition;
        return field;
    }
};

template <class Owner, class Type>
constexpr Field<Owner, Type> field(const char* name, Type Owner::*member, const char* doc = "") {
    return {name, member, doc};
}

template <class T>
concept Described = requires { fields(static_cast<const T*>(nullptr)); };

/// Calls action(field) for every field, in order.
template <Described T, class Action>
constexpr void for_each_field(Action&& action) {
    std::apply([&](const auto&... each) { (action(each), ...); }, fields(static_cast<const T*>(nullptr)));
}

/// An enumeration without gaps, described by the names of its values from 0 on:
///
///     constexpr std::array<std::string_view, 2> names_of(const Outcome*) { return {"ok", "failed"}; }
template <class T>
concept Named = requires { names_of(static_cast<const T*>(nullptr)).size(); };

template <Named Enumeration>
constexpr std::string_view name_of(Enumeration value) {
    constexpr auto names = names_of(static_cast<const Enumeration*>(nullptr));
    return names[static_cast<std::size_t>(value)];
}

template <Named Enumeration>
constexpr std::optional<Enumeration> value_named(std::string_view name) {
    constexpr auto names = names_of(static_cast<const Enumeration*>(nullptr));
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return static_cast<Enumeration>(i);
    return std::nullopt;
}

}  // namespace scanmill
