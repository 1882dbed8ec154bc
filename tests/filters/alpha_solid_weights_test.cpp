// SPDX-License-Identifier: GPL-3.0-or-later
// The alpha-solid of weighted points: values against exact arithmetic, the solid against its definition.

#include <CGAL/Exact_rational.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <deque>

#include "alpha_solid/flood.hpp"
#include "alpha_solid/sphere_polynomials.hpp"
#include "alpha_solid/weighted_spheres.hpp"
#include "filters/weighted_cases.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/hidden_vertices.hpp"
#include "scanmill/geometry/solid_boundary.hpp"
#include "support/real_data.hpp"

namespace scanmill::alpha {
namespace {

using namespace test;
using testing::HasSubstr;
using Number = CGAL::Exact_rational;
using Vector = Offset<Number>;

struct Ball {
    Vector centre;
    Number squared;
};

Vector vector(const Vec3& p) { return {Number(p.x()), Number(p.y()), Number(p.z())}; }
Number power(const Ball& ball, const WeightedPoint& p) {
    const Vector to = minus(vector(*p.position), ball.centre);
    return Number(dot(to, to) - Number(p.weight) - ball.squared);
}

/// The smallest sphere orthogonal to the points: its centre is the first plus a combination of the edges, found by
/// Cramer's rule. Weights as they are, so `squared` may be negative.
Ball orthogonal_sphere(const std::vector<WeightedPoint>& points) {
    const std::size_t n = points.size() - 1;
    const Vector origin = vector(*points[0].position);
    std::vector<Vector> edges;
    std::vector<Number> right;
    for (std::size_t i = 1; i <= n; ++i) {
        edges.push_back(minus(vector(*points[i].position), origin));
        right.push_back((dot(edges.back(), edges.back()) + Number(points[0].weight) - Number(points[i].weight)) / 2);
    }
    const auto determinant = [&](std::size_t replaced) {
        std::array<std::array<Number, 3>, 3> m;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                m[i][j] = i >= n || j >= n ? Number(i == j) : j == replaced ? right[i] : dot(edges[i], edges[j]);
        return Number(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                      m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                      m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
    };
    const Number whole = determinant(9);
    Vector offset{0, 0, 0}, centre = origin;
    for (std::size_t j = 0; j < n; ++j) {
        const Number share = determinant(j) / whole;
        for (std::size_t axis = 0; axis < 3; ++axis) offset[axis] += share * edges[j][axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] += offset[axis];
    return {centre, Number(dot(offset, offset) - Number(points[0].weight))};
}

double lowered(const Ball& ball, double largest) { return CGAL::to_double(Number(ball.squared + Number(largest))); }

bool is_flat(const std::array<WeightedPoint, 4>& p) {
    const auto [u, v, w] = offsets_from<Number>(*p[0].position, *p[1].position, *p[2].position, *p[3].position);
    return dot(u, cross(v, w)) == 0;
}

/// Returns how many corners lay exactly on a facet's sphere.
int expect_exact(const std::array<WeightedPoint, 4>& p, double largest) {
    const CellSpheres spheres = weighted_cell_spheres(p, largest);
    const double cell = lowered(orthogonal_sphere({p[0], p[1], p[2], p[3]}), largest);
    int ties = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Ball facet = orthogonal_sphere({p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4]});
        const Number of_apex = power(facet, p[i]);
        const bool attached = of_apex < 0;
        ties += of_apex == 0;
        EXPECT_EQ((spheres.attached >> i & 1) != 0, attached);
        EXPECT_NEAR(spheres.values[i] / (attached ? cell : lowered(facet, largest)), 1, 1e-8);
    }
    return ties;
}

TEST(WeightedSpheres, ACornerOfTheCube_HasItsClosedForms) {
    // Edges along the axes and weights 0 but for the origin's w: the sphere through the three tips, orthogonal to the
    // origin's, has its centre at ((1 + w) / 2) (1, 1, 1).
    const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const double w = 0.25;
    const CellSpheres spheres = weighted_cell_spheres({{{&o, w}, {&x, 0}, {&y, 0}, {&z, 0}}}, w);
    // The centre lies beyond the facet of the tips: the origin attaches it, and it has the cell's value
    // 3 ((1 + w) / 2)² - w, lowered: + w.
    EXPECT_EQ(spheres.attached, 0b0001);
    EXPECT_DOUBLE_EQ(spheres.values[0], 3 * std::pow((1 + w) / 2, 2));
    for (int i = 1; i < 4; ++i) EXPECT_DOUBLE_EQ(spheres.values[i], 2 * std::pow((1 + w) / 2, 2));
}

TEST(WeightedSpheres, ACornerExactlyOnTheFacetsSphere_DoesNotAttach) {
    // Tips at 3 that are heavier by 3: the centre (1, 1, 1) lies in their facet. A hair less, and it lies beyond.
    const Vec3 o(0, 0, 0), x(3, 0, 0), y(0, 3, 0), z(0, 0, 3);
    const auto attached = [&](double w) {
        return weighted_cell_spheres({{{&o, 0}, {&x, w}, {&y, w}, {&z, w}}}, 4).attached;
    };
    EXPECT_EQ(attached(3), 0);
    EXPECT_EQ(attached(std::nextafter(3, 0)), 0b0001);
    EXPECT_EQ(attached(std::nextafter(3, 4)), 0);
}

TEST(WeightedSpheres, RandomCorners_AgreeWithExactArithmetic) {
    Random random(1);
    for (int i = 0; i < 400; ++i) {
        std::array<Vec3, 4> p;
        std::array<WeightedPoint, 4> corners;
        for (int k = 0; k < 4; ++k) {
            for (double& coordinate : p[k]) coordinate = random.uniform(-1, 1);
            corners[k] = {&p[k], random.uniform(0, i % 2 ? 0.1 : 3)};
        }
        expect_exact(corners, 3);
    }
}

TEST(WeightedSpheres, CornersOnASmallLattice_AgreeWithExactArithmetic) {
    Random random(2);
    int ties = 0;
    for (int i = 0; i < 800; ++i) {
        std::array<Vec3, 4> p;
        std::array<WeightedPoint, 4> corners;
        for (int k = 0; k < 4; ++k) {
            for (double& coordinate : p[k]) coordinate = static_cast<double>(random.index(3));
            corners[k] = {&p[k], static_cast<double>(random.index(3))};
        }
        if (!is_flat(corners)) ties += expect_exact(corners, 2);
    }
    EXPECT_GT(ties, 100);
}

TEST(WeightedSpheres, CornersOnALatticeThatDoublesRound_AgreeWithExactArithmetic) {
    // Thirds and tenths are no doubles: what was a tie on the lattice lies a few roundings to either side of it.
    Random random(5);
    int attached = 0, free = 0;
    for (int i = 0; i < 1500; ++i) {
        const double step = i % 2 ? 0.1 : 1.0 / 3, away = i % 3 == 0 ? 1000 : 0;
        std::array<Vec3, 4> p;
        std::array<WeightedPoint, 4> corners;
        for (int k = 0; k < 4; ++k) {
            for (double& coordinate : p[k]) coordinate = away + step * static_cast<double>(random.index(3));
            corners[k] = {&p[k], step * step * static_cast<double>(random.index(3))};
        }
        if (is_flat(corners)) continue;
        expect_exact(corners, 2 * step * step);
        const int count = std::popcount(weighted_cell_spheres(corners, 2 * step * step).attached);
        attached += count;
        free += 4 - count;
    }
    EXPECT_GT(attached, 300);
    EXPECT_GT(free, 300);
}

TEST(WeightedSpheres, FacetsThatAreNotAskedFor_HaveTheCellsPartAlone) {
    Random random(6);
    int parts = 0;
    for (int i = 0; i < 100; ++i) {
        std::array<Vec3, 4> p;
        std::array<WeightedPoint, 4> corners;
        for (int k = 0; k < 4; ++k) {
            for (double& coordinate : p[k]) coordinate = random.uniform(-1, 1);
            corners[k] = {&p[k], random.uniform(0, 1)};
        }
        const CellSpheres all = weighted_cell_spheres(corners, 1);
        const Ball cell = orthogonal_sphere({corners.begin(), corners.end()});
        const double own = CGAL::to_double(Number(cell.squared + 1));
        for (unsigned facets = 0; facets < 16; ++facets) {
            const CellSpheres some = weighted_cell_spheres(corners, 1, facets);
            ASSERT_EQ(some.attached, all.attached);
            for (int k = 0; k < 4; ++k) {
                if ((facets >> k & 1) != 0) {
                    EXPECT_EQ(some.values[k], all.values[k]);
                } else if ((all.attached >> k & 1) != 0) {
                    EXPECT_NEAR(some.values[k] / own, 1, 1e-8);
                    ++parts;
                } else {
                    EXPECT_EQ(some.values[k], 0);
                }
            }
        }
    }
    EXPECT_GT(parts, 100);
}

TEST(WeightedSpheres, SliversAndTinyDifferences_AgreeWithExactArithmetic) {
    Random random(3);
    for (int i = 0; i < 400; ++i) {
        std::array<Vec3, 4> p;
        std::array<WeightedPoint, 4> corners;
        const double thinness = std::pow(10, -random.uniform(0, 12));
        for (int k = 0; k < 4; ++k) {
            for (double& coordinate : p[k]) coordinate = random.uniform(-1, 1);
            corners[k] = {&p[k], 0.5 + thinness * random.uniform(-0.5, 0.5)};
        }
        if (i % 2 == 0) p[3] = (p[0] + p[1] + p[2]) / 3 + thinness * p[3];
        if (i % 2 == 1) p[2] = p[0] + thinness * p[2];
        if (!is_flat(corners)) expect_exact(corners, 1);
    }
}

TEST(WeightedSpheres, CornersInAnyOrder_GiveTheSameBits) {
    Random random(4);
    for (int i = 0; i < 50; ++i) {
        std::array<Vec3, 4> p;
        std::array<WeightedPoint, 4> corners;
        for (int k = 0; k < 4; ++k) {
            for (double& coordinate : p[k]) coordinate = random.uniform(-1, 1);
            corners[k] = {&p[k], random.uniform(0, 1)};
        }
        const CellSpheres cell = weighted_cell_spheres(corners, 1);
        std::array<std::size_t, 4> order{0, 1, 2, 3};
        while (std::next_permutation(order.begin(), order.end())) {
            const CellSpheres other =
                weighted_cell_spheres({corners[order[0]], corners[order[1]], corners[order[2]], corners[order[3]]}, 1);
            for (int k = 0; k < 4; ++k) {
                EXPECT_EQ(other.values[k], cell.values[order[k]]);
                EXPECT_EQ(other.attached >> k & 1, cell.attached >> order[k] & 1);
            }
        }
    }
}

TEST(WeightedSpheres, ExtremeSizes_ScaleExactly) {
    const Vec3 a(0.1, 0.2, 0.3), b(1, 0.1, 0), c(0, 1.1, 0.2), d(0.3, 0, 0.9);
    const CellSpheres unit = weighted_cell_spheres({{{&a, 0.1}, {&b, 0.2}, {&c, 0}, {&d, 0.3}}}, 0.4);
    for (int exponent : {-100, 300}) {
        const double k = std::ldexp(1.0, exponent), kk = k * k;
        const Vec3 ka = k * a, kb = k * b, kc = k * c, kd = k * d;
        const CellSpheres scaled =
            weighted_cell_spheres({{{&ka, 0.1 * kk}, {&kb, 0.2 * kk}, {&kc, 0}, {&kd, 0.3 * kk}}}, 0.4 * kk);
        EXPECT_EQ(scaled.attached, unit.attached);
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(scaled.values[i] / kk / unit.values[i], 1, 1e-8);
    }
}

/// The definition, in exact arithmetic, of a wall at squared radius `value`.
bool is_wall(const TetMesh& tets, u32 cell, int corner, double value) {
    const double largest = std::ranges::max(tets.weights);
    const auto at = [&](u32 vertex) { return WeightedPoint{&tets.positions[vertex], tets.weights[vertex]}; };
    const auto of_cell = [&](u32 c) {
        const auto& [i, j, k, l] = tets.cells[c];
        return Number(orthogonal_sphere({at(i), at(j), at(k), at(l)}).squared + Number(largest));
    };
    const Tetrahedron& own = tets.cells[cell];
    const auto& [i, j, k] = outward_facet[corner];
    const Ball facet = orthogonal_sphere({at(own[i]), at(own[j]), at(own[k])});
    bool attached = power(facet, at(own[corner])) < 0;
    Number least = of_cell(cell);
    if (const u32 across = tets.neighbours[cell][corner]; across != TetMesh::outside_hull) {
        for (u32 vertex : tets.cells[across])
            if (std::ranges::find(own, vertex) == own.end()) attached |= power(facet, at(vertex)) < 0;
        least = std::min(least, of_cell(across));
    }
    return (attached ? least : Number(facet.squared + Number(largest))) <= Number(value);
}

Array<u8> brute_force_inside(const TetMesh& tets, double value) {
    Array<u8> inside(tets.cells.size(), u8(1));
    std::deque<u32> open;
    const auto enter = [&](u32 cell) {
        inside[cell] = 0;
        open.push_back(cell);
    };
    for (u32 c = 0; c < inside.size(); ++c)
        for (int i = 0; i < 4; ++i)
            if (tets.neighbours[c][i] == TetMesh::outside_hull && inside[c] && !is_wall(tets, c, i, value)) enter(c);
    for (; !open.empty(); open.pop_front())
        for (int i = 0; i < 4; ++i)
            if (const u32 across = tets.neighbours[open.front()][i];
                across != TetMesh::outside_hull && inside[across] && !is_wall(tets, open.front(), i, value))
                enter(across);
    return inside;
}

TEST(AlphaSolidWeights, Solid_IsTheBruteForceFloodFill) {
    const std::vector<TetMesh> all{weighted(with_random_weights(random_cube(60, 1), 0.05, 1), weighted_by("w")).tets,
                                   weighted(random_cube(60, 2)).tets,
                                   weighted(fibonacci_sphere(70, 1e-2), weighted_by("spacing", 0.5)).tets};
    int compared = 0;
    for (const TetMesh& tets : all) {
        Context context;
        const Flood flood =
            flood_from_outside(sweep_cells(tets, context), tets.positions.size(), {.value = 0, .coverage = 1}, context);
        for (double quantile : {0.05, 0.1, 0.2, 0.3, 0.5}) {
            std::size_t i = static_cast<std::size_t>(quantile * static_cast<double>(flood.values.size()));
            while (i + 1 < flood.values.size() && flood.values[i + 1] > flood.values[i] * (1 - 1e-6)) ++i;
            if (i + 1 == flood.values.size()) continue;
            ++compared;
            const double alpha = std::sqrt(std::sqrt(flood.values[i] * flood.values[i + 1]));
            const AlphaSolidResult result = solid_of(tets, at_alpha(alpha));
            const Array<u8> expected = brute_force_inside(tets, alpha * alpha);
            EXPECT_TRUE(std::ranges::equal(result.tets.inside, expected)) << quantile;
        }
    }
    EXPECT_GE(compared, 9);
}

TEST(AlphaSolidWeights, EqualWeights_GiveTheResultOfNone) {
    for (const PointCloud& cloud : {fibonacci_sphere(300, 1e-3), lattice_cube(4, 0.1, true)}) {
        const AlphaSolidResult none = solid_of(cloud);
        const AlphaSolidResult equal =
            solid_of(weighted(with_weights(cloud, Array<double>(cloud.size(), 0.7)), weighted_by("w")).tets);
        EXPECT_EQ(equal.alpha, none.alpha);
        EXPECT_EQ(equal.alpha_cover, none.alpha_cover);
        EXPECT_TRUE(std::ranges::equal(equal.tets.inside, none.tets.inside));
        EXPECT_TRUE(std::ranges::equal(equal.mesh.triangles, none.mesh.triangles));
    }
}

TEST(AlphaSolidWeights, AllPointsHeavierByAsMuch_ChangeNothingButRounding) {
    const PointCloud cloud = with_random_weights(fibonacci_sphere(200, 1e-3), 0x1p-10, 3);
    Array<double> heavier;
    for (double weight : cloud.columns.find("w")->values<double>()) heavier.push_back(weight + 0.5);
    const AlphaSolidResult one = solid_of(weighted(cloud, weighted_by("w")).tets);
    const AlphaSolidResult other =
        solid_of(weighted(with_weights(fibonacci_sphere(200, 1e-3), heavier), weighted_by("w")).tets);
    EXPECT_NEAR(other.alpha / one.alpha, 1, 1e-9);
    EXPECT_EQ(places(other.mesh), places(one.mesh));
}

TEST(AlphaSolidWeights, ScaleAndMotion_MoveTheSolidAlong) {
    const PointCloud cloud = plate_with_a_hole();
    const AlphaSolidResult here = solid_of(weighted(cloud).tets);
    const AlphaSolidResult twice = solid_of(weighted(moved(cloud, 1024)).tets);
    EXPECT_EQ(twice.alpha, 1024 * here.alpha);
    EXPECT_TRUE(std::ranges::equal(twice.mesh.triangles, here.mesh.triangles));
    const AlphaSolidResult turned = solid_of(weighted(rotated(cloud, 0.6)).tets);
    EXPECT_NEAR(turned.alpha / here.alpha, 1, 1e-9);
    expect_closed(turned, cloud.size(), 0);
}

TEST(AlphaSolidWeights, AnyOrderAndThreads_GiveTheSameSolid) {
    const PointCloud cloud = plate_with_a_hole();
    const AlphaSolidResult one = solid_of(weighted(cloud).tets);
    const AlphaSolidResult three = solid_of(weighted(cloud, weighted_by("spacing"), 3).tets, {}, 3);
    EXPECT_EQ(three.alpha, one.alpha);
    EXPECT_TRUE(std::ranges::equal(three.mesh.triangles, one.mesh.triangles));
    for (std::uint64_t seed : {1, 2}) {
        const AlphaSolidResult other = solid_of(weighted(shuffled(cloud, seed)).tets);
        EXPECT_EQ(other.alpha, one.alpha);
        EXPECT_EQ(places(other.mesh), places(one.mesh));
    }
}

TEST(AlphaSolidWeights, AHiddenPoint_IsNeitherInteriorNorUncovered) {
    // The middle of the regular tetrahedron is hidden, that of the hull stays a corner.
    const PointCloud cloud =
        with_weights(cloud_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 0, 0}}), {4, 4, 4, 4, 0});
    const TetMesh tets = weighted(cloud, weighted_by("w")).tets;
    const AlphaSolidResult result = solid_of(tets);
    EXPECT_THAT(result.hidden_points.span(), testing::ElementsAre(4));
    EXPECT_EQ(result.interior_points.size(), 0u);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_EQ(result.tets.positions.size(), 5u);
    expect_closed(result, 4, 2);
    EXPECT_DOUBLE_EQ(result.alpha, std::sqrt(8.0 / 3)) << "the corners have the largest weight: their plain radius";
}

TEST(AlphaSolidWeights, EveryPoint_IsCountedOnce) {
    const PointCloud cloud = with_random_weights(random_cube(400, 1), 0.03, 1);
    Context context;
    const AlphaSolidResult result =
        alpha_solid(weighted(cloud, weighted_by("w")).tets, covering(60, AlphaComponents::many), context);
    EXPECT_GT(result.hidden_points.size(), 0u);
    EXPECT_GT(result.uncovered_points.size(), 0u);
    EXPECT_EQ(result.mesh.positions.size() + result.interior_points.size() + result.uncovered_points.size() +
                  result.hidden_points.size(),
              cloud.size());
    EXPECT_EQ(context.metrics().find("hidden-points")->value, static_cast<double>(result.hidden_points.size()));
}

TEST(AlphaSolidWeights, WeightsForSomePointsOnly_AreRefused) {
    TetMesh tets = weighted(random_cube(20, 1)).tets;
    tets.weights = {1, 2, 3};
    EXPECT_THAT(refusal(tets, {}), HasSubstr("needs a weight for each of 20 vertices or none; there are 3"));
}

TEST(AlphaSolidWeights, AHoleNarrowerThanTheCoarseSpacing_StaysOpenWhereTheSamplingIsFine) {
    const PointCloud cloud = plate_with_a_hole();
    // One radius for all must be 0.7 to cover the plate, and a ball of that size does not enter a hole of 0.8.
    const AlphaSolidResult plain = solid_of(cloud);
    EXPECT_GE(plain.alpha, std::sqrt(0.5) * (1 - 1e-12));
    EXPECT_EQ(topology(plain.mesh).genus, 0u);
    EXPECT_GT(plain.interior_points.size(), 50u);
    EXPECT_NEAR(cell_volumes(plain), 200, 0.01);
    // With weights the ball is as small in the hole as its sampling allows.
    const AlphaSolidResult result = solid_of(weighted(cloud).tets);
    expect_closed(result, cloud.size(), 0);
    EXPECT_EQ(topology(result.mesh).genus, 1u);
    EXPECT_NEAR(cell_volumes(result), 200 - 0.8 * 0.8 * 2, 0.01);
    EXPECT_EQ(result.choice, AlphaChoice::scan);
}

TEST(AlphaSolidWeights, ARealScan_HidesNothing_AndLosesFewerPointsInside) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const auto cloud = read_points(path);
    const TetMesh tets = weighted(*cloud).tets;
    EXPECT_EQ(hidden_vertices(tets).size(), 0u);
    const AlphaSolidResult plain = solid_of(*cloud), result = solid_of(tets, {}, 2);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_LT(result.interior_points.size(), plain.interior_points.size());
}

}  // namespace
}  // namespace scanmill::alpha
