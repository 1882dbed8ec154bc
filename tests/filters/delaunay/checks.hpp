// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Properties of every Delaunay tetrahedralisation.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "delaunay/delaunay.hpp"

namespace scanmill::test {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

inline DelaunayResult triangulated(const PointCloud& cloud, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return delaunay(cloud, {}, context);
}

inline Kernel::Point_3 exact(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

inline double six_volumes(const TetMesh& tets, u32 cell) {
    const auto& [a, b, c, d] = tets.cells[cell];
    const Vec3 u = tets.positions[b] - tets.positions[a], v = tets.positions[c] - tets.positions[a];
    return u.cross(v).dot(tets.positions[d] - tets.positions[a]);
}

inline double volume(const TetMesh& tets) {
    double sum = 0;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell) sum += six_volumes(tets, cell);
    return sum / 6;
}

/// Checks every guarantee of tets.hpp.
inline void expect_canonical(const TetMesh& tets) {
    ASSERT_EQ(tets.neighbours.size(), tets.cells.size());
    EXPECT_TRUE(std::ranges::is_sorted(tets.cells));
    EXPECT_EQ(std::ranges::adjacent_find(tets.cells), tets.cells.end());
    std::map<std::array<u32, 3>, std::vector<u32>> cells_of_facet;
    for (u32 c = 0; c < tets.cells.size(); ++c) {
        const Tetrahedron& cell = tets.cells[c];
        ASSERT_EQ(*std::ranges::min_element(cell), cell[0]);
        ASSERT_LT(cell[1], std::min(cell[2], cell[3]));
        ASSERT_EQ(CGAL::orientation(exact(tets.positions[cell[0]]), exact(tets.positions[cell[1]]),
                                    exact(tets.positions[cell[2]]), exact(tets.positions[cell[3]])),
                  CGAL::POSITIVE);
        for (int i = 0; i < 4; ++i) {
            std::array<u32, 3> facet{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
            std::ranges::sort(facet);
            cells_of_facet[facet].push_back(c);
        }
    }
    for (u32 c = 0; c < tets.cells.size(); ++c)
        for (int i = 0; i < 4; ++i) {
            const Tetrahedron& cell = tets.cells[c];
            std::array<u32, 3> facet{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
            std::ranges::sort(facet);
            const std::vector<u32>& cells = cells_of_facet[facet];
            ASSERT_LE(cells.size(), 2u);
            const u32 expected = cells.size() == 1 ? TetMesh::outside_hull : cells[0] + cells[1] - c;
            ASSERT_EQ(tets.neighbours[c][i], expected);
        }
}

inline void expect_empty_spheres(const TetMesh& tets) {
    for (const auto& [a, b, c, d] : tets.cells)
        for (const Vec3& p : tets.positions)
            ASSERT_NE(CGAL::side_of_bounded_sphere(exact(tets.positions[a]), exact(tets.positions[b]),
                                                   exact(tets.positions[c]), exact(tets.positions[d]), exact(p)),
                      CGAL::ON_BOUNDED_SIDE);
}

inline void expect_equal_bytes(const TetMesh& a, const TetMesh& b) {
    ASSERT_EQ(a.cells.size(), b.cells.size());
    EXPECT_EQ(std::memcmp(a.cells.data(), b.cells.data(), a.cells.size() * sizeof(Tetrahedron)), 0);
    EXPECT_EQ(std::memcmp(a.neighbours.data(), b.neighbours.data(), a.cells.size() * 4 * sizeof(u32)), 0);
}

/// Cells as sets of positions, independent of the vertices' numbers.
using Places = std::set<std::array<std::array<double, 3>, 4>>;
inline Places places(const TetMesh& tets) {
    Places result;
    for (const Tetrahedron& cell : tets.cells) {
        std::array<std::array<double, 3>, 4> corners;
        for (int i = 0; i < 4; ++i) std::copy_n(tets.positions[cell[i]].data(), 3, corners[i].begin());
        std::ranges::sort(corners);
        result.insert(corners);
    }
    return result;
}

}  // namespace scanmill::test
