// SPDX-License-Identifier: GPL-3.0-or-later
/// Points inside and outside closed surfaces.
#include "scanmill/geometry/distance/enclosed.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "scanmill/base/random.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

Array<u8> enclosed_by(const TriangleMesh& mesh, const Array<Vec3>& points, unsigned threads = 2) {
    ExecutionOptions options;
    options.threads = threads;
    Execution execution(options);
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), threads);
    return enclosed(points, mesh.positions.span(), mesh.triangles.span(), tree, execution);
}

bool encloses(const TriangleMesh& mesh, const Vec3& point) { return enclosed_by(mesh, {point}, 1).front() != 0; }

/// Van Oosterom, Strackee 1983. Rounded: for points that are not near the surface.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

double winding_number(const TriangleMesh& mesh, const Vec3& point) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += solid_angle(mesh.positions[a] - point, mesh.positions[b] - point, mesh.positions[c] - point);
    return sum / (4 * std::numbers::pi);
}

TEST(Enclosed, RaysThroughEdgesAndCorners_CountOnce) {
    // Every ray from a point with two equal coordinates meets a diagonal of a side, or an edge of the mesh.
    const TriangleMesh block = l_block(2);
    for (const double x : {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5})
        for (const double y : {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5})
            for (const double z : {0.5, 1.0, 1.5}) {
                if ((x == 2 && y >= 2) || (y == 2 && x >= 2)) continue;  // on the surface
                EXPECT_EQ(encloses(block, {x, y, z}), x < 2 || y < 2) << x << ' ' << y << ' ' << z;
            }
}

TEST(Enclosed, PointsNextToTheSurface_AreDecidedExactly) {
    const double tiny = 0x1p-52;
    for (const double x : {0.0, 1.0})
        for (const double y : {0.0, 1.0, 0.25, 0.5})
            for (const double z : {0.0, 1.0, 0.25, 0.5}) {
                // The nearest point of the cube is on a side, an edge or a corner.
                const auto moved = [&](double by) {
                    const auto along = [&](double at) { return at == 0 ? at - by : at == 1 ? at + by : at; };
                    return Vec3(along(x), along(y), along(z));
                };
                EXPECT_TRUE(encloses(cube(), moved(-tiny))) << x << ' ' << y << ' ' << z;
                EXPECT_FALSE(encloses(cube(), moved(tiny))) << x << ' ' << y << ' ' << z;
            }
}

TEST(Enclosed, OutsideTheBoundingBox_IsNothing) {
    for (const Vec3& point : {Vec3(2, 0.5, 0.5), Vec3(0.5, -1, 0.5), Vec3(0.5, 0.5, 1e9), Vec3(-1, -1, -1)})
        EXPECT_FALSE(encloses(cube(), point));
}

TEST(Enclosed, Orientation_DoesNotMatter) {
    EXPECT_TRUE(encloses(inside_out(cube()), {0.5, 0.25, 0.125}));
    EXPECT_FALSE(encloses(inside_out(cube()), {1.5, 0.25, 0.125}));
    EXPECT_FALSE(encloses(inside_out(torus(2, 0.5, 24, 12)), {0, 0, 0}));
    EXPECT_TRUE(encloses(inside_out(torus(2, 0.5, 24, 12)), {2, 0, 0}));
}

TEST(Enclosed, InnerSurface_BoundsACavityIfItFacesInward) {
    const TriangleMesh outer = geodesic_sphere(2, 6), inner = geodesic_sphere(1, 6);
    EXPECT_FALSE(encloses(both(outer, inside_out(inner)), {0.1, 0.2, 0.3}));
    EXPECT_FALSE(encloses(inside_out(both(outer, inside_out(inner))), {0.1, 0.2, 0.3}));
    EXPECT_TRUE(encloses(both(outer, inside_out(inner)), {1.5, 0, 0}));
    EXPECT_TRUE(encloses(both(outer, inner), {0.1, 0.2, 0.3})) << "two solids, one inside the other";
}

TEST(Enclosed, SolidsThatTouchOrOverlap_EncloseTheirUnion) {
    // A common side, where two triangles of opposite orientation are equally near.
    const TriangleMesh touching = both(cube(), shifted(cube(), {1, 0, 0}));
    for (const double x : {0.25, 0.99999, 1.00001, 1.75}) EXPECT_TRUE(encloses(touching, {x, 0.3, 0.4})) << x;
    EXPECT_FALSE(encloses(touching, {2.25, 0.3, 0.4}));
    const TriangleMesh overlapping = both(cube(), shifted(cube(), {0.5, 0.5, 0.5}));
    EXPECT_TRUE(encloses(overlapping, {0.75, 0.75, 0.75}));
    EXPECT_TRUE(encloses(overlapping, {0.25, 0.25, 0.25}));
    EXPECT_FALSE(encloses(overlapping, {0.25, 0.25, 1.25}));
}

TEST(Enclosed, DegenerateTriangles_ChangeNothing) {
    // The tetrahedron's edge from 0 to 1 is divided on one side only; a triangle without area closes the gap.
    const TriangleMesh divided = soup({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}},
                                      {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 1, 4}, {0, 3, 2}, {1, 2, 3}});
    for (const double z : {1e-9, 0.1, 0.25})
        for (const double x : {0.5, 1.0, 1.5}) {
            EXPECT_TRUE(encloses(divided, {x, 1e-9, z})) << x << ' ' << z;
            EXPECT_FALSE(encloses(divided, {x, -1e-9, z})) << x << ' ' << z;
            EXPECT_FALSE(encloses(divided, {x, 1e-9, -z})) << x << ' ' << z;
        }
}

TEST(Enclosed, RandomPoints_AgreeWithTheSolidAngle) {
    Random random(7);
    const TriangleMesh bumpy =
        with_positions(geodesic_sphere(1, 5), [&](const Vec3& p) -> Vec3 { return p * random.uniform(0.4, 1.3); });
    for (const TriangleMesh& mesh :
         {bumpy, torus(1, 0.4, 17, 9), both(bumpy, shifted(inside_out(bumpy), {0.3, 0.2, 0})),
          turned(l_block(0.7), 0.3, {1, 2, 3}), shifted(bumpy, {1 << 20, -(1 << 20), 3})}) {
        BoundingBox box = surface_box(mesh);
        Array<Vec3> points;
        for (int i = 0; i < 2000; ++i)
            points.push_back(
                box.low + Vec3(random.uniform(), random.uniform(), random.uniform()).cwiseProduct(box.high - box.low));
        // Rays along these meet corners.
        for (const Vec3& p : mesh.positions) points.push_back(p + random.uniform(-0.5, 0.5) * Vec3::UnitX());
        const Array<u8> found = enclosed_by(mesh, points);
        std::size_t inside = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double winding = winding_number(mesh, points[i]);
            if (std::abs(winding - std::round(winding)) > 1e-6) continue;  // on the surface
            EXPECT_EQ(found[i] != 0, std::round(winding) != 0) << winding;
            inside += found[i];
        }
        EXPECT_GT(inside, 100u);
        EXPECT_LT(inside, points.size() - 100);
    }
}

TEST(Enclosed, AnyNumberOfThreads_GivesTheSame) {
    const TriangleMesh mesh = torus(2, 0.7, 60, 30);
    Random random(3);
    Array<Vec3> points;
    for (int i = 0; i < 20'000; ++i)
        points.emplace_back(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-1, 1));
    EXPECT_EQ(enclosed_by(mesh, points, 3), enclosed_by(mesh, points, 1));
}

}  // namespace
}  // namespace scanmill::test
