// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/patches/a_patch.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/patches/a_patch_example.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

/// The weights of the polynomial with polar form `blossom` over the tetrahedron.
template <class Blossom>
PatchWeights weights_of(const std::array<Vec3, 4>& corners, Blossom&& blossom) {
    PatchWeights weights;
    std::size_t number = 0;
    for (int i = 3; i >= 0; --i)
        for (int j = 3 - i; j >= 0; --j)
            for (int k = 3 - i - j; k >= 0; --k) {
                std::vector<Vec3> at;
                for (int n = 0; n < i; ++n) at.push_back(corners[0]);
                for (int n = 0; n < j; ++n) at.push_back(corners[1]);
                for (int n = 0; n < k; ++n) at.push_back(corners[2]);
                while (at.size() < 3) at.push_back(corners[3]);
                weights[number++] = blossom(at[0], at[1], at[2]);
            }
    return weights;
}

const std::array<Vec3, 4> some_corners{Vec3(0.1, 0.2, 0), Vec3(2, 0.3, 0.1), Vec3(0.4, 1.5, -0.2), Vec3(0.5, 0.6, 2)};

/// x y z + x² - z, with its polar form.
double cubic(const Vec3& p) { return p.x() * p.y() * p.z() + p.x() * p.x() - p.z(); }
double cubic_blossom(const Vec3& a, const Vec3& b, const Vec3& c) {
    double product = 0;
    for (const auto& [u, v, w] : {std::tuple(a, b, c), std::tuple(a, c, b), std::tuple(b, a, c), std::tuple(b, c, a),
                                  std::tuple(c, a, b), std::tuple(c, b, a)})
        product += u.x() * v.y() * w.z() / 6;
    return product + (a.x() * b.x() + b.x() * c.x() + c.x() * a.x()) / 3 - (a.z() + b.z() + c.z()) / 3;
}

TEST(PatchCell, AKnownCubic_HasItsValueGradientAndSecondDerivatives) {
    const PatchWeights weights = weights_of(some_corners, cubic_blossom);
    const PatchCell cell(some_corners, weights);
    Random random(1);
    for (int i = 0; i < 50; ++i) {
        const Vec3 p(random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 2));
        EXPECT_NEAR(cell.value(p), cubic(p), 1e-12);
        const Vec3 gradient(p.y() * p.z() + 2 * p.x(), p.x() * p.z(), p.x() * p.y() - 1);
        EXPECT_LT((cell.gradient(p) - gradient).norm(), 1e-12);
        Eigen::Matrix3d second;
        second << 2, p.z(), p.y(), p.z(), 0, p.x(), p.y(), p.x(), 0;
        EXPECT_LT((cell.hessian(p) - second).norm(), 1e-11);
        EXPECT_LT((cell.point(cell.coordinates(p)) - p).norm(), 1e-14);
    }
}

TEST(PatchCell, ThePolarForm_IsSymmetricAndAffine) {
    const PatchWeights weights = weights_of(some_corners, cubic_blossom);
    const PatchCell cell(some_corners, weights);
    const Vec3 a(0.3, 0.1, 0.7), b(1, -0.2, 0.4), c(-0.5, 0.6, 0.9);
    const auto f = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
        return patch_blossom(weights, cell.coordinates(p), cell.coordinates(q), cell.coordinates(r));
    };
    EXPECT_NEAR(f(a, b, c), cubic_blossom(a, b, c), 1e-13);
    EXPECT_NEAR(f(a, b, c), f(c, a, b), 1e-14);
    EXPECT_NEAR(f((a + c) / 2, b, c), (f(a, b, c) + f(c, b, c)) / 2, 1e-14);
}

TEST(ZeroOfCubic, IsFoundToTheLastBits) {
    EXPECT_EQ(zero_of_cubic({0, 1, 1, 1}), 0.0);
    EXPECT_EQ(zero_of_cubic({1, 1, 1, 0}), 1.0);
    EXPECT_EQ(zero_of_cubic({1, 2, 3, 4}), std::nullopt);
    // t - 1/3 as a cubic, and t³ - 1/8.
    EXPECT_NEAR(*zero_of_cubic({-1. / 3, 0, 1. / 3, 2. / 3}), 1. / 3, 1e-16);
    EXPECT_NEAR(*zero_of_cubic({-0.125, -0.125, -0.125, 0.875}), 0.5, 1e-16);
}

TEST(ZerosOfCubic, AreAllFoundInOrder) {
    // (t - 1/4)(t - 1/2)(t - 3/4) has the Bernstein weights -3/32, 13/96 …: computed from its polar form.
    const auto weights = [](double r, double s, double t) {
        const auto f = [&](double a, double b, double c) {
            return a * b * c - (r + s + t) * (a * b + b * c + c * a) / 3 + (r * s + s * t + t * r) * (a + b + c) / 3 -
                   r * s * t;
        };
        return std::array<double, 4>{f(0, 0, 0), f(0, 0, 1), f(0, 1, 1), f(1, 1, 1)};
    };
    const auto expect = [&](const std::array<double, 4>& cubic, const std::vector<double>& wanted) {
        const std::vector<double> found = zeros_of_cubic(cubic);
        ASSERT_EQ(found.size(), wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-14);
    };
    expect(weights(0.25, 0.5, 0.75), {0.25, 0.5, 0.75});
    expect(weights(0.7, 0.1, 0.2), {0.1, 0.2, 0.7});
    expect(weights(0.6, -1, 2), {0.6});
    expect(weights(-0.6, -1, 2), {});
    expect(weights(0, 0.25, 1), {0, 0.25, 1});
    expect({0, 1, 1, 1}, {0});
    expect({1, 1, 1, 0}, {1});
    expect({0, 0, 0, 0}, {0});
}

/// One tetrahedron with the unit sphere's function |x|² / 2 - 1 / 2.
PatchComplex one_tet() {
    PatchComplex patches;
    const std::array<Vec3, 4> corners{Vec3(-3, -3, -2), Vec3(6, -3, -2), Vec3(-3, 6, -2), Vec3(-1, -1, 5)};
    patches.positions = Array<Vec3>(corners.begin(), corners.end());
    patches.tets = {std::array<u32, 4>{0, 1, 2, 3}};
    patches.weights = {weights_of(corners, [](const Vec3& a, const Vec3& b, const Vec3& c) {
        return (a.dot(b) + b.dot(c) + c.dot(a)) / 6 - 0.5;
    })};
    patches.kinds = {PatchKind::face};
    patches.sides = {1};
    patches.triangles = {0};
    patches.edges = {PatchComplex::no_edge};
    patches.combine = {Combine::none};
    patches.partners = {PatchComplex::no_partner};
    return patches;
}

TEST(PatchSurface, OfASphereInOneTetrahedron_AnswersEveryQuestion) {
    const PatchComplex patches = one_tet();
    const PatchSurface surface(patches);
    EXPECT_EQ(surface.locate(Vec3(0, 0, 0)), 0u);
    EXPECT_EQ(surface.locate(Vec3(9, 0, 0)), std::nullopt);
    EXPECT_NEAR(*surface.value(Vec3(0, 0, 2)), 1.5, 1e-13);
    EXPECT_LT((*surface.gradient(Vec3(0, 0, 2)) - Vec3(0, 0, 2)).norm(), 1e-13);
    EXPECT_LT((*surface.hessian(Vec3(0.1, 0, 1)) - Eigen::Matrix3d::Identity()).norm(), 1e-13);
    EXPECT_FALSE(surface.value(Vec3(0, 9, 0)));
    EXPECT_TRUE(surface.is_inside(Vec3(0.5, 0, 0)));
    EXPECT_FALSE(surface.is_inside(Vec3(1.5, 0, 0)));
    EXPECT_FALSE(surface.is_inside(Vec3(-50, 0, 0))) << "the first hit of a ray enters the sphere";
    // The ray passes through the sphere; the first of its two hits counts.
    const auto hit = surface.first_hit(Vec3(-1.8, 0, 0.1), Vec3(3, 0, 0));
    ASSERT_TRUE(hit);
    EXPECT_LT((hit->point - Vec3(-std::sqrt(0.99), 0, 0.1)).norm(), 1e-13);
    EXPECT_FALSE(surface.first_hit(Vec3(-1.8, 0, 0.1), Vec3(0.2, 0, 0))) << "the segment ends before the sphere";
    EXPECT_FALSE(surface.first_hit(Vec3(-50, 0, 0), Vec3(0, 1, 0)));
    const auto foot = surface.foot(Vec3(0.3, 0.4, 1.2));
    ASSERT_TRUE(foot);
    EXPECT_NEAR(foot->distance, 0.3, 1e-13);
    const auto from_inside = surface.foot(Vec3(0.45, 0.6, 0));
    ASSERT_TRUE(from_inside);
    EXPECT_NEAR(from_inside->distance, -0.25, 1e-12);
    const auto from_near_the_centre = surface.foot(Vec3(0.1, 0, 0));
    ASSERT_TRUE(from_near_the_centre) << "the first step would leave the tetrahedron";
    EXPECT_NEAR(from_near_the_centre->distance, -0.9, 1e-12);
    // From any start on the same hemisphere, for points outside the tetrahedron, too.
    const auto from_afar = surface.foot(Vec3(0, 0, 50), Vec3(0.4, 0.3, 1));
    ASSERT_TRUE(from_afar);
    EXPECT_NEAR(from_afar->distance, 49, 1e-11);
    EXPECT_LT((from_afar->point - Vec3(0, 0, 1)).norm(), 1e-11);
    EXPECT_FALSE(surface.foot(Vec3(9, 0, 0))) << "outside the tetrahedron";
}

/// In one tetrahedron, the larger or smaller of the sphere's function and of 2 z - 1.2, in the partner's own order of
/// corners. The crease is the circle of radius 0.8 in z = 0.6.
PatchComplex sphere_and_plane(Combine combine) {
    PatchComplex patches = one_tet();
    const std::array<u32, 4> order{3, 1, 0, 2};
    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = patches.positions[order[i]];
    patches.tets = {patches.tets[0], order};
    patches.weights = {patches.weights[0], weights_of(corners, [](const Vec3& a, const Vec3& b, const Vec3& c) {
                           return 2 * (a.z() + b.z() + c.z()) / 3 - 1.2;
                       })};
    patches.kinds = {PatchKind::face, PatchKind::continuation};
    patches.sides = {1, 1};
    patches.triangles = {0, 0};
    patches.edges = {PatchComplex::no_edge, 0};
    patches.combine = {combine, combine};
    patches.partners = {1, 0};
    return patches;
}

TEST(PatchSurface, OfTwoFunctions_TakesTheLargerAndItsDerivatives) {
    const PatchComplex patches = sphere_and_plane(Combine::max);
    const PatchSurface surface(patches);
    // A ball whose top is cut off. Inside the sphere, above the plane:
    const Vec3 above(0.1, 0.2, 0.8);
    EXPECT_EQ(surface.locate(above), 1u);
    EXPECT_NEAR(*surface.value(above), 0.4, 1e-13);
    EXPECT_LT((*surface.gradient(above) - Vec3(0, 0, 2)).norm(), 1e-13);
    EXPECT_LT(surface.hessian(above)->norm(), 1e-12);
    EXPECT_FALSE(surface.is_inside(above));
    const Vec3 beside(1.2, 0, 0);
    EXPECT_EQ(surface.locate(beside), 0u);
    EXPECT_LT((*surface.gradient(beside) - beside).norm(), 1e-13);
    EXPECT_TRUE(surface.is_inside(Vec3(0, 0, 0.5)));
    // From above the plane is hit, not the sphere behind it nor before it; from the side the sphere.
    const auto down = surface.first_hit(Vec3(0.1, 0.2, 2), Vec3(0, 0, -3));
    ASSERT_TRUE(down);
    EXPECT_NEAR(down->point.z(), 0.6, 1e-13);
    EXPECT_LT((down->gradient - Vec3(0, 0, 2)).norm(), 1e-12);
    const auto left = surface.first_hit(Vec3(1.5, 0, 0), Vec3(-3, 0, 0));
    ASSERT_TRUE(left);
    EXPECT_NEAR(left->point.x(), 1, 1e-13);
    EXPECT_FALSE(surface.first_hit(Vec3(-1.5, 0, 0.7), Vec3(3, 0, 0))) << "it passes above the plane";
    // The nearest point is in the plane, on the sphere, or on the crease.
    EXPECT_NEAR(surface.foot(Vec3(0.3, 0, 0.9))->distance, 0.3, 1e-13);
    EXPECT_NEAR(surface.foot(Vec3(1.3, 0, 0))->distance, 0.3, 1e-13);
    const auto on_crease = surface.foot(Vec3(0.9, 0, 0.9));
    ASSERT_TRUE(on_crease);
    EXPECT_LT((on_crease->point - Vec3(0.8, 0, 0.6)).norm(), 1e-12);
    EXPECT_NEAR(on_crease->distance, std::hypot(0.1, 0.3), 1e-12);
}

TEST(PatchSurface, OfTwoFunctions_TakesTheSmaller) {
    const PatchComplex patches = sphere_and_plane(Combine::min);
    const PatchSurface surface(patches);
    // Everything below the plane, and the top of the ball.
    EXPECT_TRUE(surface.is_inside(Vec3(1.2, 0, 0)));
    EXPECT_TRUE(surface.is_inside(Vec3(0.1, 0.2, 0.8)));
    const auto down = surface.first_hit(Vec3(0.1, 0.2, 2), Vec3(0, 0, -3));
    ASSERT_TRUE(down);
    EXPECT_NEAR(down->point.norm(), 1, 1e-13);
    const auto aside = surface.first_hit(Vec3(0.9, 0.2, 1.2), Vec3(0, 0, -1));
    ASSERT_TRUE(aside);
    EXPECT_NEAR(aside->point.z(), 0.6, 1e-13);
    const auto on_crease = surface.foot(Vec3(0.7, 0, 0.5));
    ASSERT_TRUE(on_crease);
    EXPECT_LT((on_crease->point - Vec3(0.8, 0, 0.6)).norm(), 1e-12);
    EXPECT_NEAR(on_crease->distance, -std::hypot(0.1, 0.1), 1e-12);
}

TEST(PatchSurface, TheExample_Works) {
    const Answer answer = ask(one_tet(), Vec3(0, 0, 0.5));
    EXPECT_TRUE(answer.is_inside);
    EXPECT_NEAR(answer.distance, -0.5, 1e-13);
    EXPECT_LT((answer.hit - Vec3(0, 0, 1)).norm(), 1e-13);
    EXPECT_LT((answer.normal - Vec3(0, 0, 1)).norm(), 1e-13);
}

}  // namespace
}  // namespace scanmill::test
