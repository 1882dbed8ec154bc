// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of every result, checked by brute force on random solids after every removal.

#include <gtest/gtest.h>

#include "filters/sculpt/brute_force.hpp"

namespace scanmill {
namespace {

using namespace test;

class SculptLaws : public testing::TestWithParam<std::size_t> {};

TEST_P(SculptLaws, HoldAfterEveryRemovalAndAtTheEnd) {
    const SculptCase given = sculpt_cases()[GetParam()];
    SCOPED_TRACE(given.name);
    const TetMesh& tets = given.tets;
    const SculptResult result = sculpted(tets, given.params);

    const SculptWeight weight = given.params.weight;
    Carving carving(tets, weight);
    TriangleMesh mesh = carving.mesh();
    const MeshTopology before = topology(mesh);
    ASSERT_TRUE(before.closed);
    double bending = carving.bending(), removed_volume = 0, gain_of_chain = 0;
    bool chain_may_smooth = false;
    std::size_t triangles = before.triangles, exposed = 0;
    for (const SculptRemoval& removal : result.removals) {
        ASSERT_TRUE(carving.has(removal.cell));
        const bool exposes = removal.step == SculptStep::exposing;
        ASSERT_EQ(carving.open_facets(removal.cell).size(), exposes ? 1u : 2u);
        ASSERT_FALSE(!exposes && carving.uncovers_too_large(removal.cell)) << "flips uncover no larger triangles";
        if (removal.step == SculptStep::smoothing) {
            ASSERT_FALSE(carving.uncovers_thin(removal.cell));
            gain_of_chain += removal.gain;
            chain_may_smooth |= carving.may_smooth(removal.cell);
        }
        carving.remove(removal.cell);
        exposed += exposes;
        triangles += exposes ? 2 : 0;
        removed_volume += volume_of(tets, removal.cell);
        mesh = carving.mesh();
        const MeshTopology found = topology(mesh);
        ASSERT_TRUE(found.closed);
        ASSERT_EQ(found.euler, before.euler);
        ASSERT_EQ(found.components, before.components);
        ASSERT_EQ(found.triangles, triangles);
        ASSERT_EQ(found.vertices, before.vertices + exposed);
        const double now = bending_of(mesh, weight);
        ASSERT_NEAR(bending - now, removal.gain, 1e-6);
        bending = now;
        if (removal.chained) {
            ASSERT_EQ(removal.step, SculptStep::smoothing);
        } else if (removal.step == SculptStep::smoothing) {
            ASSERT_GT(gain_of_chain, 0);
            ASSERT_TRUE(chain_may_smooth) << "smoothing only where it is allowed";
            gain_of_chain = 0;
            chain_may_smooth = false;
        }
    }
    EXPECT_EQ(exposed, result.exposing);
    EXPECT_TRUE(std::ranges::equal(carving.inside(), result.tets.inside));
    EXPECT_NEAR(result.volume_removed, removed_volume, 1e-12);
    EXPECT_NEAR(result.bending_before, bending_of(mesh_of(tets, tets.inside.span())), 1e-6);
    EXPECT_NEAR(result.bending_after, bending_of(mesh), 1e-6);
    EXPECT_EQ(places(result.mesh), places(mesh));
    EXPECT_EQ(
        result.mesh.positions.size() + result.blocked_points.size() + result.deep_points.size() + result.outside_points,
        tets.positions.size());

    // No cell is left whose removal exposes a point, or smooths the boundary where that is allowed.
    std::size_t tried = 0;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell) {
        if (!carving.has(cell)) continue;
        const std::size_t open = carving.open_facets(cell).size();
        if (open == 1) {
            ASSERT_FALSE(carving.is_admissible(cell)) << "cell " << cell << " would expose a point";
        }
        if (open != 2 || !carving.may_smooth(cell) || !carving.may_flip(cell)) continue;
        ++tried;
        carving.remove(cell);
        EXPECT_LE(bending - carving.bending(), 1e-6) << "cell " << cell;
        carving.put_back(cell);
    }
    if (GetParam() < 3) {
        EXPECT_GT(tried, 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Solids, SculptLaws, testing::Range(std::size_t(0), std::size_t(9)));

/// The gain of removing `cell`; with look-ahead plus the best admissible flip of a neighbour after it. Brute force.
double exposing_gain(const TetMesh& tets, Carving& carving, u32 cell, bool lookahead) {
    const double before = carving.bending();
    carving.remove(cell);
    const double between = carving.bending();
    double best = 0;
    for (u32 across : tets.neighbours[cell]) {
        if (!lookahead || !carving.may_flip(across)) continue;
        carving.remove(across);
        best = std::max(best, between - carving.bending());
        carving.put_back(across);
    }
    carving.put_back(cell);
    return before - between + best;
}

TEST(Sculpt, FirstExposingStep_IsTheBestOfAllByItselfOrWithTheFlipAfterIt) {
    int differ = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        // A ball: nothing is sharp, so the first step exposes one of the points inside.
        const PointCloud within = moved(random_cube(40, seed, 1.2), 1, Vec3(-.6, -.6, -.6));
        const TetMesh tets = hull_of(joined(fibonacci_sphere(150), within));
        std::array<u32, 2> first;
        for (bool lookahead : {false, true}) {
            const SculptResult result = sculpted(tets, weighted(SculptWeight::none, lookahead));
            ASSERT_EQ(result.removals[0].step, SculptStep::exposing);
            first[lookahead] = result.removals[0].cell;
            Carving carving(tets, SculptWeight::none);
            const double chosen = exposing_gain(tets, carving, first[lookahead], lookahead);
            const bool too_large = carving.uncovers_too_large(first[lookahead]);
            bool all_too_large = true;
            for (u32 cell = 0; cell < tets.cells.size(); ++cell) {
                if (carving.open_facets(cell).size() != 1 || !carving.is_admissible(cell)) continue;
                all_too_large &= carving.uncovers_too_large(cell);
                if (carving.uncovers_too_large(cell) == too_large) {
                    EXPECT_LE(exposing_gain(tets, carving, cell, lookahead), chosen + 1e-6);
                }
            }
            EXPECT_EQ(too_large, all_too_large) << "steps to larger triangles come last";
        }
        differ += first[0] != first[1];
    }
    EXPECT_GT(differ, 0);
}

TEST(Sculpt, OnAnyNumberOfThreads_GivesTheSameBytes) {
    for (const SculptCase& given : sculpt_cases()) {
        const SculptResult one = sculpted(given.tets, given.params, 1), two = sculpted(given.tets, given.params, 2);
        EXPECT_TRUE(std::ranges::equal(one.tets.inside, two.tets.inside)) << given.name;
        EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles)) << given.name;
        EXPECT_EQ(one.bending_before, two.bending_before);
        EXPECT_EQ(one.bending_after, two.bending_after);
        ASSERT_EQ(one.removals.size(), two.removals.size());
        for (std::size_t i = 0; i < one.removals.size(); ++i) {
            EXPECT_EQ(one.removals[i].cell, two.removals[i].cell);
            EXPECT_EQ(one.removals[i].gain, two.removals[i].gain);
            EXPECT_EQ(one.removals[i].chained, two.removals[i].chained);
        }
    }
}

TEST(Sculpt, OfManyCells_GivesTheSameBytesOnTwoThreads) {
    const TetMesh tets = hull_of(random_cube(4000, 3));
    ASSERT_GT(tets.cells.size(), 20000u);  // more than one chunk
    const SculptResult one = sculpted(tets, {}, 1), two = sculpted(tets, {}, 2);
    EXPECT_TRUE(std::ranges::equal(one.tets.inside, two.tets.inside));
    EXPECT_EQ(one.bending_after, two.bending_after);
    EXPECT_GT(one.exposing, 3000u);
}

TEST(Sculpt, OfShuffledPoints_IsTheSameSurface) {
    const PointCloud block = l_block_surface(3, 2, 6), lattice = lattice_cube(4), filled = random_cube(500, 9);
    for (const PointCloud* cloud : {&block, &lattice, &filled})
        for (std::uint64_t seed : {1, 2, 3}) {
            const SculptResult plain = sculpted(hull_of(*cloud)), mixed = sculpted(hull_of(shuffled(*cloud, seed)));
            EXPECT_GT(plain.removals.size(), 0u);
            EXPECT_EQ(places(plain.mesh), places(mixed.mesh));
        }
}

TEST(Sculpt, OfALargerScan_RemovesTheSameCells) {
    const PointCloud cloud = random_cube(300, 4);
    const SculptResult plain = sculpted(hull_of(cloud));
    for (double factor : {0.125, 64.0}) {
        const SculptResult scaled = sculpted(hull_of(moved(cloud, factor)));
        EXPECT_TRUE(std::ranges::equal(plain.tets.inside, scaled.tets.inside));
        EXPECT_NEAR(scaled.volume_removed / plain.volume_removed, factor * factor * factor, 1e-9);
    }
}

TEST(Sculpt, PointsThatNoSingleCellExposes_AreReachedByOneFlipOrByTwo) {
    int by_one = 0, by_two = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const SculptResult result = sculpted(hull_of(random_cube(2000, seed)));
        const auto opens = [&](std::size_t k) {
            return k < result.removals.size() && result.removals[k].step == SculptStep::opening;
        };
        for (std::size_t i = 1; i < result.removals.size(); ++i) {
            if (!opens(i) || opens(i - 1)) continue;
            ++(opens(i + 1) ? by_two : by_one);
        }
    }
    EXPECT_GT(by_one, 0);
    EXPECT_GT(by_two, 0);
}

TEST(Sculpt, PointsThatStayInside_AreReportedInAWarning) {
    ContextOptions options;
    Context context(options);
    const SculptResult result = sculpt(hull_of(random_cube(3000, 5)), {}, context);
    const std::size_t left = result.blocked_points.size() + result.deep_points.size();
    ASSERT_GT(left, 0u);
    bool has_warning = false;
    for (const std::string& warning : context.warnings())
        has_warning |= warning.find("stay inside the solid") != warning.npos;
    EXPECT_TRUE(has_warning);
    EXPECT_EQ(context.metrics().find("interior-points")->value, static_cast<double>(left));
}

}  // namespace
}  // namespace scanmill
