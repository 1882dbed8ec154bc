// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "alpha_solid/descending_queue.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"

namespace scanmill::alpha {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
Kernel::Point_3 exact(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

double exact_square(const Vec3& a, const Vec3& b, const Vec3& c) {
    return CGAL::to_double(CGAL::exact(CGAL::squared_radius(exact(a), exact(b), exact(c))));
}
double exact_square(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return CGAL::to_double(CGAL::exact(CGAL::squared_radius(exact(a), exact(b), exact(c), exact(d))));
}
bool exactly_inside(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return CGAL::side_of_bounded_sphere(exact(a), exact(b), exact(c), exact(d)) == CGAL::ON_BOUNDED_SIDE;
}

u8 exact_attached(const std::array<Vec3, 4>& p) {
    u8 bits = 0;
    for (int i = 0; i < 4; ++i)
        if (exactly_inside(p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4], p[i])) bits |= static_cast<u8>(1 << i);
    return bits;
}

Vec3 random_point(Random& random, double size) {
    const double x = random.uniform(-size, size), y = random.uniform(-size, size);
    return {x, y, random.uniform(-size, size)};
}

bool is_flat(const std::array<Vec3, 4>& p) {
    return CGAL::orientation(exact(p[0]), exact(p[1]), exact(p[2]), exact(p[3])) == CGAL::COPLANAR;
}

void expect_exact(const std::array<Vec3, 4>& p) {
    const CellSpheres spheres = cell_spheres(p[0], p[1], p[2], p[3]);
    EXPECT_EQ(spheres.attached, exact_attached(p));
    const double cell = exact_square(p[0], p[1], p[2], p[3]);
    for (int i = 0; i < 4; ++i) {
        const Vec3 &a = p[(i + 1) % 4], &b = p[(i + 2) % 4], &c = p[(i + 3) % 4];
        EXPECT_NEAR(spheres.values[i] / (spheres.attached >> i & 1 ? cell : exact_square(a, b, c)), 1, 1e-8);
        EXPECT_TRUE(spheres.attached >> i & 1 || spheres.values[i] == squared_circumradius(a, b, c));
    }
}

TEST(CellSpheres, RegularTetrahedron_HasItsClosedFormsAndNoAttachedFacet) {
    const Vec3 a(1, 1, 1), b(1, -1, -1), c(-1, 1, -1), d(-1, -1, 1);  // edge √8
    EXPECT_DOUBLE_EQ(squared_circumradius(a, b, c), 8.0 / 3);
    const CellSpheres spheres = cell_spheres(a, b, c, d);
    EXPECT_EQ(spheres.attached, 0);
    for (double value : spheres.values) EXPECT_DOUBLE_EQ(value, 8.0 / 3);
}

TEST(CellSpheres, FlatTetrahedron_HasTheWideFacetAttachedByItsLowApex) {
    // The apex lies just above the centre of the base: inside the smallest sphere of the base. No other corner is
    // inside the sphere of its facet.
    const Vec3 a(1, 0, 0), b(-0.5, 0.75, 0), c(-0.5, -0.75, 0), apex(0, 0, 0.25);
    EXPECT_EQ(cell_spheres(a, b, c, apex).attached, 0b1000);
    EXPECT_DOUBLE_EQ(cell_spheres(a, b, c, apex).values[3], exact_square(a, b, c, apex));
    EXPECT_DOUBLE_EQ(cell_spheres(a, b, c, apex).values[0], exact_square(b, c, apex));
    EXPECT_EQ(cell_spheres(apex, b, c, a).attached, 0b0001);
    EXPECT_EQ(cell_spheres(a, apex, b, c).attached, 0b0010);
}

TEST(CellSpheres, CornerExactlyOnTheSmallestSphere_DoesNotAttach) {
    // The base holds a diameter of the circumsphere, so the circumcentre lies in the base.
    const Vec3 a(1, 0, 0), b(-1, 0, 0), c(0, 1, 0), d(0, 0, 1);
    EXPECT_EQ(cell_spheres(a, b, c, d).attached, 0);
    // A hair inside is inside.
    EXPECT_EQ(cell_spheres(a, b, c, Vec3(0, 0, std::nextafter(1.0, 0.0))).attached, 0b1000);
    EXPECT_EQ(cell_spheres(a, b, c, Vec3(0, 0, std::nextafter(1.0, 2.0))).attached & 0b1000, 0);
}

TEST(CellSpheres, RandomTetrahedra_AgreeWithExactArithmetic) {
    Random random(11);
    for (int i = 0; i < 2000; ++i) {
        std::array<Vec3, 4> p;
        for (Vec3& q : p) q = random_point(random, 1);
        expect_exact(p);
    }
}

TEST(CellSpheres, TetrahedraOnASmallLattice_AgreeWithExactArithmetic) {
    Random random(12);
    int with_ties = 0;
    for (int i = 0; i < 3000; ++i) {
        std::array<Vec3, 4> p;
        for (Vec3& q : p)
            for (int axis = 0; axis < 3; ++axis) q[axis] = static_cast<double>(random.index(3));
        if (is_flat(p)) continue;
        expect_exact(p);
        for (int k = 0; k < 4; ++k)
            with_ties += CGAL::side_of_bounded_sphere(exact(p[(k + 1) % 4]), exact(p[(k + 2) % 4]),
                                                      exact(p[(k + 3) % 4]), exact(p[k])) == CGAL::ON_BOUNDARY;
    }
    EXPECT_GT(with_ties, 500);
}

TEST(CellSpheres, TetrahedraOneLastPlaceFromATie_AgreeWithExactArithmetic) {
    Random random(13);
    for (int i = 0; i < 2000; ++i) {
        std::array<Vec3, 4> p;
        for (Vec3& q : p)
            for (int axis = 0; axis < 3; ++axis) {
                const double value = 1 + 0.1 * static_cast<double>(random.index(3));
                q[axis] = random.index(2) == 0 ? value : std::nextafter(value, random.index(2) == 0 ? 0.0 : 9.0);
            }
        if (is_flat(p)) continue;
        expect_exact(p);
    }
}

TEST(CellSpheres, NeedlesSliversAndFarPoints_AgreeWithExactArithmetic) {
    Random random(14);
    for (int i = 0; i < 3000; ++i) {
        std::array<Vec3, 4> p;
        for (Vec3& q : p) q = random_point(random, 1);
        const double thinness = std::pow(10, -random.uniform(0, 14));
        if (i % 3 == 0) p[3] = (p[0] + p[1] + p[2]) / 3 + thinness * random_point(random, 1);
        if (i % 3 == 1) p[2] = p[0] + thinness * random_point(random, 1);
        if (i % 3 == 2) p[1] = p[0] + (p[2] - p[0]) * 0.5 + thinness * random_point(random, 1);
        if (i % 2 == 0)
            for (Vec3& q : p) q += Vec3(1000, -500, 20);
        if (is_flat(p)) continue;
        expect_exact(p);
    }
}

TEST(CellSpheres, SmallestAndLargestSizes_ScaleExactly) {
    Random random(15);
    for (int i = 0; i < 200; ++i) {
        std::array<Vec3, 4> p;
        for (Vec3& q : p) q = random_point(random, 1);
        const CellSpheres unit = cell_spheres(p[0], p[1], p[2], p[3]);
        for (int exponent : {-30, -10, 10, 29}) {
            const double factor = std::ldexp(1.0, exponent);
            const CellSpheres scaled = cell_spheres(factor * p[0], factor * p[1], factor * p[2], factor * p[3]);
            EXPECT_EQ(scaled.attached, unit.attached);
            for (int k = 0; k < 4; ++k) EXPECT_NEAR(scaled.values[k] / factor / factor / unit.values[k], 1, 1e-8);
        }
    }
}

TEST(CellSpheres, CornersInAnyOrder_GiveTheSameBits) {
    Random random(16);
    for (int i = 0; i < 300; ++i) {
        std::array<Vec3, 4> p;
        for (Vec3& q : p) q = random_point(random, 1);
        const CellSpheres cell = cell_spheres(p[0], p[1], p[2], p[3]);
        const double facet = squared_circumradius(p[0], p[1], p[2]);
        std::array<int, 4> order{0, 1, 2, 3};
        while (std::next_permutation(order.begin(), order.end())) {
            const CellSpheres permuted = cell_spheres(p[order[0]], p[order[1]], p[order[2]], p[order[3]]);
            for (int k = 0; k < 4; ++k) {
                EXPECT_EQ(permuted.values[k], cell.values[order[k]]);
                EXPECT_EQ(permuted.attached >> k & 1, cell.attached >> order[k] & 1);
            }
        }
        std::array<int, 3> corners{0, 1, 2};
        while (std::next_permutation(corners.begin(), corners.end()))
            EXPECT_EQ(squared_circumradius(p[corners[0]], p[corners[1]], p[corners[2]]), facet);
    }
}

TEST(DescendingQueue, ValuesThatFall_ComeOutSorted) {
    Random random(17);
    DescendingQueue queue;
    std::vector<double> all, popped;
    const auto push = [&](double value) {
        queue.push(value, static_cast<u32>(all.size()));
        all.push_back(value);
    };
    for (int i = 0; i < 100; ++i) push(std::exp(random.uniform(-30, 30)));
    push(0);
    u32 item = 0;
    while (queue.pop(item, [](u32) { return true; })) {
        EXPECT_EQ(queue.level(), all[item]);
        popped.push_back(all[item]);
        if (all.size() < 3000) {
            push(queue.level() * random.uniform());
            push(queue.level());
        }
    }
    EXPECT_EQ(popped.size(), all.size());
    EXPECT_TRUE(std::ranges::is_sorted(popped, std::greater<>()));
}

TEST(DescendingQueue, UnwantedItems_AreSkipped) {
    DescendingQueue queue;
    for (u32 i = 0; i < 10; ++i) queue.push(1.0 + i, i);
    u32 item = 0;
    std::vector<u32> popped;
    while (queue.pop(item, [](u32 candidate) { return candidate % 2 == 1; })) popped.push_back(item);
    EXPECT_EQ(popped, (std::vector<u32>{9, 7, 5, 3, 1}));
}

}  // namespace
}  // namespace scanmill::alpha
