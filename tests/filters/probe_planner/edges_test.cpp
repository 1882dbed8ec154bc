// SPDX-License-Identifier: GPL-3.0-or-later
/// Edges that a scan blunts: the lines zigzag over triangles that lead from one face to the other.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "filters/probe_planner/cases.hpp"
#include "probe_planner/edge_fit.hpp"
#include "region_grow/region_grow.hpp"
#include "virtual_scan/virtual_scan.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::test {
namespace {

using probing::edge_faces;
using probing::EdgeFaces;

/// A convex edge of 90 degrees along y between the planes z = 0 (x < 0) and x = 0 (z < 0), rows a unit apart. The last
/// row of every face ends at a distance from the edge: of row i of the top first(i), of the other face second(i).
template <class First, class Second>
TriangleMesh blunted(int rows, First&& first, Second&& second) {
    constexpr int columns = 6;
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < 2 * columns; ++j) {
            const int from_edge = j < columns ? columns - 1 - j : j - columns;
            const double distance = from_edge + (j < columns ? first(i) : second(i));
            positions.push_back(j < columns ? Vec3(-distance, i, 0) : Vec3(0, i, -distance));
        }
    const auto at = [](int i, int j) { return static_cast<u32>(i * 2 * columns + j); };
    for (int i = 0; i + 1 < rows; ++i)
        for (int j = 0; j + 1 < 2 * columns; ++j) {
            triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
            triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
        }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

std::optional<EdgeFaces> faces_at(const TriangleMesh& mesh, const EdgeFaces& guess, double radius = 3) {
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    return edge_faces(tree, guess, radius, 1.5);
}

const EdgeFaces zigzag{Vec3(-0.4, 10.3, -0.2), Vec3(1, 1, 0).normalized(), Vec3(1, -1, 2).normalized(),
                       Vec3(2, -2, 1).normalized()};

TEST(EdgeFaces, OfABluntedEdge_AreThoseOfTheTrueOne) {
    const TriangleMesh mesh = blunted(
        21, [](int i) { return 0.1 + 0.2 * (i % 5); }, [](int i) { return 0.9 - 0.3 * (i % 3); });
    const auto faces = faces_at(mesh, zigzag);
    ASSERT_TRUE(faces);
    EXPECT_NEAR(faces->position.x(), 0, 1e-12);
    EXPECT_NEAR(faces->position.z(), 0, 1e-12);
    EXPECT_NEAR(faces->position.y(), 10.3, 1e-12);
    EXPECT_LT((faces->tangent - Vec3::UnitY()).norm(), 1e-12);
    // Seen from outside, the plane z = 0 is on the left of +y.
    EXPECT_LT((faces->left_normal - Vec3::UnitZ()).norm(), 1e-12);
    EXPECT_LT((faces->right_normal - Vec3::UnitX()).norm(), 1e-12);

    EdgeFaces opposite = zigzag;
    opposite.tangent = -zigzag.tangent;
    const auto turned = faces_at(mesh, opposite);
    ASSERT_TRUE(turned);
    EXPECT_LT((turned->tangent + Vec3::UnitY()).norm(), 1e-12);
    EXPECT_LT((turned->left_normal - Vec3::UnitX()).norm(), 1e-12);
    EXPECT_LT((turned->right_normal - Vec3::UnitZ()).norm(), 1e-12);
}

TEST(EdgeFaces, WhereTheGuessExplainsTheMesh_StayAsTheyAre) {
    const TriangleMesh mesh = blunted(
        21, [](int) { return 1e-9; }, [](int) { return 1; });
    EXPECT_FALSE(faces_at(mesh, {Vec3(0, 10.3, 0), Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitX()}));
}

TEST(EdgeFaces, AChamfer_IsAFaceOfItsOwn) {
    const TriangleMesh mesh = blunted(
        21, [](int) { return 0.5; }, [](int) { return 0.5; });
    EXPECT_FALSE(faces_at(mesh, {Vec3(-0.5, 10.3, 0), Vec3::UnitY(), Vec3::UnitZ(), Vec3(1, 0, 1).normalized()}, 4));
}

TEST(EdgeFaces, OnAPlane_AreOneFace) {
    const TriangleMesh mesh = mapped(blunted(
                                         21, [](int) { return 0.4; }, [](int) { return 0.6; }),
                                     [](const Vec3& p) { return Vec3(p.x() - p.z(), p.y(), 0); });
    const auto faces =
        faces_at(mesh, {Vec3(0, 10.3, 0), Vec3::UnitY(), Vec3(-1, 0, 1).normalized(), Vec3(1, 0, 1).normalized()});
    EXPECT_FALSE(faces) << "all normals are equal, so no two planes are found";
}

TEST(EdgeFaces, OfAConcaveEdge_AreOnTheirSides) {
    const TriangleMesh mesh =
        mapped(blunted(
                   21, [](int i) { return 0.1 + 0.2 * (i % 5); }, [](int i) { return 0.9 - 0.3 * (i % 3); }),
               [](const Vec3& p) { return Vec3(p.x(), p.y(), -p.z()); });
    // The faces z = 0 and x = 0 of a step upwards: normals +z and -x.
    const auto faces = faces_at(mesh, {Vec3(-0.4, 10.3, 0.2), Vec3(1, 1, 0).normalized(), Vec3(-1, -1, 2).normalized(),
                                       Vec3(-2, -1, 1).normalized()});
    ASSERT_TRUE(faces);
    EXPECT_LT((faces->tangent - Vec3::UnitY()).norm(), 1e-12);
    EXPECT_LT((faces->left_normal - Vec3::UnitZ()).norm(), 1e-12);
    EXPECT_LT((faces->right_normal + Vec3::UnitX()).norm(), 1e-12);
    EXPECT_LT(faces->tangent.dot(faces->left_normal.cross(faces->right_normal)), 0) << "concave";
}

/// Two cones of radius 20 and height 20 with a common base, from all sides, thinned.
const RegionGrowResult& scanned_bicone() {
    static const RegionGrowResult result = [] {
        VirtualScanParams scan;
        scan.shape = VirtualScanParams::Shape::bicone;
        scan.size = {20., 20.};
        scan.views = {-1, -1, -1, -1, -1, 1, -1, 1, -1, -1, 1, 1, 1, -1, -1, 1, -1, 1, 1, 1, -1, 1, 1, 1};
        scan.resolution = 0.1;
        Context context;
        VoxelThinParams thinning;
        thinning.bin_size = Length(0.4);
        const PointCloud points = virtual_scan(nullptr, scan, context).points;
        return region_grow(voxel_thin(points, thinning, context).points, {}, context);
    }();
    return result;
}

TEST(ProbePlannerEdges, TheRimOfAScannedDoubleCone_IsTouchedAlongTheBisectors) {
    const RegionGrowResult& surface = scanned_bicone();
    ProbePlannerParams params = probe_of(1, 0.3, 2);  // 0.4 voxels and 1.5 times the distance of scan points
    params.max_tilt = Angle::degrees(180);
    const Planned result = planned(surface.features, surface.mesh, params);
    std::size_t at_rim = 0, sound = 0;
    for (const ProbeTouch& touch : result.plan.touches) {
        const Vec3 p = touch.position + result.plan.frame.origin;
        if (std::abs(p.z()) > 1) continue;  // a tip
        ++at_rim;
        EXPECT_LT(touch.interior_angle, pi) << "no edge of a double cone is concave";
        if (std::abs(touch.interior_angle / degree - 90) > 1) continue;
        ++sound;
        EXPECT_LT(std::hypot(std::hypot(p.x(), p.y()) - 20, p.z()), 0.02) << p.transpose();
        EXPECT_LT(std::abs(touch.tangent.dot(Vec3(p.x(), p.y(), 0).normalized())), 0.02);
        EXPECT_EQ(touch.reason, ProbeReason::none);
        EXPECT_EQ(touch.contact, ProbeContact::edge);
    }
    // 63 at a spacing of 2; short creases are not touched twice.
    EXPECT_GT(at_rim, 55u);
    EXPECT_LT(at_rim, 72u);
    EXPECT_EQ(sound, at_rim);
}

}  // namespace
}  // namespace scanmill::test
