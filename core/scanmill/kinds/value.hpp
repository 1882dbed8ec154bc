// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kinds that flow between steps, as one type.
///
/// A Value is a shared, immutable object of one of the kinds. Adding a kind means: its header here, one line in the
/// Value variant and one in kind_names (value.cpp); everything else follows from the variant.

#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/metrics.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/data/transform.hpp"

namespace scanmill {

using Value = std::variant<std::shared_ptr<const PointCloud>, std::shared_ptr<const TriangleMesh>,
                           std::shared_ptr<const TetMesh>, std::shared_ptr<const FeatureGraph>,
                           std::shared_ptr<const RigidTransform>, std::shared_ptr<const Metrics>>;

/// In the order of Value's alternatives.
enum class Kind { points, mesh, tets, features, transform, metrics };

std::string_view name_of(Kind kind);
std::optional<Kind> kind_named(std::string_view name);
/// "points, mesh, tets, features, transform, metrics", for messages.
std::string_view kind_names();

inline Kind kind_of(const Value& value) { return static_cast<Kind>(value.index()); }

/// The kind whose object type is T: `kind_of<PointCloud>()`.
template <class T>
consteval Kind kind_of() {
    return []<class... Pointers>(const std::variant<Pointers...>*) {
        std::size_t index = 0;
        const bool found = ((std::is_same_v<Pointers, std::shared_ptr<const T>> || (++index, false)) || ...);
        return found ? static_cast<Kind>(index) : throw "not one of the kinds that flow";
    }(static_cast<const Value*>(nullptr));
}

/// Whether the value has positions in space, and so a frame and a length scale.
bool is_geometric(Kind kind);
/// nullptr for transform and metrics.
const Frame* frame_of(const Value& value);
/// The same geometry in another frame: `frame.origin` moves and positions move against it; unit and name are set, not
/// converted. Values without positions come back as they are.
Value reframed(const Value& value, const Frame& frame);

}  // namespace scanmill
