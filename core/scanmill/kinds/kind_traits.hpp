// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The traits of a kind, which contain everything that the framework needs, and the visitor of an object's fields.

#include <concepts>
#include <nlohmann/json_fwd.hpp>

#include "scanmill/data/spacing.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

template <class T>
struct JsonForm;

/// Visits every field of an object of any kind, to read or to change it. The meaning in a field's description decides
/// which function is called for the field. A visitor that moves an object changes positions and directions, a visitor
/// that converts units changes lengths, a visitor that stores the object takes all fields. The functions of this class
/// change nothing.
class FieldVisitor {
public:
    virtual ~FieldVisitor() = default;

    virtual void frame(const char* /*name*/, Frame&) {}
    /// Positions relative to the frame's origin.
    virtual void positions(const char* /*name*/, Buffer<Vec3>&) {}
    /// Unit vectors; zero if there is no direction.
    virtual void directions(const char* /*name*/, Buffer<Vec3>&) {}
    /// Lengths raised to `exponent`.
    virtual void lengths(const char* /*name*/, Buffer<double>&, int /*exponent*/) {}
    virtual void columns(const char* /*name*/, ColumnTable&) {}
    /// Numbers that neither a motion nor a unit changes: indices, labels.
    template <class T>
    void plain(const char* name, Buffer<T>& elements) {
        Buffer<std::byte> bytes(elements.owner(), reinterpret_cast<const std::byte*>(elements.data()),
                                elements.size() * sizeof(T));
        bytes_of(name, bytes, sizeof(T));
        elements = Buffer<T>(bytes.owner(), reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T));
    }
    /// A small field with a JSON form, which neither a motion nor a unit changes.
    template <class T>
    void small(const char* name, T& field) {
        auto json = JsonForm<T>::write(field);
        if (json_of(name, json)) JsonForm<T>::read(json, field);
    }

private:
    virtual void bytes_of(const char* /*name*/, Buffer<std::byte>&, std::size_t /*element*/) {}
    /// Returns true if it replaced the JSON.
    virtual bool json_of(const char* /*name*/, nlohmann::ordered_json&) { return false; }
};

/// Visits an array as its field's description states.
template <class T>
void visit_array(FieldVisitor& visitor, const char* name, const auto& field, Buffer<T>& elements) {
    if constexpr (std::same_as<T, Vec3>) {
        if (field.meaning == Meaning::position) return visitor.positions(name, elements);
        if (field.meaning == Meaning::direction) return visitor.directions(name, elements);
    }
    if constexpr (std::same_as<T, double> || std::same_as<T, PatchWeights>)
        if (field.meaning == Meaning::length) {
            constexpr std::size_t each = sizeof(T) / sizeof(double);
            Buffer<double> numbers(elements.owner(), reinterpret_cast<const double*>(elements.data()),
                                   each * elements.size());
            visitor.lengths(name, numbers, field.exponent);
            elements = Buffer<T>(numbers.owner(), reinterpret_cast<const T*>(numbers.data()), numbers.size() / each);
            return;
        }
    visitor.plain(name, elements);
}

/// Whether visit_rows() visits the members of this type as one small field: texts, structs and optional numbers.
template <class Member>
concept SmallInRows =
    std::same_as<Member, std::string> || Described<Member> || requires(const Member& member) { member.has_value(); };

/// Visits a list of structs field by field. The members of all rows form one array, or one small field; lists of
/// positions are concatenated.
template <Described Row>
void visit_rows(FieldVisitor& visitor, const std::string& prefix, std::vector<Row>& rows) {
    for_each_field<Row>([&](const auto& field) {
        using Member = typename std::remove_cvref_t<decltype(field)>::Member;
        using Element = std::conditional_t<std::same_as<Member, bool>, u8, Member>;
        const std::string name = prefix + "." + field.name;
        if constexpr (SmallInRows<Member>) {
            std::vector<Member> members;
            for (const Row& row : rows) members.push_back(row.*field.member);
            visitor.small(name.c_str(), members);
            rows.resize(members.size());
            for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*field.member = members[i];
        } else if constexpr (std::same_as<Member, Array<Vec3>>) {
            Array<u32> sizes;
            Array<Vec3> all;
            for (const Row& row : rows) {
                sizes.push_back(static_cast<u32>((row.*field.member).size()));
                all.insert(all.end(), (row.*field.member).begin(), (row.*field.member).end());
            }
            Buffer<u32> visited_sizes(std::move(sizes));
            Buffer<Vec3> visited_all(std::move(all));
            visitor.plain((name + ".sizes").c_str(), visited_sizes);
            visit_array(visitor, name.c_str(), field, visited_all);
            rows.resize(visited_sizes.size());
            const Vec3* next = visited_all.begin();
            for (std::size_t i = 0; i < rows.size(); next += visited_sizes[i++])
                (rows[i].*field.member).assign(next, next + visited_sizes[i]);
        } else {
            Array<Element> elements;
            for (const Row& row : rows) elements.push_back(row.*field.member);
            Buffer<Element> visited_elements(std::move(elements));
            visit_array(visitor, name.c_str(), field, visited_elements);
            rows.resize(visited_elements.size());
            for (std::size_t i = 0; i < rows.size(); ++i)
                rows[i].*field.member = static_cast<Member>(visited_elements[i]);
        }
    });
}

template <Described T>
void visit_fields(FieldVisitor& visitor, T& object) {
    for_each_field<T>([&](const auto& field) {
        auto& member = object.*field.member;
        using Member = std::remove_cvref_t<decltype(member)>;
        if constexpr (std::same_as<Member, Frame>) {
            visitor.frame(field.name, member);
        } else if constexpr (std::same_as<Member, ColumnTable>) {
            visitor.columns(field.name, member);
        } else if constexpr (requires { visit_array(visitor, field.name, field, member); }) {
            visit_array(visitor, field.name, field, member);
        } else if constexpr (requires { visit_rows(visitor, field.name, member); }) {
            visit_rows(visitor, field.name, member);
        } else if constexpr (std::same_as<Member, double> || std::same_as<Member, Vec3>) {
            Buffer<Member> one{member};
            visit_array(visitor, field.name, field, one);
            if (!one.empty()) member = one[0];
        } else {
            visitor.small(field.name, member);
        }
    });
}

/// Specialised for every kind. The kind's type has fields() with their meanings. A specialisation that lacks a member
/// does not compile. The bases below, and HasDocument (document.hpp), provide members for common cases.
///
///     template <>
///     struct KindTraits<PointCloud> : FromPositions<PointCloud>, NoJson<PointCloud> {
///         static constexpr std::string_view name = "points";
///         /// Counts and topology that `expect` may test and summaries show.
///         static std::vector<PropertySpec> property_specs();
///         /// In the order of property_specs(); nullopt for a property that is not defined.
///         static std::vector<std::optional<double>> property_values(const PointCloud& cloud);
///         /// Throws Error if a filter's result of this kind is empty or inconsistent.
///         static void require_usable(const PointCloud& cloud);
///     };
template <class T>
struct KindTraits;

/// Members of the traits of types with a frame and positions.
template <class T>
struct FromPositions {
    static constexpr bool is_geometric = true;
    /// The box whose diagonal `%diag` refers to, and the length that `spacing` refers to.
    static RobustBox box(const T& object) { return bounding_box(object.positions.span()); }
    static double spacing(const T& object) { return point_spacing(object.positions.span()); }
};
/// Members of the traits of types without positions.
template <class T>
struct NotGeometric {
    static constexpr bool is_geometric = false;
    static RobustBox box(const T&) { return {}; }
    static double spacing(const T&) { return 0; }
};
/// Members of the traits of types without properties. Every object of such a type is usable.
template <class T>
struct NoProperties {
    static std::vector<PropertySpec> property_specs() { return {}; }
    static std::vector<std::optional<double>> property_values(const T&) { return {}; }
    static void require_usable(const T&) {}
};
/// Members of the traits of types without a JSON form. In other traits, `json_member` is the name of a member that only
/// documents of this kind have.
template <class T>
struct NoJson {
    static constexpr std::string_view json_member = "";
    static void to_json(const T&, nlohmann::ordered_json&) {}
    static T from_json(const nlohmann::ordered_json&, const OnWarning&) { return {}; }
    static constexpr nlohmann::ordered_json (*schema)() = nullptr;
};

Metrics metrics_from(const std::vector<PropertySpec>& specs, const std::vector<std::optional<double>>& values);

template <class T>
inline constexpr KindInfo kind_info{
    KindTraits<T>::name,
    KindTraits<T>::is_geometric,
    []() -> std::shared_ptr<void> { return std::make_shared<T>(); },
    [](const void* object) -> std::shared_ptr<void> { return std::make_shared<T>(*static_cast<const T*>(object)); },
    [](FieldVisitor& visitor, void* object) { visit_fields(visitor, *static_cast<T*>(object)); },
    [](const void* object) -> RobustBox { return KindTraits<T>::box(*static_cast<const T*>(object)); },
    [](const void* object) { return KindTraits<T>::spacing(*static_cast<const T*>(object)); },
    &KindTraits<T>::property_specs,
    [](const void* object) {
        return metrics_from(KindTraits<T>::property_specs(),
                            KindTraits<T>::property_values(*static_cast<const T*>(object)));
    },
    [](const void* object) { KindTraits<T>::require_usable(*static_cast<const T*>(object)); },
    KindTraits<T>::json_member,
    [](const void* object, nlohmann::ordered_json& document) {
        KindTraits<T>::to_json(*static_cast<const T*>(object), document);
    },
    [](const nlohmann::ordered_json& document, const OnWarning& warn) -> std::shared_ptr<void> {
        return std::make_shared<T>(KindTraits<T>::from_json(document, warn));
    },
    KindTraits<T>::schema};

template <class T>
Kind kind_of() {
    return Kind(kind_info<T>);
}
// Each kind_of<Type>() is instantiated in the source file that defines KindTraits<Type>.
#define SCANMILL_DECLARE_KIND(Type) \
    struct Type;                    \
    extern template Kind kind_of<Type>();
SCANMILL_ALL_KINDS(SCANMILL_DECLARE_KIND)
#undef SCANMILL_DECLARE_KIND

}  // namespace scanmill
