// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call alpha-solid, and what they check of every result.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "alpha_solid/alpha_solid.hpp"
#include "delaunay/delaunay.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/topology.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"

namespace scanmill::test {

inline TetMesh tets_of(const PointCloud& cloud) {
    Context context;
    return delaunay(cloud, {}, context).tets;
}

inline AlphaSolidResult solid_of(const TetMesh& tets, const AlphaSolidParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return alpha_solid(tets, params, context);
}
inline AlphaSolidResult solid_of(const PointCloud& cloud, const AlphaSolidParams& params = {}) {
    return solid_of(tets_of(cloud), params);
}

inline AlphaSolidParams at_alpha(double alpha) {
    AlphaSolidParams params;
    params.alpha = Length(alpha);
    return params;
}
inline AlphaSolidParams covering(double percent, AlphaComponents components = AlphaComponents::single) {
    AlphaSolidParams params;
    params.coverage = Ratio::percent(percent);
    params.components = components;
    return params;
}
inline AlphaSolidParams many() { return covering(100, AlphaComponents::many); }

/// V, E, F of the boundary, and that it is closed and outward round exactly the cells inside.
inline void expect_closed(const AlphaSolidResult& result, std::size_t vertices, long euler) {
    const MeshTopology properties = topology(result.mesh);
    EXPECT_TRUE(properties.closed);
    EXPECT_EQ(properties.unused_vertices, 0u);
    EXPECT_EQ(properties.vertices, vertices);
    EXPECT_EQ(properties.euler, euler);
    EXPECT_EQ(properties.triangles, static_cast<std::size_t>(2 * (static_cast<long>(vertices) - euler)));
    EXPECT_EQ(properties.components, result.components);
    EXPECT_EQ(result.nonmanifold_vertices, 0u);
}

inline double cell_volumes(const AlphaSolidResult& result) {
    double sum = 0;
    for (std::size_t c = 0; c < result.tets.cells.size(); ++c) {
        if (!result.tets.inside[c]) continue;
        const auto& [i, j, k, l] = result.tets.cells[c];
        const Vec3& a = result.tets.positions[i];
        const Vec3 u = result.tets.positions[j] - a, v = result.tets.positions[k] - a;
        sum += u.cross(v).dot(result.tets.positions[l] - a) / 6;
    }
    return sum;
}

using Point = std::array<double, 3>;
inline Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// The boundary as a set of oriented triangles between positions, independent of the vertices' numbers.
inline std::set<std::array<Point, 3>> places(const TriangleMesh& mesh) {
    std::set<std::array<Point, 3>> result;
    for (const auto& [a, b, c] : mesh.triangles) {
        std::array<Point, 3> t{point(mesh.positions[a]), point(mesh.positions[b]), point(mesh.positions[c])};
        std::ranges::rotate(t, std::ranges::min_element(t));
        result.insert(t);
    }
    return result;
}

inline std::string refusal(const TetMesh& tets, const AlphaSolidParams& params) {
    try {
        solid_of(tets, params);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

/// Two unit-spaced lattice cubes that share exactly one corner: pinched there until alpha reaches across.
inline PointCloud cubes_sharing_a_corner() { return joined(lattice_cube(8), moved(lattice_cube(8), 1, Vec3(8, 8, 8))); }

inline PointCloud two_spheres() {
    return joined(fibonacci_sphere(600, 1e-4), moved(fibonacci_sphere(300, 1e-4, 2), 0.5, Vec3(3, 0, 0)));
}

inline std::vector<std::string> warnings_of(const TetMesh& tets, const AlphaSolidParams& params) {
    Context context;
    alpha_solid(tets, params, context);
    return sentences_of(context);
}

}  // namespace scanmill::test
