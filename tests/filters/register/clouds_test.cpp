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

/// A file of poses: the motions, moved by `off` along each axis; the last scan is refused if a reason is given.
std::filesystem::path file_of(const Clouds& clouds, const Transforms& transforms, double off,
                              std::string refused = {}) {
    const auto file = std::filesystem::path(testing::TempDir()) / "register-poses.json";
    std::ofstream out(file);
    out.precision(17);
    out << R"({"scanmill": 1, "unit": "mm", "frame": "view 1", "poses": [)";
    for (std::size_t i = 0; i < clouds.views.size(); ++i) {
        const std::string scan = (i > 0 ? ", " : "") + (R"({"scan": ")" + clouds.views[i].name + '"');
        if (!refused.empty() && i + 1 == clouds.views.size()) {
            out << scan << R"(, "refused": ")" << refused << "\"}";
            continue;
        }
        const RigidTransform& motion = transforms.motions[i];
        out << scan << R"(, "matrix": [)";
        for (int row = 0; row < 3; ++row)
            out << "[" << motion.rotation(row, 0) << "," << motion.rotation(row, 1) << "," << motion.rotation(row, 2)
                << "," << motion.translation[row] + (i == 0 ? 0 : off) << "],";
        out << "[0,0,0,1]]}";
    }
    out << "]}";
    return file;
}

TEST(RegisterClouds, PosesToBeginWith_AreRefined) {
    const Clouds clouds = clouds_of(in_random_frames(lump_views(), 1, 100));
    Transforms poses = run(clouds).transforms;
    RegisterParams params;
    params.start = file_of(clouds, poses, 0.5);
    EXPECT_LT(gap(clouds, run(clouds, params).transforms), 0.3);
    poses.motions[3].translation += Vec3(-40, 25, 0);
    params.start = file_of(clouds, poses, 0);
    EXPECT_THAT(error_of([&] { run(clouds, params); }).sentence(), HasSubstr("'view 4' ("));
    params.as_is = true;
    EXPECT_THAT(error_of([&] { run(clouds, params); }).sentence(), HasSubstr("contradict each other"));
}

TEST(RegisterClouds, PosesOfAFile_AreTakenAsTheyAre) {
    const Clouds clouds = clouds_of(in_random_frames(lump_views(), 1, 100));
    const Transforms poses = run(clouds).transforms;
    RegisterParams params;
    params.poses = file_of(clouds, poses, 0.5, "too dark");
    params.as_is = true;  // less important than a file
    EXPECT_THAT(error_of([&] { run(clouds, params); }).sentence(),
                HasSubstr("the file of poses refuses 1 of 8 views: 'view 8' (too dark)"));
    params.on_refusal = RegisterParams::OnRefusal::leave_out;
    const CloudsRun found = run(clouds, params);
    EXPECT_THAT(found.doubts, Contains(HasSubstr("'view 8' (too dark)")));
    ASSERT_EQ(found.transforms.motions.size(), 7u);
    EXPECT_EQ(found.transforms.motions[3].from, "view 4");
    EXPECT_EQ(found.transforms.motions[3].to, "view 1");
    EXPECT_LT((found.transforms.motions[3].translation - poses.motions[3].translation - Vec3(0.5, 0.5, 0.5)).norm(),
              1e-6);
    ASSERT_EQ(found.transforms.refused.size(), 1u);
    EXPECT_EQ(found.transforms.refused[0].from, "view 8");
    EXPECT_EQ(found.transforms.refused[0].reason, "too dark");
    EXPECT_EQ(found.metrics.find("refused")->value, 1);
    params.start = params.poses;
    EXPECT_THAT(error_of([&] { run(clouds, params); }).sentence(), HasSubstr("`start` has no use"));
}

TEST(RegisterClouds, ViewsThatNothingConnects_StayAsTheyAreWithADoubt) {
    std::vector<View> views = {lump_views()[0], views_of(lump(2), 8)[3]};
    for (Vec3& p : views[1].points) p += Vec3(1e3, 0, 0);
    views[1].name = "view 2";
    RegisterParams params;
    params.as_is = true;
    const CloudsRun found = run(clouds_of(views), params);
    EXPECT_EQ(found.transforms.motions.size(), 2u);
    EXPECT_THAT(found.doubts, Contains(HasSubstr("they stay as they are")));
}

CloudsRun run_on(const Clouds& clouds, const TriangleMesh& target) {
    Context context;
    return {registered_to(target, clouds.clouds, {}, context), context.warnings(), {}, context.metrics()};
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

TEST(RegisterToMesh, AScanFromAllSides_IsPlacedOnMeshAndPoints) {
    const RigidMotion motion = in_random_frames({lump_views()[0]}, 5, 100)[0].truth.inverse();
    PointCloud scan;
    scan.frame.name = "scan";
    scan.frame.unit = LengthUnit::millimetre;
    Array<Vec3> positions;
    Array<double> approach;
    for (const View& view : lump_views())
        for (const Vec3& p : view.points) {
            positions.push_back(motion.apply(p));
            const Vec3 direction = motion.turned(view.to_scanner);
            approach.insert(approach.end(), direction.data(), direction.data() + 3);
        }
    scan.positions = std::move(positions);
    scan.columns.add(Column("approach", 3, Buffer<double>(std::move(approach))));
    const Clouds clouds{{}, {std::make_shared<const PointCloud>(scan)}};
    const auto largest_error = [&](const Transforms& found) {
        double largest = 0;
        for (std::size_t i = 0; i < scan.size(); i += 997)
            largest = std::max(
                largest,
                (found.motions.at(0).apply(scan.positions[i]) - motion.inverse().apply(scan.positions[i])).norm());
        return largest;
    };
    TriangleMesh mesh = lump();
    mesh.frame.unit = LengthUnit::millimetre;
    EXPECT_LT(largest_error(run_on(clouds, mesh).transforms), 0.3);
    PointCloud points = vertices_of(mesh);
    points.frame.unit = LengthUnit::millimetre;
    Array<double> normals(3 * points.size(), 0);
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
        const Vec3 area = (b - a).cross(c - a);
        for (const u32 vertex : t)
            for (int axis = 0; axis < 3; ++axis) normals[3 * vertex + static_cast<u32>(axis)] += area[axis];
    }
    points.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
    Context context;
    EXPECT_LT(largest_error(registered_to(points, clouds.clouds, {}, context)), 0.5);
}

TEST(RegisterToMesh, ASphereAndAnotherObject_AreRefused_AndSoAreTwoScansAndAnotherUnit) {
    TriangleMesh sphere = geodesic_sphere(40, 20);
    sphere.frame.unit = LengthUnit::millimetre;
    const Clouds of_sphere = clouds_of(in_random_frames({views_of(sphere, 8)[0]}, 5, 100));
    EXPECT_THAT(error_of([&] { run_on(of_sphere, sphere); }).sentence(),
                testing::AnyOf(HasSubstr("(slides)"), HasSubstr("(ambiguous)")));
    TriangleMesh other = lump(2);
    other.frame.unit = LengthUnit::millimetre;
    Clouds clouds = clouds_of(in_random_frames({lump_views()[2]}, 5, 100));
    EXPECT_THAT(error_of([&] { run_on(clouds, other); }).sentence(), HasSubstr("(no-fit)"));
    other.frame.unit = LengthUnit::inch;
    EXPECT_EQ(error_of([&] { run_on(clouds, other); }).sentence(), "'view 3' is in mm and the target in in");
    clouds.clouds.push_back(clouds.clouds[0]);
    EXPECT_EQ(error_of([&] { run_on(clouds, other); }).sentence(), "a target takes one scan; there are 2");
}

TEST(RegisterClouds, StackedViewsOfACylinder_AreDoubtful) {
    // Each view of a can on a turntable lies in the frame of its scanner: they fit on each other, and slide.
    std::vector<View> views;
    for (int i = 0; i < 4; ++i)
        views.push_back(height_view(
            "view " + std::to_string(i + 1), -30, 31, 0, 80,
            [](double x, double) { return std::sqrt(40.0 * 40 - x * x); }, 0.2, static_cast<u64>(i) + 1));
    RegisterParams params;
    params.as_is = true;
    EXPECT_THAT(run(clouds_of(views), params).doubts, Contains(HasSubstr("slide on each other")));
}

TEST(RegisterClouds, ScansFromAllSides_StayAsTheyAre_AndAreNoViews) {
    Clouds clouds = clouds_of({lump_views()[0], lump_views()[1]});
    for (auto& cloud : clouds.clouds) {
        PointCloud copy = *cloud;
        Array<double> normals;
        for (std::size_t i = 0; i < copy.size(); ++i)
            normals.insert(normals.end(), {0.0, i % 50 == 0 ? 1.0 : 0.0, i % 2 == 0 ? 1.0 : -1.0});
        copy.columns = {};
        copy.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
        cloud = std::make_shared<const PointCloud>(copy);
    }
    EXPECT_EQ(error_of([&] { run(clouds); }).sentence(), "'view 1' was scanned from several sides, so it is no view");
    RegisterParams params;
    params.as_is = true;
    const CloudsRun kept = run(clouds, params);
    EXPECT_EQ(kept.transforms.motions.size(), 2u);
    EXPECT_THAT(kept.warnings, Contains(HasSubstr("scanned from several sides")));
}

TEST(RegisterClouds, WithoutAScannersSide_AreWarnedOf) {
    Clouds clouds = clouds_of(lump_views());
    for (auto& cloud : clouds.clouds) {
        PointCloud copy = *cloud;
        copy.columns = {};
        cloud = std::make_shared<const PointCloud>(copy);
    }
    const CloudsRun found = run(clouds);
    EXPECT_LT(gap(clouds, found.transforms), 0.3) << "the sides are found in the points";
    EXPECT_EQ(found.metrics.find("placed")->value, 8);
    EXPECT_THAT(
        found.warnings,
        Contains(AllOf(HasSubstr("without a column `approach` or `normal`: the side of the scanner is estimated"),
                       HasSubstr("view 5"))));
}

TEST(RegisterClouds, OfViewsThatTheFieldCutsOff_PairsThatNoOtherViewsConfirm_AreDoubtful) {
    RegisterParams params;
    params.whole_views = false;
    const Clouds all = clouds_of(in_random_frames(lump_views(), 1, 100));
    EXPECT_THAT(run(all, params).doubts, testing::IsEmpty());
    Clouds two = all;
    const Transforms whole = run(all).transforms;
    std::size_t other = 1;
    while (other < 8 && !std::ranges::any_of(whole.edges, [&](const PoseEdge& edge) {
               return edge.pose.from == "view 1" && edge.pose.to == all.views[other].name;
           }))
        ++other;
    ASSERT_LT(other, 8u);
    two.clouds = {all.clouds[0], all.clouds[other]};
    EXPECT_THAT(run(two, params).doubts,
                Contains(HasSubstr("1 pair of views is confirmed by no other views: 'view 1'")));
}

TEST(RegisterClouds, OneViewStaysWhereItIs_WhateverItHas) {
    Clouds clouds = clouds_of(lump_views());
    PointCloud line = cloud_of({Vec3(1, 2, 3), Vec3(2, 4, 6)});
    line.frame.name = "line";
    clouds.clouds = {std::make_shared<const PointCloud>(std::move(line))};
    const CloudsRun found = run(clouds);
    EXPECT_TRUE(found.warnings.empty());
    EXPECT_EQ(found.transforms.motions.at(0).translation, Vec3::Zero());
    EXPECT_EQ(found.transforms.motions.at(0).to, "line");
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
