// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `points`.

#include "scanmill/data/points.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

template <>
struct KindTraits<PointCloud> : NoJson<PointCloud> {
    static constexpr std::string_view name = "points";
    static constexpr bool is_geometric = true;
    static void visit(FieldVisitor& visitor, PointCloud& cloud);
    static BoundingBox box(const PointCloud& cloud);
    static double spacing(const PointCloud& cloud);
    static std::vector<PropertySpec> property_specs();
    static Metrics properties(const PointCloud& cloud);
    static void require_usable(const PointCloud& cloud);
};
inline const KindRegistration<PointCloud> points_kind;

}  // namespace scanmill
