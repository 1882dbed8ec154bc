// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/properties.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "scanmill/geometry/mesh/topology.hpp"

namespace scanmill {

namespace {

void add_facts(const PointCloud& cloud, Metrics& facts) {
    facts.set("points", static_cast<double>(cloud.size()), Unit::count);
}

void add_facts(const TriangleMesh& mesh, Metrics& facts) {
    const MeshTopology found = topology(mesh);
    facts.set("closed", found.closed ? 1 : 0, Unit::boolean);
    facts.set("components", static_cast<double>(found.components), Unit::count);
    if (found.genus) facts.set("genus", static_cast<double>(*found.genus), Unit::count);
    facts.set("boundary-loops", static_cast<double>(found.boundary_loops), Unit::count);
    facts.set("triangles", static_cast<double>(found.triangles), Unit::count);
    facts.set("points", static_cast<double>(mesh.positions.size()), Unit::count);
}

void add_facts(const TetMesh& tets, Metrics& facts) {
    facts.set("points", static_cast<double>(tets.positions.size()), Unit::count);
    facts.set("cells", static_cast<double>(tets.cells.size()), Unit::count);
}

void add_facts(const auto&, Metrics&) {}

}  // namespace

std::vector<MetricSpec> fact_specs(Kind kind) {
    switch (kind) {
        case Kind::points: return {{"points", Unit::count, "Points."}};
        case Kind::mesh:
            return {{"closed", Unit::boolean, "A closed, oriented manifold: no boundary, one fan at every vertex."},
                    {"components", Unit::count, "Pieces connected through edges."},
                    {"genus", Unit::count, "Handles, summed over the components, holes counted as filled."},
                    {"boundary-loops", Unit::count, "Connected pieces of the boundary."},
                    {"triangles", Unit::count, "Triangles."},
                    {"points", Unit::count, "Vertices."}};
        case Kind::tets: return {{"points", Unit::count, "Vertices."}, {"cells", Unit::count, "Tetrahedra."}};
        default: return {};
    }
}

Metrics facts_of(const Value& value) {
    Metrics facts;
    std::visit([&](const auto& object) { add_facts(*object, facts); }, value);
    return facts;
}

std::string display(const Metric& metric) {
    if (metric.unit == Unit::boolean) return metric.value != 0 ? "yes" : "no";
    if (metric.unit == Unit::angle) return fmt::format("{:.4g} deg", metric.value * 180 / std::numbers::pi);
    if (metric.unit == Unit::ratio) return fmt::format("{:.4g} %", metric.value * 100);
    if (metric.value == std::floor(metric.value) && std::abs(metric.value) < 1e15)
        return fmt::format("{:.0f}", metric.value);
    return fmt::format("{:.6g}", metric.value);
}

std::string display(const Metric& metric, LengthUnit unit) {
    switch (metric.unit) {
        case Unit::length: return fmt::format("{} {}", display(metric), symbol(unit));
        case Unit::area: return fmt::format("{} {}²", display(metric), symbol(unit));
        case Unit::volume: return fmt::format("{} {}³", display(metric), symbol(unit));
        default: return display(metric);
    }
}

}  // namespace scanmill
