// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kinds of values that flow between steps.
///
/// A kind is a C++ type with a specialisation of KindTraits (kind_traits.hpp). To add a kind, write its type, its
/// traits in a source file of this folder, and its line in the list below: cache, JSON, wiring, `info`, poses and units
/// follow from the traits.

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/metrics.hpp"
#include "scanmill/data/robust_box.hpp"

namespace scanmill {

/// Every kind, in the order in which messages list them.
// clang-format off
#define SCANMILL_ALL_KINDS(KIND) \
    KIND(PointCloud)             \
    KIND(TriangleMesh)           \
    KIND(TetMesh)                \
    KIND(FeatureGraph)           \
    KIND(PatchComplex)           \
    KIND(ProbePlan)              \
    KIND(Transforms)             \
    KIND(Metrics)                \
    KIND(Picture)
// clang-format on

class FieldVisitor;

/// A number that every value of a kind has, whichever filter made it.
struct PropertySpec {
    std::string name;
    Unit unit = Unit::number;
    std::string help;
    Better better = Better::neither;
};

using OnWarning = std::function<void(std::string sentence)>;

/// KindTraits of one type as functions of untyped objects.
struct KindInfo {
    std::string_view name;
    bool is_geometric;
    std::shared_ptr<void> (*make)();
    std::shared_ptr<void> (*copy)(const void* object);  ///< the copy shares the object's arrays
    void (*visit)(FieldVisitor& visitor, void* object);
    RobustBox (*box)(const void* object);
    double (*spacing)(const void* object);
    std::vector<PropertySpec> (*property_specs)();
    Metrics (*properties)(const void* object);
    void (*require_usable)(const void* object);
    std::string_view json_member;
    void (*to_json)(const void* object, nlohmann::ordered_json& document);
    std::shared_ptr<void> (*from_json)(const nlohmann::ordered_json& document, const OnWarning& warn);
    nlohmann::ordered_json (*schema)();  ///< schema of the kind's documents; null without a JSON form
};

/// Identifies one kind. Two kinds are equal if their names are equal.
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

/// The kind whose objects are of type T: `kind_of<PointCloud>()`. Instantiated beside the kind's traits.
template <class T>
Kind kind_of();

inline std::string_view name_of(Kind kind) { return kind.name(); }
/// Every kind: points, mesh, tets, features, patches, probes, transform, metrics, picture, then the registered kinds.
std::vector<Kind> all_kinds();
std::optional<Kind> kind_named(std::string_view name);
/// "points, mesh, tets, features, patches, probes, transform, metrics, picture", for messages.
std::string kind_names();

/// Adds a kind to all_kinds(), for a module with its own kind. A second kind of the same name is ignored.
void register_kind(Kind kind);

}  // namespace scanmill
