// SPDX-License-Identifier: GPL-3.0-or-later
// What every sculpture must satisfy, asked of random solids after every single removal, by brute force.

#include <gtest/gtest.h>

#include <numbers>

#include "filters/sculpt_cases.hpp"

namespace scanmill {
namespace {

using namespace test;

struct Case {
    const char* name;
    TetMesh tets;
    SculptParams params;
};

SculptParams weighted(SculptWeight weight, bool lookahead = true) {
    SculptParams params;
    params.weight = weight;
    params.lookahead = lookahead;
    return params;
}

std::vector<Case> cases() {
    const auto filled = [](std::uint64_t seed) { return hull_of(random_cube(60, seed)); };
    return {{"points that fill a cube", filled(1), {}},
            {"the same weighted", filled(1), weighted(SculptWeight::length)},
            {"others without look-ahead", filled(2), weighted(SculptWeight::none, false)},
            {"a lattice, full of ties", hull_of(lattice_cube(4)), {}},
            {"the hull of a torus", hull_of(poisson_torus(0.35)), {}},
            {"a block whose points are nearly in rows", hull_of(l_block_surface(2, 2, 4, 1e-5)), {}},
            {"a webbed block", solid_of(tets_of(l_block_surface(2, 2, 4, 2e-3))).tets, {}},
            {"two spheres",
             solid_of(tets_of(joined(fibonacci_sphere(80, 0.05), moved(fibonacci_sphere(80, 0.05), 1, Vec3(4, 0, 0)))),
                      many())
                 .tets,
             {}}};
}

/// Marks what lies within two facets of `cell`, through solid cells.
void mark_near(const TetMesh& tets, std::span<const u8> inside, u32 cell, Array<u8>& near) {
    for (u32 first : tets.neighbours[cell]) {
        if (first == TetMesh::outside_hull || inside[first] == 0) continue;
        near[first] = 1;
        for (u32 second : tets.neighbours[first])
            if (second != TetMesh::outside_hull && inside[second] != 0) near[second] = 1;
    }
}

/// Facets of the cell that bound the solid.
std::vector<int> open_facets(const TetMesh& tets, std::span<const u8> inside, u32 cell) {
    std::vector<int> open;
    for (int i = 0; i < 4; ++i) {
        const u32 across = tets.neighbours[cell][i];
        if (across == TetMesh::outside_hull || inside[across] == 0) open.push_back(i);
    }
    return open;
}

Vec3 unit_normal(const TetMesh& tets, u32 cell, int facet) {
    const auto& [i, j, k] = outward_facet[static_cast<std::size_t>(facet)];
    const Vec3 &a = tets.positions[tets.cells[cell][i]], &b = tets.positions[tets.cells[cell][j]],
               &c = tets.positions[tets.cells[cell][k]];
    return (b - a).cross(c - a).normalized();
}

double smallest_angle(const TetMesh& tets, u32 cell, int facet) {
    double least = std::numbers::pi;
    std::array<Vec3, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = tets.positions[tets.cells[cell][outward_facet[facet][i]]];
    for (int i = 0; i < 3; ++i) {
        const Vec3 u = p[(i + 1) % 3] - p[i], v = p[(i + 2) % 3] - p[i];
        least = std::min(least, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
    return least;
}

bool is_admissible(const TetMesh& tets, Array<u8>& inside, u32 cell, long euler) {
    inside[cell] = 0;
    const MeshTopology facts = topology(mesh_of(tets, inside));
    inside[cell] = 1;
    return facts.closed && facts.euler == euler;
}

class SculptLaws : public testing::TestWithParam<std::size_t> {};

TEST_P(SculptLaws, HoldAfterEveryRemovalAndAtTheEnd) {
    const Case given = cases()[GetParam()];
    SCOPED_TRACE(given.name);
    const TetMesh& tets = given.tets;
    const SculptResult result = sculpted(tets, given.params);

    Array<u8> inside(tets.inside.begin(), tets.inside.end()), near(tets.cells.size());
    std::ranges::fill(near, u8(0));
    TriangleMesh mesh = mesh_of(tets, inside);
    const MeshTopology before = topology(mesh);
    ASSERT_TRUE(before.closed);
    const SculptWeight weight = given.params.weight;
    double bending = bending_of(mesh, weight), removed_volume = 0;
    const double largest = largest_circumradius(mesh);
    std::size_t triangles = before.triangles, exposed = 0;
    for (const SculptRemoval& removal : result.removals) {
        ASSERT_EQ(inside[removal.cell], 1);
        const bool exposes = removal.step == SculptStep::exposing;
        const std::vector<int> open = open_facets(tets, inside, removal.cell);
        ASSERT_EQ(open.size(), exposes ? 1u : 2u);
        inside[removal.cell] = 0;
        if (exposes) mark_near(tets, inside, removal.cell, near);
        exposed += exposes;
        triangles += exposes ? 2 : 0;
        removed_volume += volume_of(tets, removal.cell);
        mesh = mesh_of(tets, inside);
        const MeshTopology facts = topology(mesh);
        ASSERT_TRUE(facts.closed);
        ASSERT_EQ(facts.euler, before.euler);
        ASSERT_EQ(facts.components, before.components);
        ASSERT_EQ(facts.triangles, triangles);
        ASSERT_EQ(facts.vertices, before.vertices + exposed);
        const double now = bending_of(mesh, weight);
        ASSERT_NEAR(bending - now, removal.gain, 1e-6);
        ASSERT_FALSE(!exposes && bares_larger(tets, removal.cell, open, largest)) << "flips dig no pits";
        if (removal.step == SculptStep::smoothing) {
            ASSERT_GT(removal.gain, 0);
            for (int facet = 0; facet < 4; ++facet)
                if (std::ranges::find(open, facet) == open.end()) {
                    ASSERT_GT(smallest_angle(tets, removal.cell, facet), 0.1 * std::numbers::pi / 180 - 1e-9);
                }
        }
        bending = now;
    }
    EXPECT_EQ(exposed, result.exposing);
    EXPECT_TRUE(std::ranges::equal(inside, result.tets.inside));
    EXPECT_NEAR(result.volume_removed, removed_volume, 1e-12);
    EXPECT_NEAR(result.bending_before, bending_of(mesh_of(tets, tets.inside.span())), 1e-6);
    EXPECT_NEAR(result.bending_after, bending_of(mesh), 1e-6);
    EXPECT_EQ(places(result.mesh), places(mesh));
    EXPECT_EQ(
        result.mesh.positions.size() + result.blocked_points.size() + result.deep_points.size() + result.outside_points,
        tets.positions.size());

    // No cell is left whose removal would bring a point to the surface, or smooth it where that is allowed.
    std::size_t tried = 0;
    for (u32 cell = 0; cell < inside.size(); ++cell) {
        if (inside[cell] == 0) continue;
        const std::vector<int> open = open_facets(tets, inside, cell);
        if (open.size() != 1 && open.size() != 2) continue;
        if (open.size() == 2 && near[cell] == 0 &&
            unit_normal(tets, cell, open[0]).dot(unit_normal(tets, cell, open[1])) > std::cos(std::numbers::pi / 4))
            continue;
        if (open.size() == 2 && bares_larger(tets, cell, open, largest)) continue;
        if (!is_admissible(tets, inside, cell, before.euler)) continue;
        ++tried;
        ASSERT_EQ(open.size(), 2u) << "cell " << cell << " would expose a point";
        inside[cell] = 0;
        EXPECT_LE(bending - bending_of(mesh_of(tets, inside), weight), 1e-6) << "cell " << cell;
        inside[cell] = 1;
    }
    if (GetParam() < 3) {
        EXPECT_GT(tried, 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Solids, SculptLaws, testing::Range(std::size_t(0), std::size_t(8)));

/// What removing `cell` gains, with the best admissible flip of a neighbour after it if asked. Brute force.
double exposing_gain(const TetMesh& tets, Array<u8>& inside, u32 cell, bool lookahead) {
    const TriangleMesh before = mesh_of(tets, inside);
    const long euler = topology(before).euler;
    const double largest = largest_circumradius(before);
    inside[cell] = 0;
    const double between = bending_of(mesh_of(tets, inside));
    double best = 0;
    for (u32 across : tets.neighbours[cell]) {
        if (!lookahead || across == TetMesh::outside_hull || inside[across] == 0) continue;
        const std::vector<int> open = open_facets(tets, inside, across);
        if (open.size() != 2 || !is_admissible(tets, inside, across, euler)) continue;
        if (bares_larger(tets, across, open, largest)) continue;
        inside[across] = 0;
        best = std::max(best, between - bending_of(mesh_of(tets, inside)));
        inside[across] = 1;
    }
    inside[cell] = 1;
    return bending_of(before) - between + best;
}

TEST(Sculpt, FirstExposingStep_IsTheBestOfAllByItselfOrWithTheFlipAfterIt) {
    int differ = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        // A ball, so that nothing is sharp and the first step exposes one of the points within.
        const PointCloud within = moved(random_cube(40, seed, 1.2), 1, Vec3(-.6, -.6, -.6));
        const TetMesh tets = hull_of(joined(fibonacci_sphere(150), within));
        std::array<u32, 2> first;
        for (bool lookahead : {false, true}) {
            const SculptResult result = sculpted(tets, weighted(SculptWeight::none, lookahead));
            ASSERT_EQ(result.removals[0].step, SculptStep::exposing);
            first[lookahead] = result.removals[0].cell;
            Array<u8> inside(tets.inside.begin(), tets.inside.end());
            const long euler = topology(mesh_of(tets, inside)).euler;
            const double chosen = exposing_gain(tets, inside, first[lookahead], lookahead);
            const double largest = largest_circumradius(mesh_of(tets, inside));
            const auto digs = [&](u32 cell) {
                return bares_larger(tets, cell, open_facets(tets, inside, cell), largest);
            };
            bool all_dig = true;
            for (u32 cell = 0; cell < inside.size(); ++cell) {
                if (open_facets(tets, inside, cell).size() == 1 && is_admissible(tets, inside, cell, euler)) {
                    all_dig &= digs(cell);
                    if (digs(cell) == digs(first[lookahead])) {
                        EXPECT_LE(exposing_gain(tets, inside, cell, lookahead), chosen + 1e-6);
                    }
                }
            }
            EXPECT_EQ(digs(first[lookahead]), all_dig) << "digging comes last";
        }
        differ += first[0] != first[1];
    }
    EXPECT_GT(differ, 0);
}

TEST(Sculpt, OnAnyNumberOfThreads_GivesTheSameBytes) {
    for (const Case& given : cases()) {
        const SculptResult one = sculpted(given.tets, given.params, 1), two = sculpted(given.tets, given.params, 2);
        EXPECT_TRUE(std::ranges::equal(one.tets.inside, two.tets.inside)) << given.name;
        EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles)) << given.name;
        EXPECT_EQ(one.bending_before, two.bending_before);
        EXPECT_EQ(one.bending_after, two.bending_after);
        ASSERT_EQ(one.removals.size(), two.removals.size());
        for (std::size_t i = 0; i < one.removals.size(); ++i) {
            EXPECT_EQ(one.removals[i].cell, two.removals[i].cell);
            EXPECT_EQ(one.removals[i].gain, two.removals[i].gain);
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

TEST(Sculpt, OfALargerScan_IsTheSameSculpture) {
    const PointCloud cloud = random_cube(300, 4);
    const SculptResult plain = sculpted(hull_of(cloud));
    for (double factor : {0.125, 64.0}) {
        const SculptResult scaled = sculpted(hull_of(moved(cloud, factor)));
        EXPECT_TRUE(std::ranges::equal(plain.tets.inside, scaled.tets.inside));
        EXPECT_NEAR(scaled.volume_removed / plain.volume_removed, factor * factor * factor, 1e-9);
    }
}

TEST(Sculpt, PointsNoSingleCellUncovers_AreReachedByOneFlipOrByTwo) {
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

TEST(Sculpt, PointsThatStayInside_AreToldWithTheirPlaces) {
    ContextOptions options;
    Context context(options);
    const SculptResult result = sculpt(hull_of(random_cube(3000, 5)), {}, context);
    const std::size_t left = result.blocked_points.size() + result.deep_points.size();
    ASSERT_GT(left, 0u);
    bool told = false;
    for (const std::string& warning : context.warnings()) told |= warning.find("stay inside the solid") != warning.npos;
    EXPECT_TRUE(told);
    EXPECT_EQ(context.metrics().find("interior-points")->value, static_cast<double>(left));
}

}  // namespace
}  // namespace scanmill
