// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/facet_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"

namespace scanmill {

namespace {

constexpr double thinnest = 1e-9;

bool lower(const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Zero when the triangle has no area.
Vec3 normal_of(const TriangleMesh& mesh, const Triangle& triangle) {
    std::array<const Vec3*, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = &mesh.positions[triangle[i]];
    // Starts at the lowest corner: rounding must not depend on the triangle's first corner.
    const auto lowest = std::ranges::min_element(p, [](const Vec3* a, const Vec3* b) { return lower(*a, *b); });
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

double squared_length(const TriangleMesh& mesh, u32 half_edge) {
    return (mesh.positions[half_edges::end(mesh, half_edge)] - mesh.positions[half_edges::start(mesh, half_edge)])
        .squaredNorm();
}

/// Assigns normals to the triangles without area, in rounds that start beside proper triangles.
class ThinTriangles {
public:
    ThinTriangles(const TriangleMesh& mesh, std::span<const u32> opposite, Array<Vec3>& normals)
        : mesh_(mesh),
          opposite_(opposite),
          normals_(normals) {}

    void fill(std::vector<u32> waiting) {
        std::vector<Vec3> found;
        while (!waiting.empty()) {
            found.clear();
            for (const u32 triangle : waiting) found.push_back(neighbours_normal(triangle));
            std::vector<u32> next;
            for (std::size_t i = 0; i < waiting.size(); ++i)
                if (found[i] != Vec3::Zero()) normals_[waiting[i]] = found[i];
            for (std::size_t i = 0; i < waiting.size(); ++i)
                if (found[i] != Vec3::Zero()) add_waiting_neighbours(waiting[i], next);
            std::ranges::sort(next);
            next.erase(std::ranges::unique(next).begin(), next.end());
            waiting = std::move(next);
        }
    }

private:
    bool has_opposite(u32 half_edge) const { return opposite_[half_edge] < half_edges::no_half_edge; }

    Vec3 neighbours_normal(u32 triangle) const {
        Vec3 best = Vec3::Zero();
        double longest = -1;
        for (u32 half_edge = 3 * triangle; half_edge < 3 * triangle + 3; ++half_edge) {
            if (!has_opposite(half_edge)) continue;
            const Vec3& normal = normals_[opposite_[half_edge] / 3];
            if (normal == Vec3::Zero()) continue;
            const double length = squared_length(mesh_, half_edge);
            if (length > longest || (length == longest && lower(normal, best))) {
                longest = length;
                best = normal;
            }
        }
        return best;
    }
    void add_waiting_neighbours(u32 triangle, std::vector<u32>& waiting) const {
        for (u32 half_edge = 3 * triangle; half_edge < 3 * triangle + 3; ++half_edge)
            if (has_opposite(half_edge) && normals_[opposite_[half_edge] / 3] == Vec3::Zero())
                waiting.push_back(opposite_[half_edge] / 3);
    }

    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    Array<Vec3>& normals_;
};

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
    ThinTriangles(mesh, opposite, result.unit).fill(std::move(thin));
    return result;
}

}  // namespace scanmill
