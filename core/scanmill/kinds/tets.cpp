// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/tets.hpp"

#include "scanmill/geometry/spatial/spacing.hpp"
#include "scanmill/kinds/field_visitor.hpp"

namespace scanmill {

void KindTraits<TetMesh>::visit(FieldVisitor& visitor, TetMesh& tets) {
    visitor.frame("frame", tets.frame);
    visitor.positions("positions", tets.positions);
    visitor.columns("vertex-columns", tets.vertex_columns);
    visitor.lengths("weights", tets.weights, 2);
    visitor.plain("cells", tets.cells);
    visitor.plain("neighbours", tets.neighbours);
    visitor.plain("inside", tets.inside);
}

BoundingBox KindTraits<TetMesh>::box(const TetMesh& tets) { return bounding_box(tets.positions.span()); }

double KindTraits<TetMesh>::spacing(const TetMesh& tets) { return point_spacing(tets.positions.span()); }

std::vector<PropertySpec> KindTraits<TetMesh>::property_specs() {
    return {{"points", Unit::count, "Vertices."}, {"cells", Unit::count, "Tetrahedra."}};
}

Metrics KindTraits<TetMesh>::properties(const TetMesh& tets) {
    Metrics properties;
    properties.set("points", static_cast<double>(tets.positions.size()), Unit::count);
    properties.set("cells", static_cast<double>(tets.cells.size()), Unit::count);
    return properties;
}

}  // namespace scanmill
