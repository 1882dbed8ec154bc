// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kinds of values that flow between steps, and everything the framework needs to know about one.
///
/// A kind is a C++ type with a specialisation of KindTraits, in one header of this folder. all_kinds.hpp lists these
/// headers. To add a kind, write its type and its traits header and add one line to all_kinds.hpp: cache, JSON, wiring,
/// `info`, poses and units follow from the traits. A missing member of KindTraits does not compile.
///
///     template <>
///     struct KindTraits<PointCloud> {
///         static constexpr std::string_view name = "points";
///         /// Whether values have a frame and positions.
///         static constexpr bool is_geometric = true;
///         /// Hands every part of the object to the visitor: cache, frames, poses and units are visitors.
///         static void visit(FieldVisitor& visitor, PointCloud& cloud);
///         /// What `%diag` refers to, and `spacing`. Pre: is_geometric.
///         static BoundingBox box(const PointCloud& cloud);
///         static double spacing(const PointCloud& cloud);
///         /// Counts and topology that `expect` may ask for and summaries show.
///         static std::vector<PropertySpec> property_specs();
///         static Metrics properties(const PointCloud& cloud);
///         /// Throws Error when a filter's result of this kind is empty or contradicts itself.
///         static void require_usable(const PointCloud& cloud);
///         /// The JSON form. `json_member` is the member that only documents of this kind have; empty: no JSON form.
///         static constexpr std::string_view json_member = "";
///         static void to_json(const PointCloud& cloud, Json& document);
///         static PointCloud from_json(const Json& document, const OnWarning& warn);
///     };

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/bounds.hpp"
#include "scanmill/data/metrics.hpp"

namespace scanmill {

class FieldVisitor;

/// A number that is true of a value whatever filter made it.
struct PropertySpec {
    std::string name;
    Unit unit = Unit::number;
    std::string help;
};

using OnWarning = std::function<void(std::string sentence)>;

template <class T>
struct KindTraits;

/// Base of the traits of kinds without a JSON form.
template <class T>
struct NoJson {
    static constexpr std::string_view json_member = "";
    static void to_json(const T&, nlohmann::ordered_json&) {}
    static T from_json(const nlohmann::ordered_json&, const OnWarning&) { return {}; }
};
/// Base of the traits of kinds without positions.
template <class T>
struct NotGeometric {
    static constexpr bool is_geometric = false;
    static BoundingBox box(const T&) { return {}; }
    static double spacing(const T&) { return 0; }
    static std::vector<PropertySpec> property_specs() { return {}; }
    static Metrics properties(const T&) { return {}; }
    static void require_usable(const T&) {}
};

/// KindTraits of one type as functions of untyped objects.
struct KindInfo {
    std::string_view name;
    bool is_geometric;
    std::shared_ptr<void> (*make)();
    std::shared_ptr<void> (*copy)(const void* object);  ///< shares its arrays
    void (*visit)(FieldVisitor& visitor, void* object);
    BoundingBox (*box)(const void* object);
    double (*spacing)(const void* object);
    std::vector<PropertySpec> (*property_specs)();
    Metrics (*properties)(const void* object);
    void (*require_usable)(const void* object);
    std::string_view json_member;
    void (*to_json)(const void* object, nlohmann::ordered_json& document);
    std::shared_ptr<void> (*from_json)(const nlohmann::ordered_json& document, const OnWarning& warn);
};

template <class T>
inline constexpr KindInfo kind_info{
    KindTraits<T>::name,
    KindTraits<T>::is_geometric,
    []() -> std::shared_ptr<void> { return std::make_shared<T>(); },
    [](const void* object) -> std::shared_ptr<void> { return std::make_shared<T>(*static_cast<const T*>(object)); },
    [](FieldVisitor& visitor, void* object) { KindTraits<T>::visit(visitor, *static_cast<T*>(object)); },
    [](const void* object) { return KindTraits<T>::box(*static_cast<const T*>(object)); },
    [](const void* object) { return KindTraits<T>::spacing(*static_cast<const T*>(object)); },
    &KindTraits<T>::property_specs,
    [](const void* object) { return KindTraits<T>::properties(*static_cast<const T*>(object)); },
    [](const void* object) { KindTraits<T>::require_usable(*static_cast<const T*>(object)); },
    KindTraits<T>::json_member,
    [](const void* object, nlohmann::ordered_json& document) {
        KindTraits<T>::to_json(*static_cast<const T*>(object), document);
    },
    [](const nlohmann::ordered_json& document, const OnWarning& warn) -> std::shared_ptr<void> {
        return std::make_shared<T>(KindTraits<T>::from_json(document, warn));
    }};

/// Names one kind. Kinds are equal when their names are.
class Kind {
public:
    /// The kind `points`.
    Kind();
    explicit constexpr Kind(const KindInfo& info) : info_(&info) {}

    std::string_view name() const { return info_->name; }
    const KindInfo& info() const { return *info_; }
    bool has_json() const { return !info_->json_member.empty(); }
    friend bool operator==(Kind a, Kind b) { return a.info_ == b.info_ || a.name() == b.name(); }

private:
    const KindInfo* info_;
};

/// The kind whose objects are of type T: `kind_of<PointCloud>()`.
template <class T>
Kind kind_of() {
    return Kind(kind_info<T>);
}

inline std::string_view name_of(Kind kind) { return kind.name(); }
/// Every kind, in the order of all_kinds.hpp.
std::vector<Kind> all_kinds();
std::optional<Kind> kind_named(std::string_view name);
/// "points, mesh, tets, features, transform, metrics", for messages.
std::string kind_names();

/// Adds a kind to all_kinds(); a second one of the same name is ignored.
void register_kind(Kind kind);
template <class T>
struct KindRegistration {
    KindRegistration() { register_kind(kind_of<T>()); }
};

}  // namespace scanmill
