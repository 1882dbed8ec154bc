// SPDX-License-Identifier: GPL-3.0-or-later
/// Clouds with frames, as the filter gets them.
#include "register/registered_clouds.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "filters/register/cases.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

struct Clouds {
    std::vector<View> views;
    std::vector<std::shared_ptr<const PointCloud>> clouds;
};

/// The views with a column `approach`, in named frames with origins far away.
Clouds clouds_of(std::vector<View> views) {
    Clouds result{std::move(views), {}};
    for (const View& view : result.views) {
        PointCloud cloud;
        cloud.frame.unit = LengthUnit::millimetre;
        cloud.frame.name = view.name;
        cloud.frame.origin = Vec3(1e6, -2e6, 10 * static_cast<double>(result.clouds.size()));
        Array<Vec3> positions;
        Array<double> approach;
        for (const Vec3& p : view.points) {
            positions.push_back(p);
            approach.insert(approach.end(), view.to_scanner.data(), view.to_scanner.data() + 3);
        }
        cloud.positions = std::move(positions);
        cloud.columns.add(Column("approach", 3, Buffer<double>(std::move(approach))));
        result.clouds.push_back(std::make_shared<const PointCloud>(std::move(cloud)));
    }
    return result;
}

const std::vector<View>& lump_views() {
    static const std::vector<View> views = views_of(lump(), 8);
    return views;
}

struct CloudsRun {
    Transforms transforms;
    std::vector<std::string> warnings, doubts;
    Metrics metrics;
};

CloudsRun run(const Clouds& clouds, const RegisterParams& params = {}) {
    Context context;
    CloudsRun result{registered_clouds(clouds.clouds, params, context), context.warnings(), {}, context.metrics()};
    for (const Doubt& doubt : context.doubts()) result.doubts.push_back(doubt.text);
    return result;
}

/// Largest distance between the positions to which the motions of two views bring one point of the object.
double gap(const Clouds& clouds, const Transforms& transforms) {
    double largest = 0;
    const RigidMotion to_first = clouds.views[1].truth.then(clouds.views[0].truth.inverse());
    for (std::size_t i = 0; i < clouds.views[1].points.size(); i += 97) {
        const Vec3 &p = clouds.views[1].points[i], in_first = to_first.apply(p);
        largest = std::max(largest, (transforms.motion_from("view 2").apply(clouds.clouds[1]->frame.origin + p) -
                                     transforms.motion_from("view 1").apply(clouds.clouds[0]->frame.origin + in_first))
                                        .norm());
    }
    return largest;
}

TEST(RegisterClouds, MotionsMapWorldCoordinatesIntoTheFirstFrame) {
    const Clouds clouds = clouds_of(in_random_frames(lump_views(), 1, 100));
    const CloudsRun found = run(clouds);
    ASSERT_EQ(found.transforms.motions.size(), 8u);
    EXPECT_LT(gap(clouds, found.transforms), 0.3);
    EXPECT_EQ(found.transforms.motions[0].rotation, Eigen::Matrix3d::Identity());
    EXPECT_EQ(found.transforms.motions[0].translation, Vec3::Zero());
    EXPECT_EQ(found.transforms.motions[1].to, "view 1");
    EXPECT_EQ(found.transforms.motions[1].unit, LengthUnit::millimetre);
    ASSERT_GE(found.transforms.edges.size(), 7u);
    EXPECT_EQ(found.transforms.edges[0].pose.from, "view 1");
    EXPECT_GT(found.transforms.edges[0].overlap, 0.3);
    EXPECT_EQ(found.metrics.find("placed")->value, 8);
    EXPECT_GT(found.metrics.find("overlap@2")->value, 0.3);
    EXPECT_TRUE(found.warnings.empty());
}

TEST(RegisterClouds, AStrangerFails_OrIsLeftOutWithADoubt) {
    std::vector<View> views = lump_views();
    views.push_back(views_of(lump(2), 8)[0]);
    views.back().name = "stranger";
    const Clouds clouds = clouds_of(in_random_frames(views, 1, 100));
    const Error error = error_of([&] { run(clouds); });
    EXPECT_THAT(error.sentence(), HasSubstr("1 of 9 views cannot be placed surely: 'stranger' ("));
    EXPECT_FALSE(error.hint().empty());
    RegisterParams params;
    params.on_refusal = RegisterParams::OnRefusal::leave_out;
    const CloudsRun found = run(clouds, params);
    EXPECT_EQ(found.transforms.motions.size(), 8u);
    ASSERT_EQ(found.transforms.refused.size(), 1u);
    EXPECT_EQ(found.transforms.refused[0].from, "stranger");
    EXPECT_THAT(found.doubts, Contains(HasSubstr("'stranger'")));
    EXPECT_EQ(found.metrics.find("refused")->value, 1);
}

TEST(RegisterClouds, ViewsInOneFrame_AreKeptAsTheyAre_AndMovedOnesAreRegisteredAnew) {
    Clouds clouds = clouds_of(lump_views());
    RegisterParams params;
    params.as_is = true;
    for (auto& cloud : clouds.clouds) {
        PointCloud copy = *cloud;
        copy.frame.origin = Vec3(5, 6, 7);
        cloud = std::make_shared<const PointCloud>(copy);
    }
    const CloudsRun kept = run(clouds, params);
    for (const RigidTransform& motion : kept.transforms.motions) {
        EXPECT_EQ(motion.rotation, Eigen::Matrix3d::Identity());
        EXPECT_EQ(motion.translation, Vec3::Zero());
    }
    const Clouds moved = clouds_of(in_random_frames(lump_views(), 1, 100));
    const CloudsRun found = run(moved, params);
    EXPECT_LT(gap(moved, found.transforms), 0.3);
    EXPECT_THAT(found.warnings, Contains(HasSubstr("registered anew")));
}

TEST(RegisterClouds, PosesOfAFile_AreRefined) {
    const Clouds clouds = clouds_of(in_random_frames(lump_views(), 1, 100));
    const CloudsRun first = run(clouds);
    const auto file = std::filesystem::path(testing::TempDir()) / "register-start.json";
    std::ofstream out(file);
    out.precision(17);
    const auto write = [&](const char* scan, const RigidTransform& motion, double off) {
        out << R"({"scan": ")" << scan << R"(", "matrix": [)";
        for (int i = 0; i < 3; ++i)
            out << "[" << motion.rotation(i, 0) << "," << motion.rotation(i, 1) << "," << motion.rotation(i, 2) << ","
                << motion.translation[i] + off << "],";
        out << "[0,0,0,1]]}";
    };
    out << R"({"scanmill": 1, "unit": "mm", "frame": "view 1", "poses": [)";
    for (std::size_t i = 0; i < 8; ++i) {
        if (i > 0) out << ",";
        write(clouds.views[i].name.c_str(), first.transforms.motions[i], i == 0 ? 0 : 0.5);
    }
    out << "]}";
    out.close();
    RegisterParams params;
    params.start = file;
    EXPECT_LT(gap(clouds, run(clouds, params).transforms), 0.3);
}

CloudsRun run_on(const Clouds& clouds, const TriangleMesh& target) {
    Context context;
    return {registered_to_mesh(clouds.clouds, target, {}, context), context.warnings(), {}, context.metrics()};
}

TEST(RegisterToMesh, AView_IsPlacedOnTheObject) {
    Clouds clouds = clouds_of(in_random_frames({lump_views()[2]}, 5, 100));
    TriangleMesh target = lump();
    target.frame.unit = LengthUnit::millimetre;
    target.frame.name = "model";
    target.frame.origin = Vec3(-7, 8, 9);
    const CloudsRun found = run_on(clouds, target);
    const RigidTransform& motion = found.transforms.motions.at(0);
    EXPECT_EQ(motion.to, "model");
    for (std::size_t i = 0; i < clouds.views[0].points.size(); i += 97) {
        const Vec3& p = clouds.views[0].points[i];
        EXPECT_LT(
            (motion.apply(clouds.clouds[0]->frame.origin + p) - (target.frame.origin + clouds.views[0].truth.apply(p)))
                .norm(),
            0.3);
    }
    EXPECT_GT(found.metrics.find("overlap")->value, 0.8);
    EXPECT_LT(found.metrics.find("rival")->value, 0.6);
}

TEST(RegisterToMesh, ASphereAndAnotherObject_AreRefused_AndSoAreTwoScansAndAnotherUnit) {
    TriangleMesh sphere = geodesic_sphere(40, 20);
    sphere.frame.unit = LengthUnit::millimetre;
    const Clouds of_sphere = clouds_of(in_random_frames({views_of(sphere, 8)[0]}, 5, 100));
    EXPECT_THAT(error_of([&] { run_on(of_sphere, sphere); }).sentence(),
                HasSubstr("cannot be placed surely on the target ("));
    TriangleMesh other = lump(2);
    other.frame.unit = LengthUnit::millimetre;
    Clouds clouds = clouds_of(in_random_frames({lump_views()[2]}, 5, 100));
    EXPECT_THAT(error_of([&] { run_on(clouds, other); }).sentence(), HasSubstr("(no-fit)"));
    PointCloud round = *clouds.clouds[0];
    Array<double> normals;
    for (std::size_t i = 0; i < round.size(); ++i) normals.insert(normals.end(), {0.0, 0.0, i % 2 == 0 ? 1.0 : -1.0});
    round.columns = {};
    round.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
    const Clouds from_all_sides{{}, {std::make_shared<const PointCloud>(round)}};
    EXPECT_THAT(error_of([&] { run_on(from_all_sides, other); }).sentence(), HasSubstr("scanned from several sides"));
    other.frame.unit = LengthUnit::inch;
    EXPECT_EQ(error_of([&] { run_on(clouds, other); }).sentence(), "'view 3' is in mm and the target in in");
    clouds.clouds.push_back(clouds.clouds[0]);
    EXPECT_EQ(error_of([&] { run_on(clouds, other); }).sentence(), "a target takes one scan; there are 2");
}

TEST(RegisterClouds, WithoutAScannersSide_AreWarnedOf) {
    Clouds clouds = clouds_of(lump_views());
    for (auto& cloud : clouds.clouds) {
        PointCloud copy = *cloud;
        copy.columns = {};
        cloud = std::make_shared<const PointCloud>(copy);
    }
    clouds.clouds.resize(1);
    const CloudsRun found = run(clouds);
    EXPECT_THAT(found.warnings, Contains(HasSubstr("1 view is without a column `approach` or `normal`")));
    EXPECT_EQ(found.transforms.motions.at(0).translation, Vec3::Zero());
}

TEST(RegisterClouds, TwoNamesOrTwoUnits_AreErrors) {
    Clouds clouds = clouds_of(lump_views());
    PointCloud copy = *clouds.clouds[1];
    copy.frame.name = "view 1";
    clouds.clouds[1] = std::make_shared<const PointCloud>(copy);
    EXPECT_EQ(error_of([&] { run(clouds); }).sentence(), "views 1 and 2 are both called 'view 1'");
    copy.frame.name = "view 2";
    copy.frame.unit = LengthUnit::inch;
    clouds.clouds[1] = std::make_shared<const PointCloud>(copy);
    EXPECT_EQ(error_of([&] { run(clouds); }).sentence(), "'view 1' is in mm and 'view 2' in in");
    clouds.clouds.clear();
    EXPECT_EQ(error_of([&] { run(clouds); }).sentence(), "needs views; there are none");
}

}  // namespace
}  // namespace scanmill::test
