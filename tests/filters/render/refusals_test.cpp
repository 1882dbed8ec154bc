// SPDX-License-Identifier: GPL-3.0-or-later
/// What render refuses, what it warns of, and cancellation.

#include <gmock/gmock.h>

#include "filters/render/cases.hpp"
#include "support/numbers.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Error refusal_of(const Drawable& scene, const RenderParams& params = {}, const Drawable& over = {}) {
    const Error error = error_of([&] { picture_of(scene, params, 1, over); });
    EXPECT_THAT(error.hint(), Not("")) << error.sentence();
    return error;
}

TEST(RenderRefuses, MeshWithoutTriangles) {
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>{{0, 0, 0}};
    EXPECT_THAT(error_of([&] { picture_of(&mesh); }).sentence(), HasSubstr("no triangles"));
}

TEST(RenderRefuses, CloudAndFeaturesAndPatchesThatAreEmpty) {
    const PointCloud cloud;
    EXPECT_THAT(error_of([&] { picture_of(&cloud); }).sentence(), HasSubstr("0 points"));
    const FeatureGraph features;
    EXPECT_THAT(refusal_of(&features).sentence(), HasSubstr("empty"));
    const ProbePlan plan;
    EXPECT_THAT(refusal_of(&plan).sentence(), HasSubstr("empty"));
    const PatchComplex patches;
    EXPECT_THAT(refusal_of(&patches).sentence(), HasSubstr("no patches"));
    EXPECT_THAT(refusal_of({}).sentence(), HasSubstr("nothing to draw"));
}

TEST(RenderRefuses, CoordinatesThatAreNotFinite) {
    TriangleMesh mesh = centred_square(1);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    positions[2].y() = nan;
    mesh.positions = std::move(positions);
    EXPECT_THAT(refusal_of(&mesh).sentence(), HasSubstr("1 of 4 vertices has a NaN or an infinity"));
    PointCloud cloud;
    cloud.positions = Array<Vec3>{{infinity, 0, 0}};
    EXPECT_THAT(refusal_of(&cloud).sentence(), HasSubstr("1 of 1 points has a NaN or an infinity"));
    const TriangleMesh good = centred_square(1);
    EXPECT_THAT(refusal_of(&good, {}, &cloud).sentence(), HasSubstr("1 of 1 points has a NaN or an infinity"));
    ProbePlan plan;
    plan.touches.emplace_back().position = {nan, 0, 0};
    EXPECT_THAT(refusal_of(&good, {}, &plan).sentence(), HasSubstr("touch 0"));
}

TEST(RenderRefuses, ColumnThatDoesNotExist) {
    const TriangleMesh square = square_with("deviation", {0, 0, 0, 0});
    RenderParams params;
    params.colour = "deviaton";
    EXPECT_THAT(refusal_of(&square, params).sentence(),
                AllOf(HasSubstr("no column 'deviaton'"), HasSubstr("did you mean 'deviation'")));
    const TriangleMesh bare = centred_square(1);
    EXPECT_THAT(refusal_of(&bare, params).sentence(), HasSubstr("it has none"));
}

TEST(RenderRefuses, ColumnOfAKindWithoutColumns) {
    FeatureGraph features;
    features.positions = Array<Vec3>{{0, 0, 0}, {1, 0, 0}};
    features.vertices = Array<u32>{0, 1};
    features.polylines = {{FeatureType::crease, false, 0, 2}};
    RenderParams params;
    params.colour = "deviation";
    EXPECT_THAT(refusal_of(&features, params).sentence(), HasSubstr("does not apply"));
}

TEST(RenderRefuses, ColumnWithSeveralNumbersPerRow) {
    TriangleMesh square = centred_square(1);
    square.vertex_columns.add(Column("normal", 3, Buffer<double>(Array<double>(12, 1.0))));
    RenderParams params;
    params.colour = "normal";
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("3 numbers"));
}

TEST(RenderRefuses, ScaleUpsideDown) {
    const TriangleMesh square = square_with("d", {0, 1, 0, 1});
    RenderParams params;
    params.colour = "d";
    params.scale = {{Length(1), Length(-1)}};
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("from 1 to -1"));
}

TEST(RenderRefuses, ToleranceUpsideDown_AlsoWithoutAColumn) {
    const TriangleMesh square = centred_square(1);
    RenderParams params;
    params.tolerance = {{Length(0.2), Length(-0.1)}};
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("from 0.2 to -0.1"));
}

TEST(RenderRefuses, BandsWithAColumn) {
    const TriangleMesh square = square_with("d", {0, 1, 0, 1});
    RenderParams params;
    params.colour = "d";
    params.style = RenderParams::Style::lines;
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("not the colours of 'd'"));
}

TEST(RenderRefuses, SizeWithOneNumber) {
    const TriangleMesh square = centred_square(1);
    RenderParams params;
    params.size = {100};
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("has 1 numbers"));
}

TEST(RenderRefuses, ValuesOfDifferentFrames) {
    TriangleMesh square = centred_square(1);
    square.frame.name = "scanner";
    PointCloud cloud;
    cloud.frame.name = "part";
    cloud.positions = Array<Vec3>{{0, 0, 0}};
    EXPECT_THAT(error_of([&] { picture_of(&square, {}, 1, &cloud); }).sentence(),
                AllOf(HasSubstr("scanner"), HasSubstr("part")));
    EXPECT_THAT(error_of([&] { picture_of(&square, {}, 1, {}, &cloud); }).sentence(), HasSubstr("'truth'"));
}

TEST(RenderRefuses, CamerasThatDoNotFit) {
    const TriangleMesh square = centred_square(1);
    RenderParams params;
    params.look_at = {{Length(0), Length(0), Length(0)}};
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("needs an `eye`"));
    params.eye = params.look_at;
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("are the same"));
    params = {};
    params.camera = {};
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("`camera` is empty"));
    params.camera = {CameraView::front};
    params.eye = {{Length(1), Length(1), Length(1)}};
    EXPECT_THAT(refusal_of(&square, params).sentence(), HasSubstr("`eye` and `camera`"));
}

TEST(RenderWarns, PictureWithoutRoomForTheLegend) {
    const TriangleMesh square = square_with("deviation", {0, 1, 0, 1}, 1);
    RenderParams params;
    params.size = {16, 16};
    params.colour = "deviation";
    Context context;
    const Picture picture = render({&square, {}, {}}, params, context);
    EXPECT_EQ(picture.pixels.size(), 256u);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("legend is left out")));
}

TEST(RenderDoubts, PictureOfNothing) {
    const TriangleMesh square = centred_square(1);
    RenderParams params;
    params.size = {100, 100};
    params.eye = {{Length(0), Length(0), Length(5)}};
    params.look_at = {{Length(0), Length(0), Length(9)}};
    Context context;
    render({&square, {}, {}}, params, context);
    EXPECT_EQ(context.doubts().size(), 1u);
}

TEST(RenderWarns, MarksOfMeshesOnPoints) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>{{0, 0, 0}, {1, 0, 0}};
    RenderParams params = from_above();
    params.edges = params.creases = true;
    Context context;
    render({&cloud, {}, {}}, params, context);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("`edges` and `creases` do not apply")));
}

TEST(RenderWarns, ColumnLabelOfClasses) {
    PointCloud cloud;
    Array<Vec3> positions;
    for (int i = 0; i < 1500; ++i) positions.push_back({double(i % 40), double(i / 40), 0});
    cloud.positions = std::move(positions);
    cloud.columns.add(Column("label", 1, Buffer<u32>(Array<u32>(1500, 3))));
    Context context;
    render({&cloud, {}, {}}, from_above(), context);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("1500 values above 0")));
}

TEST(RenderWarns, LabelsWithoutRoom) {
    const TriangleMesh square = centred_square(1);
    PointCloud cloud;
    cloud.positions = Array<Vec3>(30, Vec3(0, 0, 0));
    cloud.columns.add(Column("label", 1, Buffer<u32>(Array<u32>(30, 7))));
    Context context;
    render({&square, &cloud, {}}, from_above(), context);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("no free place")));
}

TEST(Render, Cancelled_Stops) {
    const TriangleMesh sphere = geodesic_sphere(1, 20);
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(render({&sphere, {}, {}}, {}, context), Cancelled);
}

}  // namespace
}  // namespace scanmill
