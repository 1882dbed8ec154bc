// SPDX-License-Identifier: GPL-3.0-or-later
/// The side of the scanner, found in the points of a view.
#include "register/scanner_side.hpp"

#include <gmock/gmock.h>

#include "filters/register/cases.hpp"
#include "register/registered_clouds.hpp"

namespace scanmill::test {
namespace {

using registration::scanner_side;
using testing::IsEmpty;

/// A view of half a sphere of radius 10, from this direction. The rim is missing, as a scanner does not see it.
std::vector<Vec3> half_sphere(const Vec3& from, bool is_inside = false) {
    Random random(3);
    std::vector<Vec3> points;
    while (points.size() < 4000) {
        const Vec3 d = Vec3(random.normal(), random.normal(), random.normal()).normalized();
        if (d.dot(from) > 0.3) points.push_back((is_inside ? -10 : 10) * d);
    }
    return points;
}

TEST(ScannerSide, HalfASphere_WasScannedFromItsOutside) {
    for (const Vec3& from : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, -3, 1), Vec3(3, 1, -1)})
        EXPECT_GT(scanner_side(half_sphere(from.normalized())).dot(from.normalized()), 0.9) << from.transpose();
}

TEST(ScannerSide, PlusZ_StaysUnlessItIsSeenEdgeOn) {
    EXPECT_EQ(scanner_side(half_sphere(Vec3(0, 0, 1))), Vec3(0, 0, 1));
    EXPECT_EQ(scanner_side(half_sphere(Vec3(1, 0, 5).normalized())), Vec3(0, 0, 1)) << "the whole surface is seen";
    EXPECT_EQ(scanner_side(half_sphere(Vec3(0, 0, -1))), Vec3(0, 0, -1)) << "a bowl, seen from below";
}

TEST(ScannerSide, FewPointsAndPlanes_KeepPlusZ) {
    EXPECT_EQ(scanner_side({}), Vec3(0, 0, 1));
    EXPECT_EQ(scanner_side(std::vector<Vec3>(100, Vec3(1, 2, 3))), Vec3(0, 0, 1));
    EXPECT_EQ(scanner_side(height_view("plane", 0, 40, 0, 40, [](double, double) { return 0; }).points), Vec3(0, 0, 1));
}

/// Views in one frame as other programs export them: without any direction.
TEST(ScannerSide, ViewsInOneFrameWithoutDirections_StayAsTheyAre) {
    std::vector<std::shared_ptr<const PointCloud>> clouds;
    for (const View& view : views_of(lump(), 8)) {
        PointCloud cloud;
        cloud.frame.name = view.name;
        Array<Vec3> positions;
        for (const Vec3& p : view.points) positions.push_back(view.truth.apply(p));
        cloud.positions = std::move(positions);
        clouds.push_back(std::make_shared<const PointCloud>(std::move(cloud)));
    }
    RegisterParams params;
    params.as_is = true;
    Context context;
    const Transforms transforms = registered_clouds(clouds, params, context);
    EXPECT_EQ(transforms.motions.size(), clouds.size());
    for (const RigidTransform& pose : transforms.motions) {
        EXPECT_EQ(pose.translation, Vec3::Zero());
        EXPECT_EQ(pose.rotation, Eigen::Matrix3d::Identity());
    }
    EXPECT_THAT(context.doubts(), IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
