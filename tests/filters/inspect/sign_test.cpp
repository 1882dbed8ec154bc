// SPDX-License-Identifier: GPL-3.0-or-later
/// The signs of deviations beside faces, edges, vertices and borders.
#include <gmock/gmock.h>

#include "filters/inspect/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/numbers.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

Vec3 nearest_by_projection(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto on_segment = [&](const Vec3& from, const Vec3& to) -> Vec3 {
        const Vec3 along = to - from;
        const double squared = along.squaredNorm();
        return from + (squared > 0 ? std::clamp(along.dot(p - from) / squared, 0.0, 1.0) : 0.0) * along;
    };
    Vec3 best = on_segment(a, b);
    for (const Vec3& other : {on_segment(b, c), on_segment(c, a)})
        if ((other - p).norm() < (best - p).norm()) best = other;
    const Vec3 normal = (b - a).cross(c - a);
    if (!(normal.norm() > 0)) return best;
    const Vec3 foot = p - normal.dot(p - a) / normal.squaredNorm() * normal;
    const bool is_inside = (b - a).cross(foot - a).dot(normal) >= 0 && (c - b).cross(foot - b).dot(normal) >= 0 &&
                           (a - c).cross(foot - c).dot(normal) >= 0;
    return is_inside && (foot - p).norm() < (best - p).norm() ? foot : best;
}

/// The distance to the nearest of all triangles, negative if the sum of the solid angles of all triangles is not 0.
double distance_by_all(const Vec3& p, const TriangleMesh& mesh) {
    double least = infinity, angles = 0;
    for (const auto& [i, j, k] : mesh.triangles) {
        const Vec3 a = mesh.positions[i] - p, b = mesh.positions[j] - p, c = mesh.positions[k] - p;
        least = std::min(least, nearest_by_projection(Vec3(0, 0, 0), a, b, c).norm());
        const double na = a.norm(), nb = b.norm(), nc = c.norm();
        angles += 2 * std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
    }
    return std::abs(angles) > 2 * std::numbers::pi ? -least : least;
}

void expect_as_by_all_triangles(const TriangleMesh& mesh, std::size_t count, double margin) {
    const BoundingBox bounds = bounding_box(mesh.positions.span());
    const Array<Vec3> points = random_points(count, bounds.low, bounds.high, margin * bounds.diagonal(), 7);
    const Inspection found = inspected(cloud(points), mesh);
    EXPECT_EQ(found.undecided, 0u);
    for (std::size_t i = 0; i < count; ++i)
        EXPECT_NEAR(found.deviations[i], distance_by_all(points[i], mesh), 1e-9 * bounds.diagonal()) << i;
}

TEST(InspectSign, Cube_IsPositiveOutsideAndNegativeInside) {
    EXPECT_DOUBLE_EQ(deviation_at({0.5, 0.5, 1.25}, cube()), 0.25);
    EXPECT_DOUBLE_EQ(deviation_at({0.5, 0.5, 0.75}, cube()), -0.25);
    EXPECT_DOUBLE_EQ(deviation_at({-0.5, 0.5, 0.25}, cube()), 0.5);
}

TEST(InspectSign, BesideAnEdgeAndAVertex_IsDecided) {
    // The nearest points are the edge x = z = 1 and the corner (1, 1, 1).
    EXPECT_NEAR(deviation_at({1.3, 0.5, 1.4}, cube()), 0.5, 1e-15);
    EXPECT_NEAR(deviation_at({3, 2, 3}, cube()), 3, 1e-15);
    // Nearly level with one of the two faces.
    EXPECT_NEAR(deviation_at({1 + 1e-6, 0.5, 2}, cube()), 1, 1e-9);
}

TEST(InspectSign, ReflexEdge_IsDecidedOnBothSides) {
    // The L-block's inner edge is x = y = 1: points of the solid are nearest to it, none outside is.
    EXPECT_NEAR(deviation_at({0.9, 0.9, 0.5}, l_block()), -std::hypot(0.1, 0.1), 1e-15);
    EXPECT_NEAR(deviation_at({1.2, 1.3, 0.5}, l_block()), 0.2, 1e-15);
    // On the bisector of the two faces both are equally near.
    EXPECT_NEAR(deviation_at({1.2, 1.2, 0.5}, l_block()), 0.2, 1e-15);
}

TEST(InspectSign, NearestFaceOfASharpEdge_DoesNotDecide) {
    // A wedge of 20 degrees along z, its edge at the origin, its body towards -x: beside the edge, a point in front is
    // behind the plane of one face.
    const double slope = std::tan(10 * degree);
    const TriangleMesh wedge =
        soup({{0, 0, 0}, {0, 0, 1}, {-1, slope, 0}, {-1, slope, 1}, {-1, -slope, 0}, {-1, -slope, 1}},
             {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4}, {2, 4, 3}, {3, 4, 5}, {0, 4, 2}, {1, 3, 5}});
    ASSERT_GT(signed_volume(wedge), 0);
    for (const double y : {-0.3, -0.05, 0.0, 0.05, 0.3})
        EXPECT_NEAR(deviation_at({0.1, y, 0.5}, wedge), std::hypot(0.1, y), 1e-12) << y;
    EXPECT_LT(deviation_at({-0.5, 0, 0.5}, wedge), 0);
}

TEST(InspectSign, ApexOfAPyramid_IsDecidedByItsVertexNormal) {
    // A thin pyramid whose apex is at the origin: in front of it all is outside.
    const TriangleMesh spike = soup({{0, 0, 0}, {0.1, 0, -1}, {0, 0.1, -1}, {-0.1, 0, -1}, {0, -0.1, -1}},
                                    {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 3, 2}, {1, 4, 3}});
    ASSERT_GT(signed_volume(spike), 0);
    for (const Vec3& p : {Vec3(0, 0, 0.5), Vec3(0.3, 0.02, 0.2), Vec3(-0.3, -0.2, 0.1), Vec3(0.01, -0.4, 0.1)})
        EXPECT_NEAR(deviation_at(p, spike), p.norm(), 1e-12);
}

TEST(InspectSign, OnTheSurface_IsZeroAndCounted) {
    for (const Vec3& p : {Vec3(0.5, 0.25, 1), Vec3(1, 0.5, 1), Vec3(1, 1, 1), Vec3(0.3, 0, 0)})
        EXPECT_EQ(deviation_at(p, cube()), 0);
}

TEST(InspectSign, OnTheSurfaceFarFromTheOrigin_IsZero) {
    const TriangleMesh far = turned(shifted(cube(), {1e5, 3e4, -2e5}), 0.7, {1, 2, 3});
    const auto& [a, b, c] = far.triangles[3];
    const Vec3 middle = (far.positions[a] + far.positions[b] + far.positions[c]) / 3;
    EXPECT_NEAR(deviation_at(middle, far), 0, 1e-10);
    EXPECT_EQ(deviation_at(far.positions[a], far), 0);
}

TEST(InspectSign, RandomPoints_AgreeWithAllTrianglesAndWindingNumbers) {
    expect_as_by_all_triangles(cube(), 500, 0.2);
    expect_as_by_all_triangles(l_block(), 500, 0.2);
    expect_as_by_all_triangles(torus(2, 0.7, 17, 11), 400, 0.1);
    expect_as_by_all_triangles(icosahedron(), 300, 0.2);
    // Two separate bodies, and a thin wall.
    expect_as_by_all_triangles(both(cube(), shifted(icosahedron(), {4, 0, 0})), 300, 0.1);
    expect_as_by_all_triangles(box({3, 2, 0.01}), 300, 0.01);
}

TEST(InspectSign, RepeatedVertices_ChangeNothing) {
    const Array<Vec3> points = random_points(500, {0, 0, 0}, {2, 2, 1}, 0.5, 3);
    const Inspection joined = inspected(cloud(points), l_block()),
                     apart = inspected(cloud(points), separate(l_block()));
    EXPECT_EQ(apart.beyond_border, 0u);
    EXPECT_EQ(joined.deviations, apart.deviations);
}

TEST(InspectSign, TrianglesWithoutArea_ChangeNothing) {
    // A needle on an edge of the cube, and triangles that repeat a vertex, in the first rows, which win ties.
    TriangleMesh mesh = cube();
    Array<Triangle> triangles{{0, 0, 1}, {2, 2, 2}};
    triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    mesh.triangles = std::move(triangles);
    const Array<Vec3> points = random_points(500, {0, 0, 0}, {1, 1, 1}, 0.5, 4);
    EXPECT_EQ(inspected(cloud(points), mesh).deviations, inspected(cloud(points), cube()).deviations);
}

TEST(InspectSign, FoldedSheet_IsUndecidedBesideTheFold) {
    // Two triangles over each other, back to back, with a common edge on the y axis.
    const TriangleMesh folded = soup({{0, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}, {-1, 0.5, 0}}, {{0, 1, 2}, {1, 0, 3}});
    const Inspection found = inspected(cloud({{0.5, 0.5, 0.2}, {-0.3, 0.5, 0.2}, {-0.3, 0.5, 0}}), folded);
    EXPECT_TRUE(std::isnan(found.deviations[0]));
    EXPECT_EQ(found.undecided, 1u);
    EXPECT_EQ(found.deviations[2], 0) << "on the surface";
}

TEST(InspectSign, MisorientedEdge_IsUndecidedUnlessAllAgree) {
    // The halves of a flat square face up and down.
    const TriangleMesh torn = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 3, 2}});
    const Inspection found = inspected(cloud({{0.5, 0.5, 0.1}, {0.75, 0.25, 0.1}, {0.25, 0.75, 0.1}}), torn);
    EXPECT_TRUE(std::isnan(found.deviations[0])) << "above the diagonal";
    EXPECT_DOUBLE_EQ(found.deviations[1], 0.1);
    EXPECT_DOUBLE_EQ(found.deviations[2], -0.1);
    EXPECT_EQ(found.undecided, 1u);
    EXPECT_EQ(found.beyond_border, 0u);
}

TEST(InspectSign, EdgeOfThreeTriangles_IsDecidedWhereAllAgree) {
    // A floor facing up, with a wall below its middle line x = 1.
    const TriangleMesh tee = soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 2, 0}, {2, 2, 0}, {1, 1, -1}},
                                  {{0, 1, 3}, {1, 4, 3}, {1, 2, 4}, {2, 5, 4}, {1, 4, 6}});
    const Inspection found = inspected(cloud({{1, 1, 0.5}, {0.5, 0.5, 0.5}}), tee);
    EXPECT_DOUBLE_EQ(found.deviations[0], 0.5);
    EXPECT_DOUBLE_EQ(found.deviations[1], 0.5);
    // Three sheets at 120 degrees around the z axis: the nearest point is never on the axis alone.
    const TriangleMesh star =
        soup({{0, 0, 0}, {0, 0, 2}, {1, 0, 1}, {-0.5, 0.8, 1}, {-0.5, -0.8, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
    const Inspection at_star = inspected(cloud({{1e-3, 1e-3, 1}, {0.5, 0.01, 1}}), star);
    EXPECT_DOUBLE_EQ(at_star.deviations[0], 1e-3);
    EXPECT_DOUBLE_EQ(at_star.deviations[1], 0.01);
}

TEST(InspectSign, NominalInBothOrientations_IsDoubtful) {
    const TriangleMesh twice = both(cube(), inside_out(cube()));
    Context context;
    InspectParams params;
    params.tolerance = {Length(-1), Length(1)};
    inspect(cloud({{0.5, 0.5, 1.1}, {0.2, 0.3, 1.2}}), twice, nullptr, params, context);
    EXPECT_THAT(doubts_of(context), testing::Contains(testing::HasSubstr("12 triangles are in both orientations")));
}

TEST(InspectSign, InsideOutNominal_ReversesTheSigns) {
    const Array<Vec3> points = random_points(200, {0, 0, 0}, {1, 1, 1}, 0.5, 5);
    const Inspection right = inspected(cloud(points), cube()), wrong = inspected(cloud(points), inside_out(cube()));
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(right.deviations[i], -wrong.deviations[i]);
}

TEST(InspectBorder, PointsBesideAnOpenSheet_AreLeftOut) {
    const TriangleMesh nominal = rectangle(2, 1);
    const Inspection found = inspected(cloud({{1, 0.5, 0.1},  // above
                                              {0.5, 0, 0.1},  // above the border
                                              {0, 0, -0.2},  // below a corner
                                              {2.5, 0.5, 0.1},  // beyond an edge
                                              {-0.1, -0.1, 0.1},  // beyond a corner
                                              {2.1, 1, 0}}),  // beyond a corner, along one edge, in the plane
                                       nominal);
    EXPECT_EQ(found.beyond_border, 3u);
    EXPECT_EQ(found.undecided, 0u);
    EXPECT_EQ(found.numbers.counted, 3u);
    EXPECT_DOUBLE_EQ(found.deviations[0], 0.1);
    EXPECT_DOUBLE_EQ(found.deviations[1], 0.1);
    EXPECT_DOUBLE_EQ(found.deviations[2], -0.2);
    for (std::size_t i = 3; i < 6; ++i) EXPECT_TRUE(std::isnan(found.deviations[i])) << i;
}

TEST(InspectBorder, Included_PointsCountWithTheSignOfTheirSide) {
    InspectParams params = params_with();
    params.borders = InspectParams::Borders::include;
    const Inspection found =
        inspected(cloud({{2.3, 0.5, 0.4}, {2.3, 0.5, -0.4}, {2.3, 0.5, 0}, {1, 0.5, 0}}), rectangle(2, 1), params);
    EXPECT_DOUBLE_EQ(found.deviations[0], 0.5);
    EXPECT_DOUBLE_EQ(found.deviations[1], -0.5);
    EXPECT_EQ(found.undecided, 1u) << "in the plane of the sheet there is no side";
    EXPECT_EQ(found.beyond_border, 0u);
    EXPECT_EQ(found.numbers.counted, 3u);
}

TEST(InspectBorder, RidgeThatEndsAtTheBorder_CountsThePointsAboveItsEnd) {
    // A roof over y in [0, 1], its ridge x = 0, z = 0.
    const TriangleMesh roof = soup({{0, 0, 0}, {0, 1, 0}, {1, 0, -1}, {1, 1, -1}, {-1, 0, -1}, {-1, 1, -1}},
                                   {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}});
    EXPECT_NEAR(deviation_at({0, 0, 0.3}, roof), 0.3, 1e-12);
    EXPECT_NEAR(deviation_at({0.1, 0, 0.3}, roof), std::hypot(0.1, 0.3), 1e-12);
    EXPECT_TRUE(std::isnan(deviation_at({0, -0.1, 0.3}, roof)));
}

TEST(InspectBorder, SingleTriangle_Works) {
    const TriangleMesh triangle = soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    EXPECT_DOUBLE_EQ(deviation_at({0.2, 0.2, 0.5}, triangle), 0.5);
    EXPECT_DOUBLE_EQ(deviation_at({0.2, 0.2, -0.5}, triangle), -0.5);
    EXPECT_TRUE(std::isnan(deviation_at({1, 1, 0.5}, triangle)));
}

TEST(InspectSign, RealModels_AgreeWithAllTrianglesAndWindingNumbers) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/fandisk_large.off");
    expect_as_by_all_triangles(*read_mesh(path), 100, 0.05);
}

TEST(InspectSign, RealModelOfSlimTriangles_AgreesWithAllTrianglesAndWindingNumbers) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/anchor_dense.off");
    expect_as_by_all_triangles(*read_mesh(path), 40, 0.05);
}

}  // namespace
}  // namespace scanmill::test
