// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/facet_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr double thinnest = 1e-9;

/// The unit normal of a triangle; zero if the triangle has no area.
Vec3 normal_of(const TriangleMesh& mesh, const Triangle& triangle) {
    std::array<const Vec3*, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = &mesh.positions[triangle[i]];
    // Starts at the lowest corner, because rounding must not depend on the triangle's first corner.
    const auto lowest = std::ranges::min_element(p, is_lower, [](const Vec3* v) -> const Vec3& { return *v; });
    std::ranges::rotate(p, lowest);
    Vec3 u = *p[1] - *p[0], v = *p[2] - *p[0], w = *p[2] - *p[1];
    const double size = std::max({u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff(), w.cwiseAbs().maxCoeff()});
    if (size == 0) return Vec3::Zero();
    u /= size;
    v /= size;
    w /= size;
    const Vec3 across = u.cross(v);
    const double length = across.norm(), longest = std::max({u.squaredNorm(), v.squaredNorm(), w.squaredNorm()});
    return length > thinnest * longest ? Vec3(across / length) : Vec3::Zero();
}

/// The normal that a triangle without area takes from its neighbours; zero if none has a normal.
Vec3 neighbours_normal(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> normals,
                       u32 triangle) {
    Vec3 best = Vec3::Zero();
    double longest = -1;
    for (u32 half_edge = 3 * triangle; half_edge < 3 * triangle + 3; ++half_edge) {
        if (opposite[half_edge] >= half_edges::no_half_edge) continue;
        const Vec3& normal = normals[opposite[half_edge] / 3];
        if (normal == Vec3::Zero()) continue;
        const Vec3 edge =
            mesh.positions[half_edges::end(mesh, half_edge)] - mesh.positions[half_edges::start(mesh, half_edge)];
        const double length = edge.squaredNorm();
        if (length > longest || (length == longest && is_lower(normal, best))) {
            longest = length;
            best = normal;
        }
    }
    return best;
}

/// Assigns normals to the triangles without area, in rounds that start beside proper triangles.
void fill(const TriangleMesh& mesh, std::span<const u32> opposite, Array<Vec3>& normals, std::vector<u32> waiting) {
    while (!waiting.empty()) {
        std::vector<Vec3> found;
        for (const u32 triangle : waiting) found.push_back(neighbours_normal(mesh, opposite, normals, triangle));
        for (std::size_t i = 0; i < waiting.size(); ++i) normals[waiting[i]] = found[i];
        std::vector<u32> next;
        for (std::size_t i = 0; i < waiting.size(); ++i) {
            if (found[i] == Vec3::Zero()) continue;
            for (const u32 half_edge : {3 * waiting[i], 3 * waiting[i] + 1, 3 * waiting[i] + 2})
                if (const u32 other = opposite[half_edge];
                    other < half_edges::no_half_edge && normals[other / 3] == Vec3::Zero())
                    next.push_back(other / 3);
        }
        std::ranges::sort(next);
        next.erase(std::ranges::unique(next).begin(), next.end());
        waiting = std::move(next);
    }
}

}  // namespace

FacetNormals facet_normals(const TriangleMesh& mesh, std::span<const u32> opposite, unsigned threads) {
    FacetNormals result;
    result.unit.resize(mesh.triangles.size());
    constexpr std::size_t chunk = 1 << 14;
    for_each_chunk(threads, mesh.triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Triangle& triangle = mesh.triangles[t];
            result.unit[t] = half_edges::has_repeated_vertex(triangle) ? Vec3(Vec3::Zero()) : normal_of(mesh, triangle);
        }
    });
    std::vector<u32> thin;
    for (u32 t = 0; t < mesh.triangles.size(); ++t)
        if (result.unit[t] == Vec3::Zero()) thin.push_back(t);
    result.without_area = thin.size();
    fill(mesh, opposite, result.unit, std::move(thin));
    return result;
}

Array<Vec3> vertex_area_vectors(const TriangleMesh& mesh) {
    Array<Vec3> areas(mesh.positions.size(), Vec3(Vec3::Zero()));
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 area = area_vector(mesh.positions, triangle);
        for (const u32 vertex : triangle) areas[vertex] += area;
    }
    return areas;
}

}  // namespace scanmill
