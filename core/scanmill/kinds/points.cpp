// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/points.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/geometry/spatial/spacing.hpp"
#include "scanmill/kinds/field_visitor.hpp"

namespace scanmill {

void KindTraits<PointCloud>::visit(FieldVisitor& visitor, PointCloud& cloud) {
    visitor.frame("frame", cloud.frame);
    visitor.positions("positions", cloud.positions);
    visitor.columns("columns", cloud.columns);
}

BoundingBox KindTraits<PointCloud>::box(const PointCloud& cloud) { return bounding_box(cloud.positions.span()); }

double KindTraits<PointCloud>::spacing(const PointCloud& cloud) { return point_spacing(cloud.positions.span()); }

std::vector<PropertySpec> KindTraits<PointCloud>::property_specs() { return {{"points", Unit::count, "Points."}}; }

Metrics KindTraits<PointCloud>::properties(const PointCloud& cloud) {
    Metrics properties;
    properties.set("points", static_cast<double>(cloud.size()), Unit::count);
    return properties;
}

void KindTraits<PointCloud>::require_usable(const PointCloud& cloud) {
    if (cloud.size() == 0) throw Error("the result has no points");
}

}  // namespace scanmill
