// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/mesh.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/geometry/mesh/topology.hpp"
#include "scanmill/geometry/spatial/spacing.hpp"
#include "scanmill/kinds/field_visitor.hpp"

namespace scanmill {

void KindTraits<TriangleMesh>::visit(FieldVisitor& visitor, TriangleMesh& mesh) {
    visitor.frame("frame", mesh.frame);
    visitor.positions("positions", mesh.positions);
    visitor.plain("triangles", mesh.triangles);
    visitor.columns("vertex-columns", mesh.vertex_columns);
    visitor.columns("face-columns", mesh.face_columns);
    visitor.plain("edges", mesh.edges);
    visitor.columns("edge-columns", mesh.edge_columns);
    visitor.plain("sharp-edges", mesh.sharp_edges);
}

BoundingBox KindTraits<TriangleMesh>::box(const TriangleMesh& mesh) {
    return mesh.triangles.empty() ? bounding_box(mesh.positions.span()) : surface_box(mesh);
}

double KindTraits<TriangleMesh>::spacing(const TriangleMesh& mesh) {
    return mesh.triangles.empty() ? point_spacing(mesh.positions.span()) : edge_spacing(mesh);
}

std::vector<PropertySpec> KindTraits<TriangleMesh>::property_specs() {
    return {{"closed", Unit::boolean, "A closed, oriented manifold: no boundary, one fan at every vertex."},
            {"components", Unit::count, "Edge-connected components."},
            {"genus", Unit::count, "Handles, summed over the components, holes counted as filled."},
            {"boundary-loops", Unit::count, "Boundary loops."},
            {"triangles", Unit::count, "Triangles."},
            {"points", Unit::count, "Vertices."}};
}

Metrics KindTraits<TriangleMesh>::properties(const TriangleMesh& mesh) {
    const MeshTopology found = topology(mesh);
    Metrics properties;
    properties.set("closed", found.closed ? 1 : 0, Unit::boolean);
    properties.set("components", static_cast<double>(found.components), Unit::count);
    if (found.genus) properties.set("genus", static_cast<double>(*found.genus), Unit::count);
    properties.set("boundary-loops", static_cast<double>(found.boundary_loops), Unit::count);
    properties.set("triangles", static_cast<double>(found.triangles), Unit::count);
    properties.set("points", static_cast<double>(mesh.positions.size()), Unit::count);
    return properties;
}

void KindTraits<TriangleMesh>::require_usable(const TriangleMesh& mesh) {
    require_consistent(mesh);
    if (mesh.triangles.empty()) throw Error("the result has no triangles");
}

}  // namespace scanmill
