// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <algorithm>

#include "filters/mesh_update/blocks.hpp"
#include "filters/mesh_update/bumps.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Clouds = std::vector<std::shared_ptr<const PointCloud>>;

MeshUpdateParams default_params() {
    MeshUpdateParams params;
    params.max_distance = 3;
    return params;
}

Clouds one(PointCloud cloud) { return {std::make_shared<const PointCloud>(std::move(cloud))}; }

Error refusal(const TriangleMesh& model, const Clouds& clouds, const MeshUpdateParams& params = default_params()) {
    Context context;
    Error error = error_of([&] { mesh_update(model, clouds, params, context); });
    EXPECT_NE(error.hint(), "") << error.sentence();
    return error;
}

const Rectangle middle{20, 10, 40, 30};

PointCloud pad() { return *step_cloud(middle, 20, 6, 4, 1); }

TEST(MeshUpdateRefusals, NoCloudAndAnEmptyCloud) {
    EXPECT_THAT(refusal(block(), {}).sentence(), HasSubstr("at least one cloud"));
    EXPECT_THAT(refusal(block(), one({})).sentence(), HasSubstr("0 points"));
}

TEST(MeshUpdateRefusals, CoordinatesThatAreNotFinite) {
    PointCloud cloud = pad();
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    positions[3].x() = std::nan("");
    cloud.positions = std::move(positions);
    EXPECT_THAT(refusal(block(), one(cloud)).sentence(), HasSubstr("1 of"));
}

TEST(MeshUpdateRefusals, AnotherUnitOrFrame) {
    PointCloud cloud = pad();
    cloud.frame.unit = LengthUnit::metre;
    EXPECT_THAT(refusal(block(), one(cloud)).sentence(), HasSubstr("in m"));
    cloud = pad();
    TriangleMesh model = block();
    model.frame.name = "part";
    cloud.frame.name = "scanner";
    EXPECT_THAT(refusal(model, one(cloud)).sentence(), AllOf(HasSubstr("'part'"), HasSubstr("'scanner'")));
}

TEST(MeshUpdateRefusals, AnOpenModel) {
    EXPECT_THAT(refusal(without_triangles(block(), {2}), one(pad())).sentence(),
                AllOf(HasSubstr("open"), HasSubstr("3 boundary edges")));
    EXPECT_THAT(refusal(TriangleMesh(), one(pad())).sentence(), HasSubstr("no triangles"));
}

TEST(MeshUpdateRefusals, AModelThatIsInsideOut) {
    TriangleMesh model = block();
    Array<Triangle> turned;
    for (const Triangle& t : model.triangles) turned.push_back({t[0], t[2], t[1]});
    model.triangles = std::move(turned);
    EXPECT_THAT(refusal(model, one(pad())).sentence(), HasSubstr("inside out"));
}

/// Both meshes as one, without joining vertices.
TriangleMesh both(const TriangleMesh& one, const TriangleMesh& other) {
    TriangleMesh mesh;
    Array<Vec3> positions(one.positions.begin(), one.positions.end());
    positions.insert(positions.end(), other.positions.begin(), other.positions.end());
    Array<Triangle> triangles(one.triangles.begin(), one.triangles.end());
    const u32 shift = static_cast<u32>(one.positions.size());
    for (const Triangle& t : other.triangles) triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TriangleMesh shifted(TriangleMesh mesh, const Vec3& by) {
    mesh.positions = translated(mesh.positions, by);
    return mesh;
}

TEST(MeshUpdateRefusals, AModelThatIntersectsItself) {
    const TriangleMesh model = both(block(), shifted(block(), {30, 20, -10}));
    EXPECT_THAT(refusal(model, one(pad())).sentence(), HasSubstr("intersects itself"));
}

TEST(MeshUpdateRefusals, AVertexWithSeveralFans) {
    // Two blocks that share one corner.
    TriangleMesh model = both(block(10, 10, 10), shifted(block(10, 10, 10), {10, 10, 10}));
    Array<Triangle> triangles(model.triangles.begin(), model.triangles.end());
    for (Triangle& t : triangles)
        for (u32& v : t)
            if (v == 8) v = 7;
    model.triangles = std::move(triangles);
    MeshUpdateParams params = default_params();
    params.density = 100;
    EXPECT_THAT(refusal(model, one(pad()), params).sentence(), HasSubstr("several fans"));
}

TEST(MeshUpdateRefusals, ACloudFarAway) {
    const Error error = refusal(block(), one(moved(pad(), 1, {0, 0, 500})));
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("hanging"), HasSubstr("500")));
    EXPECT_THAT(error.hint(), HasSubstr("on-doubt: keep"));
}

TEST(MeshUpdateRefusals, ACloudWithoutOverlap) {
    // The pad's top alone ends 6 above the model.
    Array<Vec3> top;
    for (const Vec3& p : pad().positions)
        if (p.z() == 26) top.push_back(p);
    PointCloud cloud;
    cloud.positions = std::move(top);
    EXPECT_THAT(refusal(block(), one(cloud)).sentence(), HasSubstr("hanging"));
}

TEST(MeshUpdateRefusals, ACloudThatIsNotRegistered) {
    EXPECT_THAT(refusal(block(), one(moved(pad(), 1, {0, 0, 0.8}))).sentence(),
                AllOf(HasSubstr("registration"), HasSubstr("0.8")));
}

TEST(MeshUpdateRefusals, ACloudThatCoversEverything) {
    PointCloud cloud;
    cloud.positions = geodesic_sphere(10, 20).positions;
    EXPECT_THAT(refusal(geodesic_sphere(10, 16), one(cloud)).sentence(), HasSubstr("no boundary"));
}

TEST(MeshUpdateRefusals, ACloudOfOutliers) {
    // Points in space have no surface whose border lies on the model.
    EXPECT_NE(refusal(block(), one(moved(random_cube(2000, 3, 20), 1, {20, 10, 10}))).sentence(), "");
}

/// A disc across the tube of torus(10, 4, …): its border runs round the tube, which does not divide the torus.
PointCloud disc_across_the_tube() {
    Array<Vec3> points;
    for (int i = -10; i <= 10; ++i)
        for (int k = -10; k <= 10; ++k)
            if (const Vec3 p(0.4 * i, 0, 0.4 * k); p.norm() <= 4) points.push_back(p + Vec3(10, 0, 0));
    PointCloud cloud;
    cloud.positions = std::move(points);
    return cloud;
}

TEST(MeshUpdateRefusals, ALoopAroundAHandleDoesNotDivide) {
    EXPECT_THAT(refusal(torus(10, 4, 60, 30), one(disc_across_the_tube())).sentence(), HasSubstr("no separation"));
}

TEST(MeshUpdateRefusals, CloudsThatDisagree) {
    // The second cloud lies on a group that the first replaces.
    const Clouds clouds{step_cloud({10, 5, 50, 35}, 20, 0, 2, 1), step_cloud({26, 16, 34, 24}, 20, 0, 4, 1)};
    EXPECT_THAT(refusal(block(), clouds).sentence(), HasSubstr("ambiguous"));
}

TEST(MeshUpdateRefusals, ALoopThatTouchesItself) {
    // Two squares of points with one corner in common.
    Array<Vec3> points;
    for (int i = 0; i <= 10; ++i)
        for (int j = 0; j <= 10; ++j) {
            points.emplace_back(20 + i, 10 + j, 20);
            if (i > 0 || j > 0) points.emplace_back(30 + i, 20 + j, 20);
        }
    PointCloud cloud;
    cloud.positions = std::move(points);
    Context context;
    try {
        const MeshUpdateResult result = mesh_update(block(), one(cloud), default_params(), context);
        EXPECT_NEAR(signed_volume(result.mesh), 48000, 480);
    } catch (const Error& error) {
        EXPECT_NE(error.hint(), "");
    }
}

TEST(MeshUpdateRefusals, Parameters) {
    MeshUpdateParams params = default_params();
    params.max_distance = 0.0;
    EXPECT_THAT(refusal(block(), one(pad()), params).sentence(), HasSubstr("max-distance"));
    params = default_params();
    params.trim = -1;
    EXPECT_THAT(refusal(block(), one(pad()), params).sentence(), HasSubstr("trim"));
    params = default_params();
    params.density = 0;
    EXPECT_THAT(refusal(block(), one(pad()), params).sentence(), HasSubstr("density"));
    params = default_params();
    params.angle_gap = Angle::degrees(91);
    EXPECT_THAT(refusal(block(), one(pad()), params).sentence(), HasSubstr("angle-gap"));
}

TEST(MeshUpdateRefusals, NoiseModeWithALocalRebuild) {
    MeshUpdateParams params = default_params();
    params.rebuild = MeshUpdateParams::Rebuild::local;
    params.noise = MeshUpdateParams::Noise::big_balls;
    EXPECT_THAT(refusal(block(), one(pad()), params).sentence(), HasSubstr("big-balls"));
}

TEST(MeshUpdateRefusals, ACloudOfDuplicates) {
    PointCloud cloud = pad();
    Array<Vec3> twice(cloud.positions.begin(), cloud.positions.end());
    twice.insert(twice.end(), cloud.positions.begin(), cloud.positions.end());
    cloud.positions = std::move(twice);
    EXPECT_THAT(refusal(block(), one(cloud)).sentence(), HasSubstr("duplicates"));
}

TEST(MeshUpdateRefusals, CloudsWithTheOthersBorderInside) {
    // Two caps that overlap at the equator: each one's loop lies under the other.
    Array<Vec3> upper, lower;
    for (const Vec3& p : geodesic_sphere(10, 30).positions) {
        if (p.z() > -1) upper.push_back(p);
        if (p.z() < 1) lower.push_back(p);
    }
    PointCloud above, below;
    above.positions = std::move(upper);
    below.positions = std::move(lower);
    EXPECT_THAT(refusal(geodesic_sphere(10, 16), {one(above)[0], one(below)[0]}).sentence(), HasSubstr("ambiguous"));
}

TEST(OnDoubtKeep, ReturnsTheModelBitForBit) {
    struct Doubtful {
        std::string kind;
        TriangleMesh model;
        Clouds clouds;
    };
    const std::vector<Doubtful> doubts{
        {"hanging", block(), one(moved(pad(), 1, {0, 0, 500}))},
        {"registration", block(), one(moved(pad(), 1, {0, 0, 0.8}))},
        {"no separation", torus(10, 4, 60, 30), one(disc_across_the_tube())},
        {"ambiguous", block(), {step_cloud({10, 5, 50, 35}, 20, 0, 2, 1), step_cloud({26, 16, 34, 24}, 20, 0, 4, 1)}}};
    for (const auto& [kind, model, clouds] : doubts) {
        MeshUpdateParams params = default_params();
        params.on_doubt = MeshUpdateParams::OnDoubt::keep;
        Context context;
        const MeshUpdateResult result = mesh_update(model, clouds, params, context);
        EXPECT_FALSE(result.updated);
        EXPECT_THAT(result.doubt, HasSubstr(kind));
        EXPECT_TRUE(std::ranges::equal(result.mesh.positions, model.positions)) << kind;
        EXPECT_TRUE(std::ranges::equal(result.mesh.triangles, model.triangles)) << kind;
        ASSERT_EQ(context.warnings().size(), 1) << kind;
        EXPECT_THAT(context.warnings()[0], HasSubstr(kind));
        EXPECT_EQ(context.metrics().find("updated")->value, 0);
        EXPECT_EQ(context.metrics().find("replaced")->value, 0);
        EXPECT_EQ(result.kept, result.initial);
        for (const u8 updated : result.mesh.face_columns.find("updated")->values<u8>()) EXPECT_EQ(updated, 0);
    }
}

}  // namespace
}  // namespace scanmill::test
