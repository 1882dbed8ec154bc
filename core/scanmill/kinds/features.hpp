// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `features`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "part",
///      "polylines": [{"type": "crease", "closed": false, "points": [[0, 0, 0], [0, 1, 0]],
///                     "left-normals": [[0, 0, 1]], "right-normals": [[1, 0, 0]]}, …],
///      "corners": [[0, 0, 0], [0, 1, 0]]}
///
/// `type` is outer boundary, hole or crease, as in VTP. Points are world coordinates; a closed polyline does not repeat
/// its first point. Normals belong to segments, one each, in order; the last segment of a closed polyline leads back to
/// its first point. A normal is null where there is no surface. `unit` and `frame` are null when unknown. Vertices that
/// neither a polyline nor a corner uses are left out. Reading joins equal points into one vertex, in order of their
/// first use.

#include "scanmill/data/features.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

template <>
struct KindTraits<FeatureGraph> {
    static constexpr std::string_view name = "features";
    static constexpr bool is_geometric = true;
    static void visit(FieldVisitor& visitor, FeatureGraph& graph);
    static BoundingBox box(const FeatureGraph& graph);
    static double spacing(const FeatureGraph& graph);
    static std::vector<PropertySpec> property_specs() { return {}; }
    static Metrics properties(const FeatureGraph&) { return {}; }
    /// A closed, smooth mesh has no features.
    static void require_usable(const FeatureGraph&) {}
    static constexpr std::string_view json_member = "polylines";
    static void to_json(const FeatureGraph& graph, nlohmann::ordered_json& document);
    static FeatureGraph from_json(const nlohmann::ordered_json& document, const OnWarning& warn);
};
inline const KindRegistration<FeatureGraph> features_kind;

}  // namespace scanmill
