// SPDX-License-Identifier: GPL-3.0-or-later
#include "inspect/parts.hpp"

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"
#include "scanmill/geometry/mesh/sharp_edges.hpp"

namespace scanmill::inspecting {

namespace {

Parts numbered(DisjointSets& sets, std::size_t triangles) {
    Parts parts;
    parts.of_triangle.resize(triangles);
    for (u32 triangle = 0; triangle < triangles; ++triangle) {
        const u32 first = sets.find(triangle);  // the lowest triangle of the part
        parts.of_triangle[triangle] = first == triangle ? static_cast<u32>(parts.count++) : parts.of_triangle[first];
    }
    return parts;
}

}  // namespace

Parts components_of(const Nominal& nominal) {
    const TriangleMesh& surface = nominal.surface();
    DisjointSets sets(surface.triangles.size());
    half_edges::for_each_edge(half_edges::by_smaller_vertex(surface), [&](u32, auto edge) {
        for (const auto& half_edge : edge) sets.unite(edge[0].number / 3, half_edge.number / 3);
    });
    return numbered(sets, surface.triangles.size());
}

Parts patches_of(const Nominal& nominal, unsigned threads) {
    const TriangleMesh& surface = nominal.surface();
    const Array<u32>& opposites = nominal.opposites();
    const std::vector<bool> sharp = sharp_half_edges(surface, opposites, nominal.normals(),
                                                     FeatureParams{}.sharp_angle.in_radians() + angle_tie, threads);
    DisjointSets sets(surface.triangles.size());
    for (u32 half_edge = 0; half_edge < opposites.size(); ++half_edge)
        if (opposites[half_edge] != half_edges::boundary && !sharp[half_edge])
            sets.unite(half_edge / 3, opposites[half_edge] / 3);
    return numbered(sets, surface.triangles.size());
}

}  // namespace scanmill::inspecting
