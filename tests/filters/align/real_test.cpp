// SPDX-License-Identifier: GPL-3.0-or-later
/// Registration of scanned points: a raw view and its pose, and planes in models that are not plates.
#include <gmock/gmock.h>

#include "apply_transform/apply_transform.hpp"
#include "filters/align/cases.hpp"
#include "plate_corners/plate_corners.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/formats/poses/poses.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

std::shared_ptr<const PointCloud> points_at(const std::filesystem::path& path) {
    const Value value = read_file(path, {}).value;
    if (const TriangleMesh* mesh = value.find<TriangleMesh>()) return std::make_shared<PointCloud>(points_of(*mesh));
    return value.get<PointCloud>();
}

TEST(AlignReal, ARawViewAndTheSameMovedByItsPose_GiveThePose) {
    SCANMILL_REAL_SCAN(conf, shared_data, "1-bunny/raw/bun.conf");
    SCANMILL_REAL_SCAN(view, shared_data, "1-bunny/raw/bun045.ply");
    const auto poses = read_poses(conf, [](const std::string&) {});
    const auto pose = std::ranges::find_if(poses, [](const ScanPose& p) { return is_of(p, "bun045.ply"); });
    ASSERT_NE(pose, poses.end());
    const auto scan = points_at(view);
    const Value moved = placed(Value(scan), pose->transform);
    const Aligned found = aligned(*scan, *moved.get<PointCloud>());
    EXPECT_LT((found.transform.rotation - pose->transform.rotation).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((found.transform.translation - pose->transform.translation).norm(), 1e-12);
    EXPECT_NEAR(found.scale, 1, 1e-12);
    EXPECT_LT(found.largest_residual, 1e-14);
    EXPECT_EQ(found.metrics.find("residual@101"), nullptr) << "only the first 100 are reported";
    EXPECT_NE(found.metrics.find("residual@100"), nullptr);
}

struct Model {
    const char* file;
    const char* refusal;  ///< part of the message; null if a side of the model is a rectangle that faces upwards
};

class PlateCornersReal : public testing::TestWithParam<Model> {};

TEST_P(PlateCornersReal, AModelThatIsNotAPlate_IsRefusedOrHasARectangleOnAPlane) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const auto cloud = points_at(path);
    const double diagonal = bounding_box(cloud->positions.span()).diagonal();
    PlateCornersParams params;
    params.tolerance = 0.002 * diagonal;
    Context context;
    try {
        const PlateCornersResult found = plate_corners(*cloud, params, context);
        EXPECT_EQ(GetParam().refusal, nullptr);
        ASSERT_EQ(found.corners.size(), 4u);
        EXPECT_LE(found.flatness, 0.002 * diagonal);
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 side = found.corners.positions[(i + 1) % 4] - found.corners.positions[i];
            const Vec3 next = found.corners.positions[(i + 2) % 4] - found.corners.positions[(i + 1) % 4];
            EXPECT_LT(std::abs(side.normalized().dot(next.normalized())), 0.1);
        }
    } catch (const Error& error) {
        ASSERT_NE(GetParam().refusal, nullptr) << error.sentence();
        EXPECT_THAT(error.sentence(), testing::HasSubstr(GetParam().refusal));
        EXPECT_FALSE(error.hint().empty()) << error.sentence();
    }
}
INSTANTIATE_TEST_SUITE_P(Models, PlateCornersReal,
                         testing::Values(Model{"meshes/anchor_dense.off", nullptr},
                                         Model{"meshes/fandisk.off", "`up` is 90 deg off the normal of the plate"},
                                         Model{"meshes/bear.off", "no plane: the best one has "},
                                         Model{"meshes/blade.off", "2 of 4 sides of the plane are not straight"},
                                         Model{"meshes/cactus.off", "2 of 4 sides of the plane are not straight"},
                                         Model{"meshes/cube-meshed.off", "`up` is 90 deg off the normal"}));

}  // namespace
}  // namespace scanmill::test
