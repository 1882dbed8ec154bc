// SPDX-License-Identifier: GPL-3.0-or-later
/// icp on real parts and raw views.
#include <gmock/gmock.h>

#include "filters/icp/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/formats/poses/poses.hpp"
#include "scanmill/kinds/kind_traits.hpp"
#include "support/known_models.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

class IcpReal : public testing::TestWithParam<const char*> {};

TEST_P(IcpReal, AScanTwoDegreesAndTwoPercentAway_ComesBackToMicrometres) {
    const auto found_path = found(Model{GetParam(), 0});
    if (!found_path) GTEST_SKIP() << missing_data(GetParam());
    TriangleMesh mesh = *read_file(*found_path, {}).value.get<TriangleMesh>();
    mesh = scaled(mesh, 100 / surface_box(mesh).diagonal());  // as if 100 mm long
    const BoundingBox box = surface_box(mesh);
    const Vec3 centre = (box.low + box.high) / 2;
    Random random(1);
    for (const auto& [degrees, shift] : {std::pair(0.5, 1.0), std::pair(2.0, 2.0)}) {
        Scan scan = scan_of(mesh, 20000, 0.02, random);
        const Vec3 dent = scan.points[0], pad = scan.points[1];
        double depth = 0;
        std::vector<std::size_t> dented;
        for (std::size_t i = 0; i < scan.points.size(); ++i) {
            if ((scan.points[i] - dent).norm() < 8) {
                scan.points[i] -= 0.4 * scan.normals[i];
                dented.push_back(i);
            } else if ((scan.points[i] - pad).norm() < 8) {
                scan.points[i] += 0.2 * scan.normals[i];
            }
        }
        const RigidTransform motion = random_motion_about(centre, degrees, shift, random);
        const Refined result = refined(cloud(moved(scan.points, motion)), mesh);
        const RigidTransform error = composed(result.transform, motion);
        for (const std::size_t i : dented) depth += (error.apply(scan.points[i]) - scan.points[i]).dot(scan.normals[i]);
        EXPECT_LT(std::abs(depth / static_cast<double>(dented.size())), 0.003);
        EXPECT_LT(largest_motion(error, scan.points), 0.006);
        EXPECT_THAT(result.doubts, testing::IsEmpty());
    }
}
INSTANTIATE_TEST_SUITE_P(Models, IcpReal,
                         testing::Values("3-mechanical/fandisk_large.off", "3-mechanical/anchor_dense.off",
                                         "1-bunny/bun_zipper.ply", "meshes/couplingdown.off", "meshes/joint.off"));

TEST(IcpRealViews, TwoRawViewsMovedApart_MeetAgain) {
    // The published poses are not exact: beside them and from them, the same relative pose must be found.
    SCANMILL_REAL_SCAN(conf, shared_data, "1-bunny/raw/bun.conf");
    SCANMILL_REAL_SCAN(first, shared_data, "1-bunny/raw/bun000.ply");
    SCANMILL_REAL_SCAN(second, shared_data, "1-bunny/raw/bun045.ply");
    const auto poses = read_poses(conf, [](const std::string&) {});
    const auto placed_view = [&](const std::filesystem::path& path) {
        const auto pose =
            std::ranges::find_if(poses, [&](const ScanPose& p) { return is_of(p, path.filename().string()); });
        const Value value = read_file(path, {}).value;
        const auto view = value.find<TriangleMesh>() ? points_of(*value.get<TriangleMesh>()) : *value.get<PointCloud>();
        PointCloud at_pose = *placed(Value(std::make_shared<PointCloud>(view)), pose->transform).get<PointCloud>();
        at_pose.positions = translated(at_pose.positions, at_pose.frame.origin);
        at_pose.frame.origin.setZero();
        return at_pose;
    };
    const PointCloud target = placed_view(first), source = placed_view(second);
    const Refined from_published = refined(source, target);
    EXPECT_THAT(from_published.doubts, testing::IsEmpty());
    EXPECT_GT(from_published.overlap, 0.3);
    const std::vector<Vec3> points(source.positions.begin(), source.positions.end());
    const double diagonal = bounding_box(source.positions.span()).diagonal();
    EXPECT_LT(largest_motion(from_published.transform, points), 0.01 * diagonal);
    Random random(2);
    for (int trial = 0; trial < 3; ++trial) {
        const RigidTransform motion = random_motion_about(points[0], 1, 0.01 * diagonal, random);
        PointCloud away = source;
        const std::vector<Vec3> apart = moved(points, motion);
        away.positions = Array<Vec3>(apart.begin(), apart.end());
        const Refined result = refined(away, target);
        EXPECT_LT(largest_distance(moved(apart, result.transform), moved(points, from_published.transform)),
                  1e-4 * diagonal);
    }
}

}  // namespace
}  // namespace scanmill::test
