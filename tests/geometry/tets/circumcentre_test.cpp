// SPDX-License-Identifier: GPL-3.0-or-later
/// Circumcentres of cells: closed forms, and comparisons with exact rational numbers.

#include <CGAL/Exact_rational.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/random.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"
#include "scanmill/geometry/tets/sphere_polynomials.hpp"

namespace scanmill::test {
namespace {

using CellCorners = std::array<Vec3, 4>;
using Rational = CGAL::Exact_rational;
using RationalVector = std::array<Rational, 3>;

/// The circumcentre, which must be the same for all orders of the corners.
Vec3 centre_in_any_order(const CellCorners& corners) {
    const Vec3 centre = circumcentre(corners[0], corners[1], corners[2], corners[3]);
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    while (std::ranges::next_permutation(order).found)
        EXPECT_EQ(circumcentre(corners[order[0]], corners[order[1]], corners[order[2]], corners[order[3]]), centre);
    return centre;
}

RationalVector exact(const Vec3& p) { return {Rational(p.x()), Rational(p.y()), Rational(p.z())}; }

Rational squared_length(const RationalVector& v) { return Rational(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

Rational determinant(const RationalVector& u, const RationalVector& v, const RationalVector& w) {
    return Rational(u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
                    u[2] * (v[0] * w[1] - v[1] * w[0]));
}

/// The exact circumcentre, as the solution of 2 (p_i - p_0) · x = |p_i - p_0|² by Cramer's rule.
struct ExactCircumsphere {
    bool is_flat;
    RationalVector centre;
    Rational squared_radius;

    explicit ExactCircumsphere(const CellCorners& corners) {
        const RationalVector origin = exact(corners[0]);
        std::array<RationalVector, 3> rows;
        RationalVector right;
        for (std::size_t i = 0; i < 3; ++i) {
            const RationalVector corner = exact(corners[i + 1]);
            for (std::size_t k = 0; k < 3; ++k) rows[i][k] = corner[k] - origin[k];
            right[i] = squared_length(rows[i]) / 2;
        }
        const Rational whole = determinant(rows[0], rows[1], rows[2]);
        is_flat = whole == 0;
        if (is_flat) return;
        RationalVector offset;
        for (std::size_t k = 0; k < 3; ++k) {
            std::array<RationalVector, 3> replaced = rows;
            for (std::size_t i = 0; i < 3; ++i) replaced[i][k] = right[i];
            offset[k] = determinant(replaced[0], replaced[1], replaced[2]) / whole;
            centre[k] = origin[k] + offset[k];
        }
        squared_radius = squared_length(offset);
    }

    /// Whether the distance from the exact centre is at most 1e-8 radii, plus the rounding of a sum of doubles for each
    /// coordinate.
    bool agrees_with(const Vec3& found) const {
        if (!found.allFinite()) return false;
        RationalVector excess;
        for (std::size_t k = 0; k < 3; ++k) {
            const double coordinate = found[static_cast<int>(k)];
            const Rational rounding = Rational(std::abs(coordinate)) * Rational(0x1p-53);
            Rational error = Rational(coordinate) - centre[k];
            if (error < 0) error = -error;
            excess[k] = error > rounding ? Rational(error - rounding) : Rational(0);
        }
        return squared_length(excess) <= Rational(1e-8) * Rational(1e-8) * squared_radius;
    }
};

/// The same formula in plain doubles.
Vec3 naive_centre(const CellCorners& corners) {
    const auto [u, v, w] = spheres::offsets_from(corners[0], corners[1], corners[2], corners[3]);
    const auto vw = spheres::cross(v, w);
    const auto numerator = spheres::circumcentre_numerator(spheres::dot(u, u), spheres::dot(v, v), spheres::dot(w, w),
                                                           vw, spheres::cross(w, u), spheres::cross(u, v));
    return corners[0] + Vec3(numerator[0], numerator[1], numerator[2]) / (2 * spheres::dot(u, vw));
}

Vec3 uniform_in_cube(Random& random) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    return {x, y, random.uniform(-1, 1)};
}

/// Moves and scales the corners, so that they have the rounded coordinates of a scan.
void place(CellCorners& corners, Random& random) {
    const double scale = std::ldexp(1.0, static_cast<int>(random.index(121)) - 60);
    const Vec3 shift = random.index(2) == 0 ? Vec3(0, 0, 0) : Vec3(1000 * uniform_in_cube(random));
    for (Vec3& corner : corners) corner = scale * (corner + shift);
}

TEST(Circumcentre, RegularTetrahedron_IsItsMiddle) {
    EXPECT_EQ(centre_in_any_order({{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}}), Vec3(0, 0, 0));
    EXPECT_EQ(centre_in_any_order({{{6, -2, 8}, {6, -4, 6}, {4, -2, 6}, {4, -4, 8}}}), Vec3(5, -3, 7));
}

TEST(Circumcentre, RightAngledCorner_IsHalfTheDiagonalOfTheBox) {
    EXPECT_EQ(centre_in_any_order({{{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {0, 0, 6}}}), Vec3(1, 2, 3));
    EXPECT_EQ(centre_in_any_order({{{10, 20, 30}, {8, 20, 30}, {10, 24, 30}, {10, 20, 24}}}), Vec3(9, 22, 27));
}

TEST(Circumcentre, ABentSquare_IsHalfwayBetweenItsDiagonals) {
    // Equal distances from (1, 0, 0) and (0, 1, h): z = h / 2. The volume is 2/3 h.
    for (const int exponent : {-3, -20, -40, -60, -300, -1000}) {
        const double height = std::ldexp(1.0, exponent);
        const Vec3 centre = centre_in_any_order({{{1, 0, 0}, {-1, 0, 0}, {0, 1, height}, {0, -1, height}}});
        EXPECT_EQ(centre, Vec3(0, 0, height / 2)) << exponent;
    }
}

TEST(Circumcentre, BeyondTheRangeOfDouble_IsFinite) {
    // The centre is at z = -0.21 / 1e-310.
    const Vec3 centre = centre_in_any_order({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-310}}});
    EXPECT_LT(centre.z(), -1e307);
    EXPECT_TRUE(centre.allFinite());
}

TEST(Circumcentre, RandomCells_AgreeWithExactNumbers) {
    Random random(1);
    for (int round = 0; round < 2000; ++round) {
        CellCorners corners;
        for (Vec3& corner : corners) corner = uniform_in_cube(random);
        place(corners, random);
        const ExactCircumsphere sphere(corners);
        ASSERT_FALSE(sphere.is_flat);
        EXPECT_TRUE(sphere.agrees_with(centre_in_any_order(corners))) << round;
    }
}

TEST(Circumcentre, Slivers_AgreeWithExactNumbers) {
    Random random(2);
    int tested = 0, naive_failures = 0;
    while (tested < 500) {
        // The fourth corner is near the plane of the others, at 1e-3 to 1e-14 of their distances.
        CellCorners corners;
        for (std::size_t i = 0; i < 3; ++i) corners[i] = uniform_in_cube(random);
        const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
        const Vec3 normal(u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x());
        const double along_u = random.uniform(-1, 2), along_v = random.uniform(-1, 2);
        const double height = std::pow(10, -random.uniform(3, 14)) * u.norm() / normal.norm();
        corners[3] = corners[0] + along_u * u + along_v * v + height * normal;
        std::swap(corners[3], corners[random.index(4)]);
        place(corners, random);
        const ExactCircumsphere sphere(corners);
        if (sphere.is_flat) continue;
        ++tested;
        EXPECT_TRUE(sphere.agrees_with(centre_in_any_order(corners))) << tested;
        naive_failures += !sphere.agrees_with(naive_centre(corners));
    }
    EXPECT_GT(naive_failures, 50) << "the slivers are too easy";
}

TEST(Circumcentre, NearDuplicates_AgreeWithExactNumbers) {
    Random random(3);
    for (int tested = 0; tested < 500;) {
        // Two corners are close together, or two pairs, or three corners.
        CellCorners corners;
        for (Vec3& corner : corners) corner = uniform_in_cube(random);
        const auto draw_near = [&](std::size_t which, std::size_t other) {
            const double distance = std::pow(10, -random.uniform(3, 300));
            // Near 0, coordinates resolve such a distance.
            if (random.index(2) == 0) corners[other] = Vec3(0, 0, 0);
            corners[which] = corners[other] + distance * uniform_in_cube(random);
        };
        draw_near(1, 0);
        if (tested % 3 == 1) draw_near(3, 2);
        if (tested % 3 == 2) draw_near(2, 1);
        const ExactCircumsphere sphere(corners);
        if (sphere.is_flat || sphere.squared_radius > Rational(1e200)) continue;
        ++tested;
        EXPECT_TRUE(sphere.agrees_with(centre_in_any_order(corners))) << tested;
    }
}

TEST(Circumcentre, OfAllCells_AreThoseOfEachCell) {
    // More cells than one chunk of work.
    Random random(4);
    Array<Vec3> positions(50);
    for (Vec3& p : positions) p = uniform_in_cube(random);
    Array<Tetrahedron> cells(40'000);
    for (Tetrahedron& cell : cells) do {
            for (u32& corner : cell) corner = static_cast<u32>(random.index(positions.size()));
            std::ranges::sort(cell);
        } while (std::ranges::adjacent_find(cell) != cell.end());
    TetMesh tets;
    tets.positions = std::move(positions);
    tets.cells = std::move(cells);
    for (const unsigned threads : {1u, 2u}) {
        ExecutionOptions options;
        options.threads = threads;
        Execution execution(options);
        const Array<Vec3> centres = circumcentres(tets, execution);
        ASSERT_EQ(centres.size(), tets.cells.size());
        for (std::size_t c = 0; c < centres.size(); ++c) {
            const auto& [i, j, k, l] = tets.cells[c];
            const auto& p = tets.positions;
            ASSERT_EQ(centres[c], circumcentre(p[i], p[j], p[k], p[l])) << c;
        }
    }
}

}  // namespace
}  // namespace scanmill::test
