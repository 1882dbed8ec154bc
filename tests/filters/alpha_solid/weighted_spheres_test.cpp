// SPDX-License-Identifier: GPL-3.0-or-later
// The values of the facets of a cell of weighted points, against closed forms and exact arithmetic.

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "filters/alpha_solid/orthogonal_spheres.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::alpha {
namespace {

using namespace spheres;
using namespace test;

double lowered(const Ball& ball, double largest) { return CGAL::to_double(Number(ball.squared + Number(largest))); }

bool is_flat(const std::array<WeightedPoint, 4>& p) {
    const auto [u, v, w] = offsets_from<Number>(*p[0].position, *p[1].position, *p[2].position, *p[3].position);
    return dot(u, cross(v, w)) == 0;
}

/// Returns how many corners lay exactly on a facet's sphere.
int expect_exact(const std::array<WeightedPoint, 4>& p, double largest, const CellSpheres& spheres) {
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

int expect_exact(const std::array<WeightedPoint, 4>& p, double largest) {
    return expect_exact(p, largest, weighted_cell_spheres(p, largest));
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
    // Thirds and tenths are not doubles: ties on the lattice become decisions within a few roundings.
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

TEST(WeightedSpheres, FacetsOutsideTheMask_HaveTheContributionOfTheCellAlone) {
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

TEST(WeightedSpheres, SmallestAndLargestSizes_ScaleExactly) {
    const Vec3 a(0.1, 0.2, 0.3), b(1, 0.1, 0), c(0, 1.1, 0.2), d(0.3, 0, 0.9);
    const CellSpheres unit = weighted_cell_spheres({{{&a, 0.1}, {&b, 0.2}, {&c, 0}, {&d, 0.3}}}, 0.4);
    for (int exponent : {-30, 29}) {
        const double k = std::ldexp(1.0, exponent), kk = k * k;
        const Vec3 ka = k * a, kb = k * b, kc = k * c, kd = k * d;
        const CellSpheres scaled =
            weighted_cell_spheres({{{&ka, 0.1 * kk}, {&kb, 0.2 * kk}, {&kc, 0}, {&kd, 0.3 * kk}}}, 0.4 * kk);
        EXPECT_EQ(scaled.attached, unit.attached);
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(scaled.values[i] / kk / unit.values[i], 1, 1e-8);
    }
}

TEST(WeightedSpheres, LargeAndTinyOffsetsInOneCell_AgreeWithExactArithmetic) {
    // Products of these are far outside the range of double; the radii are not.
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        std::array<Vec3, 4> p;
        std::array<WeightedPoint, 4> corners;
        const double tiny = std::pow(10, -random.uniform(60, 140));
        for (int k = 0; k < 4; ++k) {
            for (double& coordinate : p[k]) coordinate = (k <= i % 3 ? tiny : 1) * random.uniform(-1, 1);
            corners[k] = {&p[k], random.uniform(0, 1) * tiny * tiny};
        }
        expect_exact(corners, 1);
        for (WeightedPoint& corner : corners) corner.weight = 0;
        expect_exact(corners, 0, cell_spheres(p[0], p[1], p[2], p[3]));
    }
}

}  // namespace
}  // namespace scanmill::alpha
