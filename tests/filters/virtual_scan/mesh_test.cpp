// SPDX-License-Identifier: GPL-3.0-or-later
/// Meshes scanned through the z-buffer: points lie on the surface, hidden parts are missing, and no ray passes between
/// triangles.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "virtual_scan/virtual_scan.hpp"

namespace scanmill::test {
namespace {

VirtualScanParams rays_every(double resolution, std::vector<double> views) {
    VirtualScanParams params;
    params.resolution = resolution;
    params.views = std::move(views);
    params.max_angle = Angle::degrees(90);
    return params;
}

VirtualScanResult scan_of(const TriangleMesh& mesh, const VirtualScanParams& params, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return virtual_scan(&mesh, params, context);
}

TriangleMesh mesh_of(std::initializer_list<Vec3> positions, std::initializer_list<Triangle> triangles) {
    TriangleMesh mesh;
    mesh.positions = positions;
    mesh.triangles = triangles;
    return mesh;
}

std::vector<double> normals_of(const VirtualScanResult& result) {
    const auto values = result.points.columns.find("normal")->values<double>();
    return {values.begin(), values.end()};
}

/// The test of Möller and Trumbore, independent of the z-buffer: the depth at which a line meets the inside of the
/// triangle, `slack` away from its edges.
std::optional<double> meets(const TriangleMesh& mesh, const Triangle& t, const Vec3& start, const Vec3& direction) {
    const Vec3& a = mesh.positions[t[0]];
    const Vec3 ab = mesh.positions[t[1]] - a, ac = mesh.positions[t[2]] - a;
    const Vec3 p = direction.cross(ac);
    const double determinant = ab.dot(p);
    if (std::abs(determinant) < 1e-14) return {};
    const Vec3 offset = start - a, q = offset.cross(ab);
    const double u = offset.dot(p) / determinant, v = direction.dot(q) / determinant;
    const double slack = 1e-9;
    if (u < slack || v < slack || u + v > 1 - slack) return {};
    return ac.dot(q) / determinant;
}

TEST(VirtualScanMesh, FlatTriangle_GivesItsPixelsByHand) {
    // Seen from above, rays at ±0.5, ±1.5 about the box's centre (2, 2): x, y ∈ {0.5, 1.5, 2.5, 3.5}, x + y ≤ 4.
    const TriangleMesh mesh = mesh_of({{0, 0, 3}, {4, 0, 3}, {0, 4, 3}}, {{0, 1, 2}});
    const VirtualScanResult result = scan_of(mesh, rays_every(1, {0, 0, 1}));
    std::vector<std::pair<double, double>> seen;
    for (const Vec3& p : result.points.positions) {
        EXPECT_NEAR(p.z(), 3, 1e-15);
        seen.emplace_back(std::min(p.x(), p.y()), std::max(p.x(), p.y()));
    }
    std::ranges::sort(seen);
    EXPECT_THAT(
        seen, ::testing::ElementsAre(std::pair(0.5, 0.5), std::pair(0.5, 1.5), std::pair(0.5, 1.5), std::pair(0.5, 2.5),
                                     std::pair(0.5, 2.5), std::pair(0.5, 3.5), std::pair(0.5, 3.5), std::pair(1.5, 1.5),
                                     std::pair(1.5, 2.5), std::pair(1.5, 2.5)));
}

TEST(VirtualScanMesh, OpenMesh_IsSeenFromBothSidesWithItsNormalTurned) {
    const TriangleMesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    for (const double side : {1.0, -1.0}) {
        const VirtualScanResult result = scan_of(mesh, rays_every(0.1, {0, 0, side}));
        const auto normals = normals_of(result);
        ASSERT_GT(result.points.size(), 40u);
        for (std::size_t i = 0; i < result.points.size(); ++i) EXPECT_EQ(normals[3 * i + 2], side);
    }
}

TEST(VirtualScanMesh, TwoParallelPlates_OnlyTheNearerIsSeen) {
    const TriangleMesh mesh =
        mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}, {3, 5, 4}});
    for (const Vec3& p : scan_of(mesh, rays_every(0.05, {0, 0, 1})).points.positions) ASSERT_EQ(p.z(), 1);
    for (const Vec3& p : scan_of(mesh, rays_every(0.05, {0, 0, -1})).points.positions) ASSERT_EQ(p.z(), 0);
}

/// Square plates over [0, 2]² that cross at x = 1/2: z = x, and z = 1 − x.
TriangleMesh crossing_plates(bool rising_first) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 2}, {2, 2, 2}, {0, 2, 0}, {0, 0, 1}, {2, 0, -1}, {2, 2, -1}, {0, 2, 1}};
    if (rising_first)
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    else
        mesh.triangles = {{4, 5, 6}, {4, 6, 7}, {0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TEST(VirtualScanMesh, CrossingPlates_TheNearerIsSeenOnEitherSide) {
    const VirtualScanResult result = scan_of(crossing_plates(true), rays_every(0.04, {0, 0, 1}));
    ASSERT_EQ(result.points.size(), 2500u);
    for (const Vec3& p : result.points.positions) ASSERT_NEAR(p.z(), std::max(p.x(), 1 - p.x()), 1e-12);
}

TEST(VirtualScanMesh, RayThroughACrossing_MeetsTheLowerRow) {
    // Rays at x = 1/2, where both plates are equally near, and at 3/2.
    for (const bool rising_first : {true, false}) {
        const VirtualScanResult result = scan_of(crossing_plates(rising_first), rays_every(1, {0, 0, 1}));
        const auto normals = normals_of(result);
        ASSERT_EQ(result.points.size(), 4u);
        for (std::size_t i = 0; i < 4; ++i) {
            const bool rising = rising_first || result.points.positions[i].x() > 1;
            EXPECT_NEAR(normals[3 * i], rising ? -std::sqrt(0.5) : std::sqrt(0.5), 1e-15) << i;
        }
    }
}

TEST(VirtualScanMesh, GeodesicSphere_PointsLieWithinTheSagitta) {
    const TriangleMesh mesh = geodesic_sphere(2, 12);
    double longest = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        longest = std::max(longest, (mesh.positions[a] - mesh.positions[b]).norm());
    const double circumradius = longest / std::numbers::sqrt3 * 1.1;
    const double inner = std::sqrt(4 - circumradius * circumradius);
    const VirtualScanResult result = scan_of(mesh, rays_every(0.05, {20}));
    ASSERT_GT(result.points.size(), 50000u);
    for (const Vec3& p : result.points.positions) {
        ASSERT_LE(p.norm(), 2 + 1e-12);
        ASSERT_GE(p.norm(), inner);
    }
}

TEST(VirtualScanMesh, ClosedConvexMesh_NoRayPassesBetweenTriangles) {
    // Rays through vertices and along edges: a cube cut into many triangles, seen straight on, pixels on its lattice.
    const TriangleMesh mesh = cube(4);
    const VirtualScanResult result = scan_of(mesh, rays_every(0.25, {0, 0, 1, 1, 0, 0, 0, -1, 0}));
    EXPECT_EQ(result.points.size(), 3u * 16 * 16);
    // The geodesic sphere's silhouette has no holes: every row of pixels is one run.
    const VirtualScanResult sphere = scan_of(geodesic_sphere(1, 8), rays_every(0.01, {3, 1, 2}));
    const Vec3 d = sphere.directions[0];
    const Vec3 right = Vec3::UnitZ().cross(d).normalized(), up = d.cross(right);
    double row = -2, last = 0;
    for (const Vec3& p : sphere.points.positions) {
        if (std::abs(p.dot(up) - row) < 1e-6) {
            ASSERT_NEAR(p.dot(right) - last, 0.01, 1e-9);
        }
        row = p.dot(up);
        last = p.dot(right);
    }
}

/// Every point is where its own ray first meets some triangle, by an independent test.
TEST(VirtualScanMesh, LBlockObliquely_EveryPointIsTheFirstOnItsRay) {
    const TriangleMesh mesh = l_block();
    const VirtualScanResult result = scan_of(mesh, rays_every(0.03, {3, 2, 1, -1, 4, 2, 2, -3, -1}));
    const auto views = result.points.columns.find("view")->values<std::int32_t>();
    std::size_t confirmed = 0;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Vec3& p = result.points.positions[i];
        const Vec3& towards = result.directions[static_cast<std::size_t>(views[i])];
        for (const Triangle& t : mesh.triangles)
            if (const auto depth = meets(mesh, t, p, towards)) {
                ASSERT_LT(*depth, 1e-9) << "something lies between point " << i << " and the sensor";
                confirmed += *depth > -1e-9;
            }
    }
    EXPECT_GT(confirmed, result.points.size() * 9 / 10) << "points lie on triangles";
}

TEST(VirtualScanMesh, LBlock_AgreesWithTheSameShapeByFormula) {
    VirtualScanParams params = rays_every(0.0237, {3, 2, 1, -1, 4, 2, 0, 0, -1});
    const VirtualScanResult by_mesh = scan_of(l_block(), params);
    params.shape = VirtualScanParams::Shape::l_block;
    Context context;
    const VirtualScanResult by_formula = virtual_scan(nullptr, params, context);
    // The formula's grid covers its box, the mesh's its silhouette, but both count from the same centre.
    ASSERT_EQ(by_mesh.points.size(), by_formula.points.size());
    for (std::size_t i = 0; i < by_mesh.points.size(); ++i)
        ASSERT_LT((by_mesh.points.positions[i] - by_formula.points.positions[i]).norm(), 1e-12);
}

TEST(VirtualScanMesh, FrameAndUnit_AreThoseOfTheMesh) {
    TriangleMesh mesh = cube();
    mesh.frame = {LengthUnit::millimetre, Vec3(1000, 0, 0), "part"};
    VirtualScanParams params = rays_every(0.1, {6});
    params.resolution = Length(0.1, Length::In::millimetre);
    EXPECT_EQ(scan_of(mesh, params).points.frame, mesh.frame);
    params.resolution = Length(0.01, Length::In::centimetre);
    EXPECT_DOUBLE_EQ(scan_of(mesh, params).resolution, 0.1);
    params.resolution = Length::percent_of_diagonal(10);
    EXPECT_NEAR(scan_of(mesh, params).resolution, std::sqrt(3) / 10, 1e-15);
    params.resolution = Length::spacings(0.5);
    EXPECT_NEAR(scan_of(mesh, params).resolution, 0.5, 1e-15) << "the cube's median edge is 1";
}

TEST(VirtualScanMesh, UnusedDistantVertex_DoesNotWidenTheScan) {
    TriangleMesh mesh = cube();
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    positions.push_back({1e6, 0, 0});
    mesh.positions = std::move(positions);
    EXPECT_EQ(scan_of(mesh, rays_every(0.1, {0, 0, 1})).rays, scan_of(cube(), rays_every(0.1, {0, 0, 1})).rays);
}

TEST(VirtualScanMesh, RealMesh_FromTwelveViewsShowsThatMuchOfIt) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/knot1.off");
    const auto mesh = read_mesh(path);
    VirtualScanParams params;
    params.noise = Length::percent_of_diagonal(0);
    const VirtualScanResult one = scan_of(*mesh, params, 1), two = scan_of(*mesh, params, 2);
    ASSERT_GT(one.points.size(), 20000u);
    EXPECT_TRUE(std::ranges::equal(one.points.positions, two.points.positions));
    EXPECT_TRUE(one.points.columns == two.points.columns);
    EXPECT_EQ(one.directions.size(), 12u);
    const BoundingBox box = bounding_box(mesh->positions.span()), seen = bounding_box(one.points.positions.span());
    EXPECT_LT((box.low - seen.low).cwiseAbs().maxCoeff(), 3 * one.resolution);
    EXPECT_LT((box.high - seen.high).cwiseAbs().maxCoeff(), 3 * one.resolution);
    // Each point lies on a triangle's plane, between its corners, for every thousandth point.
    const auto normals = normals_of(one);
    for (std::size_t i = 0; i < one.points.size(); i += 997) {
        const Vec3 normal(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
        double least = 1e9;
        for (const Triangle& t : mesh->triangles)
            if (const auto depth = meets(*mesh, t, one.points.positions[i], normal))
                least = std::min(least, std::abs(*depth));
        EXPECT_LT(least, 1e-9 * box.diagonal()) << i;
    }
}

}  // namespace
}  // namespace scanmill::test
