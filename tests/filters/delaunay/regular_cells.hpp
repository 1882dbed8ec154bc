// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks of the cells of weighted points.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>

#include "filters/alpha_solid/cases.hpp"

namespace scanmill::test {

using RegularKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

inline RegularKernel::Weighted_point_3 exact(const TetMesh& tets, u32 vertex) {
    const Vec3& p = tets.positions[vertex];
    return {RegularKernel::Point_3(p.x(), p.y(), p.z()), tets.weights[vertex]};
}

/// The definition, exactly: no vertex, hidden or not, has a negative power to the sphere orthogonal to a cell.
inline void expect_regular(const TetMesh& tets) {
    ASSERT_EQ(tets.weights.size(), tets.positions.size());
    const auto side = RegularKernel().power_side_of_oriented_power_sphere_3_object();
    for (const auto& [a, b, c, d] : tets.cells)
        for (u32 p = 0; p < tets.positions.size(); ++p)
            ASSERT_NE(side(exact(tets, a), exact(tets, b), exact(tets, c), exact(tets, d), exact(tets, p)),
                      CGAL::ON_POSITIVE_SIDE);
}

template <class T>
bool same_bytes(const Buffer<T>& a, const Buffer<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}
inline void expect_same_cells(const TetMesh& a, const TetMesh& b) {
    EXPECT_TRUE(same_bytes(a.cells, b.cells));
    EXPECT_TRUE(same_bytes(a.neighbours, b.neighbours));
}

/// Cells as sets of positions, independent of the vertices' numbers.
inline std::set<std::array<Point, 4>> cell_places(const TetMesh& tets) {
    std::set<std::array<Point, 4>> result;
    for (const Tetrahedron& cell : tets.cells) {
        std::array<Point, 4> corners;
        for (int i = 0; i < 4; ++i) corners[i] = point(tets.positions[cell[i]]);
        std::ranges::sort(corners);
        result.insert(corners);
    }
    return result;
}

}  // namespace scanmill::test
