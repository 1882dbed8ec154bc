// SPDX-License-Identifier: GPL-3.0-or-later
// The table of kinds, and the kinds points, mesh and tets.
#include "scanmill/kinds/kind.hpp"

#include <algorithm>
#include <mutex>

#include "scanmill/base/error.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

template <>
struct KindTraits<PointCloud> : FromPositions<PointCloud>, NoJson<PointCloud> {
    static constexpr std::string_view name = "points";
    static RobustBox box(const PointCloud& cloud) { return robust_box(cloud.positions.span()); }
    static std::vector<PropertySpec> property_specs() { return {{"points", Unit::count, "Points."}}; }
    static std::vector<std::optional<double>> property_values(const PointCloud& cloud) { return {cloud.size()}; }
    static void require_usable(const PointCloud& cloud) {
        if (cloud.size() == 0) throw Error("the result has no points");
    }
};

template <>
struct KindTraits<TriangleMesh> : FromPositions<TriangleMesh>, NoJson<TriangleMesh> {
    static constexpr std::string_view name = "mesh";
    static RobustBox box(const TriangleMesh& mesh) {
        return mesh.triangles.empty() ? bounding_box(mesh.positions.span()) : surface_box(mesh);
    }
    static double spacing(const TriangleMesh& mesh) {
        return mesh.triangles.empty() ? point_spacing(mesh.positions.span()) : edge_spacing(mesh);
    }
    static std::vector<PropertySpec> property_specs() {
        return {{"closed", Unit::boolean, "A closed, oriented manifold: no boundary, one fan at every vertex.",
                 Better::larger},
                {"components", Unit::count, "Edge-connected components."},
                {"genus", Unit::count, "Handles, summed over the components; holes count as filled."},
                {"boundary-loops", Unit::count, "Boundary loops."},
                {"triangles", Unit::count, "Triangles."},
                {"points", Unit::count, "Vertices."}};
    }
    static std::vector<std::optional<double>> property_values(const TriangleMesh& mesh) {
        const MeshTopology found = topology(mesh);
        return {found.closed,         found.components, found.genus,
                found.boundary_loops, found.triangles,  mesh.positions.size()};
    }
    static void require_usable(const TriangleMesh& mesh) {
        require_consistent(mesh);
        if (mesh.triangles.empty()) throw Error("the result has no triangles");
    }
};

template <>
struct KindTraits<TetMesh> : FromPositions<TetMesh>, NoJson<TetMesh> {
    static constexpr std::string_view name = "tets";
    static std::vector<PropertySpec> property_specs() {
        return {{"points", Unit::count, "Vertices."}, {"cells", Unit::count, "Tetrahedra."}};
    }
    static std::vector<std::optional<double>> property_values(const TetMesh& tets) {
        return {tets.positions.size(), tets.cells.size()};
    }
    static void require_usable(const TetMesh&) {}
};

template Kind kind_of<PointCloud>();
template Kind kind_of<TriangleMesh>();
template Kind kind_of<TetMesh>();

namespace {

struct KindTable {
    std::mutex mutex;
#define SCANMILL_KIND_OF(Type) kind_of<Type>(),
    std::vector<Kind> kinds{SCANMILL_ALL_KINDS(SCANMILL_KIND_OF)};
#undef SCANMILL_KIND_OF
};

KindTable& kind_table() {
    static KindTable table;
    return table;
}

}  // namespace

Kind::Kind() : Kind(kind_info<PointCloud>) {}

void register_kind(Kind kind) {
    KindTable& table = kind_table();
    const std::scoped_lock lock(table.mutex);
    if (std::ranges::find(table.kinds, kind) == table.kinds.end()) table.kinds.push_back(kind);
}

std::vector<Kind> all_kinds() {
    KindTable& table = kind_table();
    const std::scoped_lock lock(table.mutex);
    return table.kinds;
}

std::optional<Kind> kind_named(std::string_view name) {
    for (const Kind kind : all_kinds())
        if (kind.name() == name) return kind;
    return std::nullopt;
}

std::string kind_names() {
    std::string names;
    for (const Kind kind : all_kinds()) names.append(names.empty() ? "" : ", ").append(kind.name());
    return names;
}

Metrics metrics_from(const std::vector<PropertySpec>& specs, const std::vector<std::optional<double>>& values) {
    Metrics metrics;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i]) metrics.set(specs[i].name, *values[i], specs[i].unit);
    return metrics;
}

}  // namespace scanmill
