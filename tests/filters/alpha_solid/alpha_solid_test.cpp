// SPDX-License-Identifier: GPL-3.0-or-later
/// alpha-solid on shapes whose answer is known.

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "filters/alpha_solid/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(AlphaSolid, CubeCorners_AreTheirHullAtHalfTheSquaresDiagonal) {
    for (double edge : {1.0, 0.001, 25.4}) {
        const AlphaSolidResult result = solid_of(lattice_cube(1, edge));
        EXPECT_NEAR(result.alpha, edge / std::numbers::sqrt2, 1e-12 * edge);
        EXPECT_EQ(result.alpha_cover, result.alpha);
        EXPECT_EQ(result.cells_inside, result.tets.cells.size());
        EXPECT_EQ(result.choice, AlphaChoice::scan);
        expect_closed(result, 8, 2);
        EXPECT_NEAR(signed_volume(result.mesh), edge * edge * edge, 1e-12 * edge * edge * edge);
    }
}

TEST(AlphaSolid, RegularTetrahedron_AppearsAtItsFacetsCircumradius) {
    const TetMesh tets = tets_of(vertices_of(regular_tetrahedron(1)));
    const AlphaSolidResult result = solid_of(tets);
    EXPECT_NEAR(result.alpha, 1 / std::sqrt(3.0), 1e-12);
    EXPECT_EQ(result.spectrum, 1u);
    expect_closed(result, 4, 2);
    EXPECT_EQ(
        refusal(tets, at_alpha(0.57)),
        "alpha 0.57 u leaves no cell inside; the first cell enters at 0.5774 u, and from 0.5774 u cells cover 4 of 4 "
        "points\nhint: 'alpha: auto' finds the least alpha with a closed manifold boundary");
}

TEST(AlphaSolid, FibonacciSphere_IsClosedThroughAllItsPoints) {
    const AlphaSolidResult result = solid_of(fibonacci_sphere(500, 1e-4));
    EXPECT_NEAR(result.alpha_cover, 0.1218, 0.0005);
    expect_closed(result, 500, 2);
    EXPECT_EQ(result.interior_points.size() + result.uncovered_points.size(), 0u);
}

TEST(AlphaSolid, SphereSampling_CoversAtMostAtItsCoveringRadius) {
    // Every point of the sphere has a sample within `covering_radius`: no ball of that radius passes between samples.
    // The point that is farthest from all samples lies above a facet of their hull, at its pole.
    for (std::size_t count : {60, 200, 800, 3000}) {
        const TetMesh tets = tets_of(fibonacci_sphere(count));
        double covering_radius = 0;
        for (std::size_t c = 0; c < tets.cells.size(); ++c)
            for (int i = 0; i < 4; ++i) {
                if (tets.neighbours[c][i] != TetMesh::outside_hull) continue;
                const auto& [j, k, l] = outward_facet[i];
                const Vec3 a = tets.positions[tets.cells[c][j]], b = tets.positions[tets.cells[c][k]],
                           d = tets.positions[tets.cells[c][l]];
                covering_radius = std::max(covering_radius, (a - (b - a).cross(d - a).normalized()).norm());
            }
        EXPECT_LT(covering_radius, 1);
        const AlphaSolidResult result = solid_of(tets);
        EXPECT_LE(result.alpha_cover, covering_radius);
        EXPECT_GT(result.alpha_cover, 0.9 * covering_radius);
        EXPECT_EQ(result.alpha, result.alpha_cover);
        expect_closed(result, count, 2);
    }
}

TEST(AlphaSolid, PoissonTorus_HasItsGenusAndAllPoints) {
    const PointCloud cloud = poisson_torus(0.06, 0.4, 20000);
    const AlphaSolidResult result = solid_of(cloud);
    EXPECT_LT(result.alpha_cover, 0.1);
    EXPECT_EQ(result.choice, AlphaChoice::scan);
    expect_closed(result, cloud.size(), 0);
    // 2 π² R r², less what the chords cut off.
    EXPECT_NEAR(signed_volume(result.mesh), 2 * std::numbers::pi * std::numbers::pi * 0.16, 0.05);
}

TEST(AlphaSolid, LBlockOnALattice_IsExactAtHalfTheSquaresDiagonal) {
    const PointCloud cloud = l_block_surface(10, 2, 10);
    const AlphaSolidResult result = solid_of(cloud);
    EXPECT_NEAR(result.alpha, 0.1 / std::numbers::sqrt2, 1e-9);
    expect_closed(result, cloud.size(), 2);
    EXPECT_NEAR(signed_volume(result.mesh), 3, 1e-9);
}

TEST(AlphaSolid, LBlockAboveItsSpacing_FillsTheConcaveEdge) {
    const PointCloud cloud = l_block_surface(4, 2, 8, 2e-3);
    const AlphaSolidResult chosen = solid_of(cloud);
    const AlphaSolidResult result = solid_of(chosen.tets, at_alpha(1.6 * chosen.alpha_cover));
    EXPECT_GE(result.interior_points.size(), 7u);
    EXPECT_GT(signed_volume(result.mesh), 6.02);
    for (u32 vertex : result.interior_points) {
        const Vec3& p = cloud.positions[vertex];
        EXPECT_NEAR(p.x(), 1, 0.01);
        EXPECT_NEAR(p.y(), 1, 0.01);
    }
}

TEST(AlphaSolid, SurfaceOfALatticeCube_IsSolidThroughout) {
    // Everything that walls enclose is inside, however large the cells.
    const AlphaSolidResult result = solid_of(lattice_cube(8, 0.125, true));
    EXPECT_EQ(result.cells_inside, result.tets.cells.size());
    expect_closed(result, 386, 2);
    EXPECT_NEAR(signed_volume(result.mesh), 1, 1e-12);
}

TEST(AlphaSolid, FilledLatticeCube_ReportsItsInteriorPoints) {
    const AlphaSolidResult result = solid_of(lattice_cube(6));
    EXPECT_NEAR(result.alpha, 1 / std::numbers::sqrt2, 1e-12);
    EXPECT_EQ(result.interior_points.size(), 125u);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    expect_closed(result, 343 - 125, 2);
    EXPECT_DOUBLE_EQ(signed_volume(result.mesh), 216);
}

TEST(AlphaSolid, CubesThatTouchInACorner_AreNotReportedAsManifold) {
    const TetMesh tets = tets_of(cubes_sharing_a_corner());
    const AlphaSolidResult pinched = solid_of(tets, at_alpha(0.71));
    EXPECT_EQ(pinched.nonmanifold_vertices, 1u);
    EXPECT_EQ(pinched.nonmanifold_edges, 0u);
    EXPECT_EQ(pinched.components, 1u);
    for (const AlphaSolidParams& params : {AlphaSolidParams{}, many()}) {
        const AlphaSolidResult result = solid_of(tets, params);
        EXPECT_EQ(topology(result.mesh).nonmanifold_vertices, 0u);
        EXPECT_GT(result.alpha, 0.71);
        EXPECT_GT(result.cells_inside, pinched.cells_inside);
        EXPECT_NEAR(result.alpha_cover, 1 / std::numbers::sqrt2, 1e-9);
        expect_closed(result, result.mesh.positions.size(), 2);
        EXPECT_EQ(result.uncovered_points.size(), 0u);
    }
}

/// Two needles that share their tip and point away from each other: each appears at about half its length, but the
/// least circumsphere that reaches from one into the other is many times larger.
PointCloud opposite_needles() {
    Array<Vec3> positions{Vec3(0, 0, 0)};
    for (double end : {1.0, -1.0})
        for (int i = 0; i < 3; ++i) {
            const double angle = end + 2 * std::numbers::pi * i / 3;
            positions.push_back(Vec3(0.05 * std::cos(angle), 0.05 * std::sin(angle), end));
        }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

TEST(AlphaSolid, OppositeNeedles_AreClosedRoundTheirCommonTip) {
    const TetMesh tets = tets_of(opposite_needles());
    std::vector<std::string> warnings;
    ContextOptions options;
    options.on_warning = [&](std::string_view text) { warnings.emplace_back(text); };
    Context context(options);
    const AlphaSolidResult result = alpha_solid(tets, {}, context);
    EXPECT_EQ(result.choice, AlphaChoice::repaired);
    EXPECT_EQ(result.alpha, result.alpha_cover);
    EXPECT_NEAR(result.alpha, 0.5, 0.01);
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("was closed around its non-manifold vertices")));
    expect_closed(result, 7, 2);
    // The two needles were all that alpha gave; the repair has added to them without filling the hull.
    const AlphaSolidResult before = solid_of(tets, at_alpha(result.alpha));
    EXPECT_EQ(before.cells_inside, 2u);
    EXPECT_EQ(before.nonmanifold_vertices, 1u);
    EXPECT_GT(result.cells_inside, 2u);
    EXPECT_LT(result.cells_inside, tets.cells.size());
    for (std::size_t c = 0; c < tets.cells.size(); ++c) EXPECT_LE(before.tets.inside[c], result.tets.inside[c]);
    for (std::uint64_t seed : {1, 2, 3})
        EXPECT_EQ(places(solid_of(shuffled(opposite_needles(), seed)).mesh), places(result.mesh));
}

}  // namespace
}  // namespace scanmill
