// SPDX-License-Identifier: GPL-3.0-or-later
/// The search of alpha-solid for alpha: the reported alpha is the least valid one.

#include <gmock/gmock.h>

#include "filters/alpha_solid/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(AlphaSolidSearch, GrowingAlpha_GrowsTheSolidUpToTheHull) {
    const TetMesh tets = tets_of(random_cube(400, 2));
    const AlphaSolidResult chosen = solid_of(tets);
    std::vector<u8> before(tets.cells.size(), 0);
    double volume = 0;
    for (double factor : {0.6, 0.8, 1.0, 1.1, 1.5, 3.0, 1e9}) {
        const AlphaSolidResult result = solid_of(tets, at_alpha(factor * chosen.alpha_cover));
        for (std::size_t c = 0; c < before.size(); ++c) EXPECT_LE(before[c], result.tets.inside[c]);
        before.assign(result.tets.inside.begin(), result.tets.inside.end());
        EXPECT_GE(cell_volumes(result), volume);
        volume = cell_volumes(result);
        EXPECT_NEAR(signed_volume(result.mesh), volume, 1e-12);
        EXPECT_EQ(result.choice, AlphaChoice::given);
        EXPECT_EQ(result.alpha_cover, chosen.alpha_cover);
    }
    EXPECT_EQ(std::ranges::count(before, 1), static_cast<long>(before.size()));
}

TEST(AlphaSolidSearch, JustBelowAlphaCover_APointIsLeftUncovered) {
    for (const PointCloud& cloud : {random_cube(300, 4), fibonacci_sphere(300), lattice_cube(4)}) {
        const TetMesh tets = tets_of(cloud);
        const double cover = solid_of(tets).alpha_cover;
        EXPECT_EQ(solid_of(tets, at_alpha(cover)).uncovered_points.size(), 0u);
        try {
            EXPECT_GT(solid_of(tets, at_alpha(cover * (1 - 1e-9))).uncovered_points.size(), 0u);
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), HasSubstr("leaves no cell inside"));  // lattices appear all at once
        }
    }
}

TEST(AlphaSolidSearch, TheReportedAlpha_GivesTheSameSolidWhenGiven) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const TetMesh tets = tets_of(random_cube(200, seed));
        const AlphaSolidResult automatic = solid_of(tets);
        if (automatic.choice != AlphaChoice::scan) continue;
        const AlphaSolidResult given = solid_of(tets, at_alpha(automatic.alpha));
        EXPECT_TRUE(std::ranges::equal(given.tets.inside, automatic.tets.inside));
        EXPECT_EQ(given.spectrum, automatic.spectrum);
    }
}

TEST(AlphaSolidSearch, TheScan_FindsTheLeastValidAlpha) {
    // Every smaller candidate from alpha_cover on is invalid, by the topology of its mesh.
    int beyond_cover = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const TetMesh tets = tets_of(random_cube(60, seed));
        const AlphaSolidResult chosen = solid_of(tets);
        ASSERT_NE(chosen.choice, AlphaChoice::hull);
        if (chosen.choice != AlphaChoice::scan) continue;
        expect_closed(chosen, chosen.mesh.positions.size(), topology(chosen.mesh).euler);
        EXPECT_EQ(chosen.components, 1u);
        beyond_cover += chosen.alpha > chosen.alpha_cover;
        double alpha = chosen.alpha_cover;
        for (int guard = 0; alpha < chosen.alpha; ++guard) {
            ASSERT_LT(guard, 1000);
            const AlphaSolidResult smaller = solid_of(tets, at_alpha(alpha));
            EXPECT_TRUE(smaller.nonmanifold_vertices > 0 || smaller.components > 1);
            // The next candidate: bisect for the least alpha with more cells.
            double low = alpha, high = chosen.alpha;
            while (std::nextafter(low, high) < high) {
                const double middle = low + (high - low) / 2;
                (solid_of(tets, at_alpha(middle)).cells_inside > smaller.cells_inside ? high : low) = middle;
            }
            alpha = high;
        }
    }
    EXPECT_GT(beyond_cover, 2);
}

TEST(AlphaSolidSearch, Bisection_GivesAValidSolidNotBelowTheScans) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const TetMesh tets = tets_of(random_cube(80, seed));
        AlphaSolidParams params;
        params.search = AlphaSearch::binary;
        const AlphaSolidResult binary = solid_of(tets, params), scan = solid_of(tets);
        expect_closed(binary, binary.mesh.positions.size(), topology(binary.mesh).euler);
        EXPECT_EQ(binary.components, 1u);
        EXPECT_EQ(binary.choice, AlphaChoice::binary);
        EXPECT_EQ(binary.uncovered_points.size(), 0u);
        EXPECT_TRUE(scan.choice != AlphaChoice::scan || binary.alpha >= scan.alpha);
    }
}

}  // namespace
}  // namespace scanmill
