// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of the vertices neither forbids flips on flat faces nor permits flips of creases.

#include <gmock/gmock.h>

#include "filters/edge_flip/cases.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

/// A roof: two faces at an angle of 2 `slope`, which meet in the vertices of column 20. Rows are far apart and odd
/// columns are moved by half of their distance. So no edge along the columns is Delaunay, whether on a face or on the
/// ridge.
constexpr u32 columns = 41, rows = 30;
u32 vertex_at(u32 column, u32 row) { return row * columns + column; }
TriangleMesh roof(double slope) {
    constexpr double distance = 2.5;
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    for (u32 row = 0; row < rows; ++row)
        for (u32 column = 0; column < columns; ++column) {
            const double across = column - 20.0;
            positions.emplace_back(across * std::cos(slope), distance * (row + 0.5 * (column % 2)),
                                   -std::abs(across) * std::sin(slope));
        }
    for (u32 row = 0; row + 1 < rows; ++row)
        for (u32 column = 0; column + 1 < columns; ++column) {
            const u32 a = vertex_at(column, row), b = a + 1, c = vertex_at(column + 1, row + 1), d = c - 1;
            if (column % 2 == 0) {
                triangles.push_back({a, b, d});
                triangles.push_back({b, c, d});
            } else {
                triangles.push_back({a, b, c});
                triangles.push_back({a, c, d});
            }
        }
    return mesh_of(positions, triangles);
}

EdgeFlipResult flipped_with_noise(const TriangleMesh& mesh, std::optional<double> noise) {
    EdgeFlipParams params;
    params.deviation = Ratio::percent(100);  // rule 5 alone decides
    if (noise) params.noise = Length(*noise);
    return flipped(mesh, params);
}

TEST(EdgeFlipOfANoisyPlane, IsNotBlockedByTheAnglesOfItsNoise) {
    const TriangleMesh mesh = noisy_grid(40, 40, 0.3, 11);
    const EdgeFlipResult own = flipped_with_noise(mesh, 0), estimated = flipped_with_noise(mesh, std::nullopt);
    EXPECT_GT(own.left.folding, 50u) << "noise decides";
    EXPECT_LT(estimated.left.folding, own.left.folding / 10);
    EXPECT_EQ(estimated.left.sharp, 0u) << "a plane has no creases";
    EXPECT_GT(estimated.flips.size(), own.flips.size());
}

TEST(EdgeFlipOfANoisyRoof, KeepsTheRidge_AndFlipsTheEdgesOfItsFaces) {
    // Uniform noise of 0.1 is a standard deviation of 0.06 beside rows of 2.5. The faces differ by 70 degrees.
    const TriangleMesh mesh = shaken(roof(35 * degree), 0.1, 3);
    const auto ridge_of = [](const EdgeFlipResult& result) {
        const std::set<Edge> edges = edges_of(result.mesh);
        std::size_t kept = 0;
        for (u32 row = 0; row + 1 < rows; ++row)
            kept += edges.count(make_edge(vertex_at(20, row), vertex_at(20, row + 1)));
        return kept;
    };
    ASSERT_LT(ridge_of(flipped_with_noise(mesh, 0)), (rows - 1) / 2) << "the ridge would be flipped";
    const EdgeFlipResult estimated = flipped_with_noise(mesh, std::nullopt);
    EXPECT_EQ(ridge_of(estimated), rows - 1);
    EXPECT_EQ(estimated.left.sharp, rows - 1) << "only the ridge is a crease";
    // All other edges along the columns, but for the boundary.
    EXPECT_GE(estimated.flips.size(), (columns - 3) * (rows - 1));
    EXPECT_TRUE(std::ranges::equal(flipped_with_noise(mesh, 0.06).flips, estimated.flips))
        << "a given noise near the estimate";
}

TEST(EdgeFlipOfABoxWithoutNoise, IsThatOfItsOwnNormals_AndKeepsItsEdges) {
    constexpr int squares = 12;
    TriangleMesh mesh = cube_of_squares(squares);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    Random random(4);
    for (Vec3& p : positions) {
        std::array<bool, 3> is_inner;
        for (std::size_t axis = 0; axis < 3; ++axis) is_inner[axis] = p[axis] > 0 && p[axis] < squares;
        if (std::ranges::count(is_inner, true) != 2) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)  // within the face
            if (is_inner[axis]) p[axis] += random.uniform(-0.4, 0.4);
    }
    mesh.positions = std::move(positions);
    const EdgeFlipResult own = flipped_with_noise(mesh, 0), estimated = flipped_with_noise(mesh, std::nullopt);
    EXPECT_GT(own.flips.size(), 50u);
    EXPECT_EQ(estimated.flips, own.flips);
    const std::set<Edge> edges = edges_of(estimated.mesh);
    std::size_t along = 0;  // pieces of the box's twelve edges
    for (const auto& [a, b] : edges) {
        int common = 0;
        for (int axis = 0; axis < 3; ++axis)
            common += mesh.positions[a][axis] == mesh.positions[b][axis] &&
                      (mesh.positions[a][axis] == 0 || mesh.positions[a][axis] == squares);
        along += common == 2;
    }
    EXPECT_EQ(along, 12u * squares);
}

}  // namespace
}  // namespace scanmill
