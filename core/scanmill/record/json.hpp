// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Converts described structs (fields.hpp) to JSON and back, and makes their JSON Schema.
///
/// JsonForm<T> converts the type T. Numbers, texts, named enumerations, lists, optionals, variants and described
/// structs have their form here; other types have a specialisation beside the type. Messages and caches are CBOR of the
/// same form: NaN keeps its bits and texts need not be UTF-8. In JSON text, NaN is null.

#include <fmt/format.h>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "scanmill/record/fields.hpp"

namespace scanmill {

using Json = nlohmann::ordered_json;

/// Thrown for a value that does not have the form of its type. `path` leads to the member; `sentence` continues the
/// path: "'touches[3].phi' is not a number". read_json() throws an Error instead.
struct JsonMismatch {
    std::string path, sentence;

    /// The same mismatch with the path from the owner of the member `name`, or from the list of the item `index`.
    JsonMismatch in(std::string_view name) &&;
    JsonMismatch in(std::size_t index) &&;
};

template <class T>
struct JsonForm;

template <class T>
Json json_of(const T& value) {
    return JsonForm<T>::write(value);
}
/// Reads a value. Throws Error with the path of the first member that is missing, unknown or of another form. `subject`
/// begins the message: "the document".
template <class T>
void read_json(const Json& json, T& value, std::string_view subject = "the document");

[[noreturn]] void throw_mismatch(const JsonMismatch& mismatch, std::string_view subject);

/// The bytes of the value in CBOR.
std::string cbor_of(const Json& json);
/// Reads CBOR. Throws Error "… cannot be read" for other bytes.
Json json_from_cbor(std::string_view bytes, std::string_view subject);
/// The value as one line of JSON text. Bytes that are not UTF-8 are replaced.
std::string text_of(const Json& json);

// Parts of schemas (draft 7).

namespace schema {

inline Json type(const char* name) { return {{"type", name}}; }
inline Json list_of(Json item) { return {{"type", "array"}, {"items", std::move(item)}}; }
inline Json map_of(Json value) { return {{"type", "object"}, {"additionalProperties", std::move(value)}}; }
/// Adds a description: the text and, if not empty, the unit.
Json described(std::string_view text, std::string_view unit, Json schema);
/// The schema, extended to accept null.
Json or_null(Json schema);
Json names(std::span<const std::string_view> names);
/// A list of exactly `size` items.
Json tuple_of(std::size_t size, Json item);
/// The schema of an object without members. add() adds members; other members are refused.
Json object();
void add(Json& object, const std::string& name, Json schema, bool is_required = true);
/// The schema of a whole document: its title, `"scanmill": 1` and the members of `object`.
Json document(std::string_view title, const Json& object);

}  // namespace schema

// Forms.

void require_object(const Json& json);
void require_size(const Json& items, std::size_t size);
void require_known(const Json& object, const std::vector<std::string_view>& known);

template <class T>
void read_items(const Json& json, T* items) {
    std::size_t index = 0;
    try {
        for (; index < json.size(); ++index) JsonForm<T>::read(json[index], items[index]);
    } catch (JsonMismatch& mismatch) {
        throw std::move(mismatch).in(index);
    }
}

template <class T>
void read_member(const Json& json, std::string_view name, T& value) {
    try {
        JsonForm<T>::read(json, value);
    } catch (JsonMismatch& mismatch) {
        throw std::move(mismatch).in(name);
    }
}

template <>
struct JsonForm<bool> {
    static Json write(bool value) { return value; }
    static void read(const Json& json, bool& value) {
        if (!json.is_boolean()) throw JsonMismatch{{}, "is not true or false"};
        value = json.get<bool>();
    }
    static Json schema() { return schema::type("boolean"); }
};

template <std::integral T>
struct JsonForm<T> {
    static Json write(T value) { return value; }
    static void read(const Json& json, T& value) {
        constexpr T least = std::numeric_limits<T>::min(), most = std::numeric_limits<T>::max();
        const bool fits = json.is_number_unsigned()
                              ? std::in_range<T>(json.get<std::uint64_t>())
                              : json.is_number_integer() && std::in_range<T>(json.get<std::int64_t>());
        if (!fits) throw JsonMismatch{{}, fmt::format("is not a whole number from {} to {}", least, most)};
        value = json.get<T>();
    }
    static Json schema() {
        Json schema = schema::type("integer");
        if constexpr (std::unsigned_integral<T>) schema["minimum"] = 0;
        return schema;
    }
};

template <std::floating_point T>
struct JsonForm<T> {
    static Json write(T value) { return value; }
    static void read(const Json& json, T& value) {
        if (!json.is_number()) throw JsonMismatch{{}, "is not a number"};
        value = json.get<T>();
    }
    static Json schema() { return schema::type("number"); }
};

template <>
struct JsonForm<std::string> {
    static Json write(const std::string& value) { return value; }
    static void read(const Json& json, std::string& value) {
        if (!json.is_string()) throw JsonMismatch{{}, "is not a text"};
        value = json.get<std::string>();
    }
    static Json schema() { return schema::type("string"); }
};

template <>
struct JsonForm<std::filesystem::path> {
    static Json write(const std::filesystem::path& value) { return value.string(); }
    static void read(const Json& json, std::filesystem::path& value) {
        std::string text;
        JsonForm<std::string>::read(json, text);
        value = text;
    }
    static Json schema() { return schema::type("string"); }
};

std::string expected_names(std::span<const std::string_view> names, std::string_view found);

template <Named T>
struct JsonForm<T> {
    static Json write(T value) { return name_of(value); }
    static void read(const Json& json, T& value) {
        std::string name;
        JsonForm<std::string>::read(json, name);
        const std::optional<T> found = value_named<T>(name);
        if (!found) throw JsonMismatch{{}, expected_names(names_of(static_cast<const T*>(nullptr)), name)};
        value = *found;
    }
    static Json schema() { return schema::names(names_of(static_cast<const T*>(nullptr))); }
};

/// An enumeration without names is its number, for messages.
template <class T>
    requires(std::is_enum_v<T> && !Named<T>)
struct JsonForm<T> {
    static Json write(T value) { return static_cast<int>(value); }
    static void read(const Json& json, T& value) {
        int number = 0;
        JsonForm<int>::read(json, number);
        value = static_cast<T>(number);
    }
};

template <class T>
struct JsonForm<std::optional<T>> {
    static Json write(const std::optional<T>& value) { return value ? json_of(*value) : Json(); }
    static void read(const Json& json, std::optional<T>& value) {
        value.reset();
        if (!json.is_null()) JsonForm<T>::read(json, value.emplace());
    }
    static Json schema() { return schema::or_null(JsonForm<T>::schema()); }
};

template <class T, class Allocator>
struct JsonForm<std::vector<T, Allocator>> {
    static Json write(const std::vector<T, Allocator>& items) {
        Json json = Json::array();
        for (const T& item : items) json.push_back(json_of(item));
        return json;
    }
    static void read(const Json& json, std::vector<T, Allocator>& items) {
        if (!json.is_array()) throw JsonMismatch{{}, "is not a list"};
        items = std::vector<T, Allocator>(json.size());
        read_items<T>(json, items.data());
    }
    static Json schema() { return schema::list_of(JsonForm<T>::schema()); }
};

template <class T, std::size_t size>
struct JsonForm<std::array<T, size>> {
    static Json write(const std::array<T, size>& items) {
        Json json = Json::array();
        for (const T& item : items) json.push_back(json_of(item));
        return json;
    }
    static void read(const Json& json, std::array<T, size>& items) {
        require_size(json, size);
        read_items<T>(json, items.data());
    }
    static Json schema() { return schema::tuple_of(size, JsonForm<T>::schema()); }
};

template <class First, class Second>
struct JsonForm<std::pair<First, Second>> {
    static Json write(const std::pair<First, Second>& pair) {
        return Json::array({json_of(pair.first), json_of(pair.second)});
    }
    static void read(const Json& json, std::pair<First, Second>& pair) {
        require_size(json, 2);
        JsonForm<First>::read(json[0], pair.first);
        JsonForm<Second>::read(json[1], pair.second);
    }
};

/// A matrix is the list of its coefficients, column by column.
template <int rows, int columns>
struct JsonForm<Eigen::Matrix<double, rows, columns>> {
    using Matrix = Eigen::Matrix<double, rows, columns>;
    static Json write(const Matrix& matrix) {
        Json json = Json::array();
        for (const double number : matrix.reshaped()) json.push_back(number);
        return json;
    }
    static void read(const Json& json, Matrix& matrix) {
        require_size(json, static_cast<std::size_t>(matrix.size()));
        read_items<double>(json, matrix.data());
    }
    static Json schema() { return schema::tuple_of(rows * columns, JsonForm<double>::schema()); }
};

/// Pairs of names and values are an object, in the order of the pairs.
template <class T>
struct JsonForm<std::vector<std::pair<std::string, T>>> {
    using Pairs = std::vector<std::pair<std::string, T>>;
    static Json write(const Pairs& pairs) {
        Json json = Json::object();
        for (const auto& [name, value] : pairs) json[name] = json_of(value);
        return json;
    }
    static void read(const Json& json, Pairs& pairs) {
        require_object(json);
        pairs.clear();
        for (const auto& [name, value] : json.items()) read_member(value, name, pairs.emplace_back(name, T()).second);
    }
    static Json schema() { return schema::map_of(JsonForm<T>::schema()); }
};

/// An object of values by name.
template <class T>
struct JsonForm<std::map<std::string, T>> {
    static Json write(const std::map<std::string, T>& values) {
        Json json = Json::object();
        for (const auto& [name, value] : values) json[name] = json_of(value);
        return json;
    }
    static void read(const Json& json, std::map<std::string, T>& values) {
        require_object(json);
        values.clear();
        for (const auto& [name, value] : json.items()) read_member(value, name, values[name]);
    }
    static Json schema() { return schema::map_of(JsonForm<T>::schema()); }
};

template <class T>
struct JsonForm<std::shared_ptr<const T>> {
    static Json write(const std::shared_ptr<const T>& value) { return json_of(*value); }
    static void read(const Json& json, std::shared_ptr<const T>& value) {
        auto made = std::make_shared<T>();
        JsonForm<T>::read(json, *made);
        value = std::move(made);
    }
};

template <>
struct JsonForm<std::monostate> {
    static Json write(std::monostate) { return nullptr; }
    static void read(const Json&, std::monostate) {}
};

/// A variant is the list [index of the alternative, its value].
template <class... Types>
struct JsonForm<std::variant<Types...>> {
    static Json write(const std::variant<Types...>& value) {
        return std::visit([&](const auto& item) { return Json::array({value.index(), json_of(item)}); }, value);
    }
    static void read(const Json& json, std::variant<Types...>& value) {
        require_size(json, 2);
        std::size_t wanted = 0, index = 0;
        JsonForm<std::size_t>::read(json[0], wanted);
        const auto read_if_wanted = [&]<class Type>(Type item) {
            if (index++ != wanted) return;
            JsonForm<Type>::read(json[1], item);
            value = std::move(item);
        };
        (read_if_wanted(Types{}), ...);
        if (wanted >= index) throw JsonMismatch{{}, "has no such alternative"};
    }
    static Json schema() { return Json::object(); }
};

/// Types that results show as an object of numbers by name: Metrics.
template <class T>
struct JsonByName;

/// Throws JsonMismatch for a negative length, and for a direction whose length is not 1.
void require_meaning(Meaning meaning, double number);
void require_meaning(Meaning meaning, const Eigen::Vector3d& vector);

template <class T>
inline constexpr bool is_std_optional = false;
template <class T>
inline constexpr bool is_std_optional<std::optional<T>> = true;

/// The form of described structs. Positions must be world coordinates: the owner of the frame adds its origin before
/// writing and subtracts it after reading.
template <Described T>
struct FieldsForm {
    static Json write(const T& object) {
        Json json = Json::object();
        write_members(json, object);
        return json;
    }
    static void write_members(Json& json, const T& object) {
        for_each_field<T>([&](const auto& field) {
            const auto& member = object.*field.member;
            using Member = std::remove_cvref_t<decltype(member)>;
            if constexpr (Described<Member>)
                if (field.is_flat) return JsonForm<Member>::write_members(json, member);
            if (field.is_optional && is_default(field, member)) return;
            Json& value = json[field.name];
            if (field.applies && !field.applies(object)) return;  // `value` stays null
            if constexpr (requires { JsonByName<Member>::write(member); })
                if (field.is_by_name) {
                    value = JsonByName<Member>::write(member);
                    return;
                }
            if (field.is_nullable && is_undefined(member)) return;
            value = json_of(member);
        });
    }

    static void read(const Json& json, T& object) {
        require_object(json);
        require_known(json, names());
        read_members(json, object);
    }
    static void read_members(const Json& json, T& object) {
        for (const bool is_conditional : {false, true})
            for_each_field<T>([&](const auto& field) {
                if ((field.applies != nullptr) == is_conditional) read_member(field, json, object);
            });
    }
    /// Appends the names of all members to `known`.
    static std::vector<std::string_view> names(std::vector<std::string_view> known = {}) {
        for_each_field<T>([&](const auto& field) {
            using Member = MemberOf<decltype(field)>;
            if constexpr (Described<Member>)
                if (field.is_flat) {
                    known = JsonForm<Member>::names(std::move(known));
                    return;
                }
            known.push_back(field.name);
        });
        return known;
    }

    static Json schema() {
        Json object = schema::object();
        add_schemas(object);
        return object;
    }
    static void add_schemas(Json& object) {
        for_each_field<T>([&](const auto& field) {
            using Member = MemberOf<decltype(field)>;
            if constexpr (Described<Member>)
                if (field.is_flat) return JsonForm<Member>::add_schemas(object);
            Json form = JsonForm<Member>::schema();
            if constexpr (requires { JsonByName<Member>::schema(); })
                if (field.is_by_name) form = JsonByName<Member>::schema();
            if constexpr (is_std_optional<Member>)
                if (field.is_optional) form = JsonForm<typename Member::value_type>::schema();
            if (field.is_nullable || field.applies) form = schema::or_null(std::move(form));
            schema::add(object, field.name, schema::described(field.doc, field.unit_text, std::move(form)),
                        !field.is_optional && !field.is_nullable && !field.applies);
        });
    }

private:
    template <class Field>
    using MemberOf = typename std::remove_cvref_t<Field>::Member;

    static void read_member(const auto& field, const Json& json, T& object) {
        auto& member = object.*field.member;
        using Member = std::remove_cvref_t<decltype(member)>;
        if constexpr (Described<Member>)
            if (field.is_flat) return JsonForm<Member>::read_members(json, member);
        const auto found = json.find(field.name);
        const bool is_absent = found == json.end();
        if (is_absent && field.is_optional) {
            member = default_of(field);
            return;
        }
        if (is_absent && !field.is_nullable && !field.applies) throw JsonMismatch{field.name, "is missing"};
        static const Json null;
        try {
            read_value(field, is_absent ? null : *found, object);
        } catch (JsonMismatch& mismatch) {
            throw std::move(mismatch).in(field.name);
        }
    }
    static void read_value(const auto& field, const Json& json, T& object) {
        auto& member = object.*field.member;
        using Member = std::remove_cvref_t<decltype(member)>;
        if (field.applies && !field.applies(object)) {
            if (!json.is_null()) throw JsonMismatch{{}, "is not null, but does not apply here"};
            return;
        }
        if constexpr (std::default_initializable<Member>)
            if (field.is_nullable && json.is_null()) {
                member = undefined<Member>();
                return;
            }
        if constexpr (requires { JsonByName<Member>::read(json, member); })
            if (field.is_by_name) return JsonByName<Member>::read(json, member);
        if constexpr (is_std_optional<Member>)
            if (field.is_optional) return JsonForm<typename Member::value_type>::read(json, member.emplace());
        JsonForm<Member>::read(json, member);
        if constexpr (std::same_as<Member, double>)
            if (!field.is_nullable || member == member) require_meaning(field.meaning, member);
        if constexpr (std::same_as<Member, Eigen::Vector3d>) require_meaning(field.meaning, member);
    }

    /// The member of a default-constructed object.
    static const auto& default_of(const auto& field) {
        static const T object{};
        return object.*field.member;
    }
    template <class Member>
    static bool is_default(const auto& field, const Member& member) {
        if constexpr (requires { member.has_value(); })
            return !member.has_value();
        else if constexpr (requires { member.empty(); })
            return member.empty();
        else if constexpr (requires { member.values.empty(); })
            return member.values.empty();
        else if constexpr (requires { std::variant_size<Member>::value; })
            return false;
        else if constexpr (std::equality_comparable<Member>)
            return member == default_of(field);
        else
            return false;
    }
    template <class Member>
    static Member undefined() {
        if constexpr (std::floating_point<Member>) return std::numeric_limits<Member>::quiet_NaN();
        if constexpr (std::unsigned_integral<Member>) return std::numeric_limits<Member>::max();
        return Member();
    }
    /// Whether the value is written as null here. NaN stays NaN; only JSON text contains null for it.
    template <class Member>
    static bool is_undefined(const Member& member) {
        if constexpr (std::unsigned_integral<Member> || std::same_as<Member, std::string>)
            return member == undefined<Member>();
        else
            return false;
    }
};

template <Described T>
struct JsonForm<T> : FieldsForm<T> {};

template <class T>
void read_json(const Json& json, T& value, std::string_view subject) {
    try {
        JsonForm<T>::read(json, value);
    } catch (const JsonMismatch& mismatch) {
        throw_mismatch(mismatch, subject);
    }
}

template <class T>
T from_json(const Json& json, std::string_view subject = "the document") {
    T value{};
    read_json(json, value, subject);
    return value;
}

}  // namespace scanmill
