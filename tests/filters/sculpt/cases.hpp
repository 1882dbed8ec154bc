// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Calls of sculpt for its tests, and independent computations of the properties of a boundary.

#include <cmath>
#include <map>

#include "filters/alpha_solid/cases.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"
#include "sculpt/sculpt.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {

inline SculptResult sculpted(const TetMesh& labelled, const SculptParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return sculpt(labelled, params, context);
}

/// All cells of the points' tetrahedralisation, labelled inside.
inline TetMesh hull_of(const PointCloud& cloud) {
    TetMesh tets = tets_of(cloud);
    Array<u8> inside(tets.cells.size());
    std::ranges::fill(inside, u8(1));
    tets.inside = std::move(inside);
    return tets;
}

inline TriangleMesh mesh_of(const TetMesh& tets, std::span<const u8> labels) {
    TriangleMesh mesh;
    mesh.positions = tets.positions;
    mesh.triangles = boundary_triangles(tets, labels, 1);
    return mesh;
}

/// The sum over the edges of the angle between their triangles' normals; for SculptWeight::length each times the edge's
/// length.
inline double bending_of(const TriangleMesh& mesh, SculptWeight weight = SculptWeight::none) {
    std::map<Edge, std::vector<Vec3>> normals;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 u = mesh.positions[b] - mesh.positions[a], v = mesh.positions[c] - mesh.positions[a];
        for (const Edge& edge : {make_edge(a, b), make_edge(b, c), make_edge(c, a)})
            normals[edge].push_back(u.cross(v).normalized());
    }
    double sum = 0;
    for (const auto& [edge, sides] : normals) {
        EXPECT_EQ(sides.size(), 2u);
        const double angle = std::acos(std::clamp(sides[0].dot(sides[1]), -1.0, 1.0));
        sum +=
            weight == SculptWeight::none ? angle : angle * (mesh.positions[edge[0]] - mesh.positions[edge[1]]).norm();
    }
    return sum;
}

inline double circumradius(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double u = (b - a).norm(), v = (c - b).norm(), w = (a - c).norm();
    return u * v * w / (2 * (b - a).cross(c - a).norm());
}

inline double largest_circumradius(const TriangleMesh& mesh) {
    double largest = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        largest = std::max(largest, circumradius(mesh.positions[a], mesh.positions[b], mesh.positions[c]));
    return largest;
}

/// Removing the cell, whose facets `open` are on the boundary, uncovers a triangle with a larger circumradius.
inline bool uncovers_larger(const TetMesh& tets, u32 cell, const std::vector<int>& open, double largest) {
    for (int facet = 0; facet < 4; ++facet) {
        if (std::ranges::find(open, facet) != open.end()) continue;
        const auto& [i, j, k] = outward_facet[static_cast<std::size_t>(facet)];
        const Tetrahedron& corners = tets.cells[cell];
        if (circumradius(tets.positions[corners[i]], tets.positions[corners[j]], tets.positions[corners[k]]) >
            largest * (1 + 1e-9))
            return true;
    }
    return false;
}

inline double volume_of(const TetMesh& tets, u32 cell) {
    const auto& [i, j, k, l] = tets.cells[cell];
    const Vec3& a = tets.positions[i];
    return (tets.positions[j] - a).cross(tets.positions[k] - a).dot(tets.positions[l] - a) / 6;
}

inline std::string sculpt_refusal(const TetMesh& tets, const SculptParams& params = {}) {
    try {
        sculpted(tets, params);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

/// The unit cube's corners and a point a tenth below the middle of its top.
inline PointCloud dented_cube() { return joined(lattice_cube(1), cloud_of({Vec3(0.5, 0.5, 0.9)})); }

}  // namespace scanmill::test
