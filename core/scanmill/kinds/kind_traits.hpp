// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Everything the framework needs of a kind, in one class; and the visitor of an object's fields.

#include <nlohmann/json.hpp>

#include "scanmill/data/spacing.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// Visits every field of an object of any kind, to read or to change it. KindTraits<T>::visit() calls one function per
/// field and so states what the field means: a visitor that moves an object changes positions and directions, one that
/// converts units changes lengths, one that stores the object takes everything. By default nothing changes.
class FieldVisitor {
public:
    virtual ~FieldVisitor() = default;

    virtual void frame(const char* /*name*/, Frame&) {}
    /// Relative to the frame's origin.
    virtual void positions(const char* /*name*/, Buffer<Vec3>&) {}
    /// Unit vectors, or zero.
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
        nlohmann::json json = field;
        if (json_of(name, json)) field = json.get<T>();
    }

private:
    virtual void bytes_of(const char* /*name*/, Buffer<std::byte>&, std::size_t /*element*/) {}
    /// True if it replaced the JSON.
    virtual bool json_of(const char* /*name*/, nlohmann::json&) { return false; }
};

/// Specialised for every kind. A missing member does not compile; the bases below provide members for common cases.
///
///     template <>
///     struct KindTraits<PointCloud> : FromPositions<PointCloud>, NoJson<PointCloud> {
///         static constexpr std::string_view name = "points";
///         static void visit(FieldVisitor& visitor, PointCloud& cloud);
///         /// Counts and topology that `expect` may test and summaries show.
///         static std::vector<PropertySpec> property_specs();
///         /// In the order of property_specs(); empty where a property is not defined.
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
/// Members of the traits of types without properties, of which every object is usable.
template <class T>
struct NoProperties {
    static std::vector<PropertySpec> property_specs() { return {}; }
    static std::vector<std::optional<double>> property_values(const T&) { return {}; }
    static void require_usable(const T&) {}
};
/// Members of the traits of types without a JSON form. `json_member` is a member that only documents of a kind have.
template <class T>
struct NoJson {
    static constexpr std::string_view json_member = "";
    static void to_json(const T&, nlohmann::ordered_json&) {}
    static T from_json(const nlohmann::ordered_json&, const OnWarning&) { return {}; }
};

Metrics metrics_from(const std::vector<PropertySpec>& specs, const std::vector<std::optional<double>>& values);

template <class T>
inline constexpr KindInfo kind_info{
    KindTraits<T>::name,
    KindTraits<T>::is_geometric,
    []() -> std::shared_ptr<void> { return std::make_shared<T>(); },
    [](const void* object) -> std::shared_ptr<void> { return std::make_shared<T>(*static_cast<const T*>(object)); },
    [](FieldVisitor& visitor, void* object) { KindTraits<T>::visit(visitor, *static_cast<T*>(object)); },
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
    }};

template <class T>
Kind kind_of() {
    return Kind(kind_info<T>);
}
// Instantiated in the source files with the traits.
#define SCANMILL_DECLARE_KIND(Type) \
    struct Type;                    \
    extern template Kind kind_of<Type>();
SCANMILL_ALL_KINDS(SCANMILL_DECLARE_KIND)
#undef SCANMILL_DECLARE_KIND

}  // namespace scanmill

namespace nlohmann {

/// A vector or matrix as a list of numbers, column by column.
template <int rows, int columns>
struct adl_serializer<Eigen::Matrix<double, rows, columns>> {
    static void to_json(json& value, const Eigen::Matrix<double, rows, columns>& matrix) {
        value = std::vector<double>(matrix.data(), matrix.data() + matrix.size());
    }
    static void from_json(const json& value, Eigen::Matrix<double, rows, columns>& matrix) {
        for (int i = 0; i < rows * columns; ++i) matrix.data()[i] = value.at(static_cast<std::size_t>(i)).get<double>();
    }
};

}  // namespace nlohmann
