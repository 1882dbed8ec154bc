// SPDX-License-Identifier: GPL-3.0-or-later
/// Facts that every picture must agree with: areas, colours, what hides what, and equal bytes.

#include <gmock/gmock.h>

#include <cmath>

#include "filters/render/cases.hpp"
#include "render/legend.hpp"
#include "render/scene.hpp"
#include "support/numbers.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(Render, Sphere_SilhouetteHasTheAreaOfADisc) {
    // The view leaves a margin of 5 %, so the radius is 0.45 of the picture's rows.
    const TriangleMesh sphere = geodesic_sphere(7, 40);
    RenderParams params;
    params.size = {600, 400};
    const double radius = 0.45 * 400;
    for (const CameraView view : {CameraView::automatic, CameraView::front, CameraView::top}) {
        params.camera = {view};
        const Picture picture = picture_of(&sphere, params);
        const double covered = static_cast<double>(count_pixels(picture, [](const Colour& c) { return !is_white(c); }));
        // Pixels that the rim crosses count whole: half a pixel along the rim, on average.
        const double area = std::numbers::pi * radius * radius, rim = 2 * std::numbers::pi * radius;
        EXPECT_NEAR(covered, area + rim / 2, rim / 2);
        EXPECT_FALSE(is_white(pixel(picture, 300, 200)));
        EXPECT_TRUE(is_white(pixel(picture, 300 + 185, 200)));
        EXPECT_FALSE(is_white(pixel(picture, 300 + 176, 200)));
    }
}

TEST(Render, OneTriangle_CoversHalfOfItsSquare) {
    TriangleMesh triangle;
    triangle.positions = Array<Vec3>{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    triangle.triangles = Array<Triangle>{{0, 1, 2}};
    const Picture picture = picture_of(&triangle, from_above());
    const std::size_t covered = count_pixels(picture, [](const Colour& c) { return !is_white(c); });
    EXPECT_NEAR(static_cast<double>(covered), 180 * 180 / 2.0, 180);
    // x points to the right and y upwards.
    EXPECT_FALSE(is_white(pixel(picture, 15, 185)));
    EXPECT_TRUE(is_white(pixel(picture, 185, 15)));
}

TEST(Render, FaceTowardsTheCamera_HasTheColoursOfTheScale) {
    const TriangleMesh square = square_with("height", {-2, 2, 2, -2}, 1);
    RenderParams params = from_above();
    params.colour = "height";
    params.scale = {{Length(-2), Length(1)}};
    const Picture picture = picture_of(&square, params);
    const ColourScale scale{-2, 1};
    for (const u32 x : {20u, 60u, 100u, 140u, 180u}) {
        const double value = -2 + 4 * (x + 0.5 - 10) / 180;
        EXPECT_LE(difference(pixel(picture, x, 100), colour_of(scale, value)), 2) << value;
    }
}

TEST(Render, ColumnOfAFace_ColoursThatFaceAlone) {
    TriangleMesh square = square_with("other", {0, 0, 0, 0});
    square.face_columns.add(Column("group", 1, Buffer<u32>(Array<u32>{0, 1})));
    RenderParams params = from_above();
    params.colour = "group";
    const Picture picture = picture_of(&square, params);
    const ColourScale scale{0, 1};
    EXPECT_LE(difference(pixel(picture, 150, 150), colour_of(scale, 0)), 2);
    EXPECT_LE(difference(pixel(picture, 50, 50), colour_of(scale, 1)), 2);
}

TEST(Render, ColumnOfColours_IsShownAsItIs) {
    TriangleMesh square = square_with("other", {0, 0, 0, 0});
    square.vertex_columns.add(
        Column("colour", 3, Buffer<u8>(Array<u8>{200, 40, 90, 200, 40, 90, 200, 40, 90, 200, 40, 90})));
    RenderParams params = from_above();
    params.colour = "colour";
    EXPECT_LE(difference(pixel(picture_of(&square, params), 100, 100), {200, 40, 90}), 1);
}

TEST(Render, ValuesWithoutData_AreGrey) {
    const TriangleMesh square = square_with("height", {nan, 1, 0, nan}, 1);
    RenderParams params = from_above();
    params.colour = "height";
    EXPECT_LE(difference(pixel(picture_of(&square, params), 30, 40), no_data), 2);
    ContextOptions options;
    Context context(options);
    const TriangleMesh empty = square_with("height", {nan, nan, nan, nan});
    const Picture picture = render({&empty, {}, {}}, params, context);
    EXPECT_LE(difference(pixel(picture, 100, 100), no_data), 2);
    EXPECT_THAT(context.warnings(), testing::ElementsAre(HasSubstr("'height' has no value")));
}

TEST(Render, EqualValues_HaveOneColourAndOneNumber) {
    const TriangleMesh square = square_with("height", {3, 3, 3, 3}, 1);
    RenderParams params = from_above();
    params.colour = "height";
    params.legend = true;
    params.size = {400, 200};
    const Picture picture = picture_of(&square, params);
    EXPECT_THAT(picture.caption, HasSubstr("height [u]: 3 to 3"));
    EXPECT_LE(difference(pixel(picture, 100, 100), colour_of({3, 3}, 3)), 2);
}

TEST(Render, NearerSurface_HidesTheFartherOneAndItsLines) {
    // A small square above a large one, which has a different colour.
    const TriangleMesh low = centred_square(4), high = centred_square(2, 1);
    TriangleMesh scene = both(low, high);
    scene.face_columns.add(Column("which", 1, Buffer<double>(Array<double>{0, 0, 1, 1})));
    RenderParams params = from_above();
    params.colour = "which";
    const auto shows = [&](const Picture& picture, double value) {
        return difference(pixel(picture, 100, 100), colour_of({0, 1}, value)) < 40;
    };
    EXPECT_TRUE(shows(picture_of(&scene, params), 1));
    params.camera = {CameraView::bottom};
    EXPECT_TRUE(shows(picture_of(&scene, params), 0));

    FeatureGraph line;
    line.positions = Array<Vec3>{{-1.9, 0, 0}, {1.9, 0, 0}};
    line.vertices = Array<u32>{0, 1};
    line.left_normals = line.right_normals = Array<Vec3>{{0, 0, 1}, {0, 0, 1}};
    line.polylines = {{FeatureType::crease, false, 0, 2}};
    params = from_above();
    const Picture with_line = picture_of(&scene, params, 2, &line), without = picture_of(&scene, params);
    EXPECT_EQ(pixel(with_line, 100, 100), pixel(without, 100, 100)) << "the high square hides the line";
    EXPECT_LT(brightness(pixel(with_line, 25, 100)), brightness(pixel(without, 25, 100)) - 50);
}

TEST(Render, CornerBetweenWalls_IsDarkerThanAnOpenFloor) {
    const TriangleMesh floor = centred_square(4);
    TriangleMesh walls = floor;
    for (const double angle : {90 * degree, -90 * degree}) {
        TriangleMesh wall = turned(centred_square(4), angle, Vec3::UnitX());
        walls = both(walls, shifted(wall, {0, angle > 0 ? 2.0 : -2.0, 2}));
    }
    const Picture open = picture_of(&floor, from_above()), closed = picture_of(&walls, from_above());
    EXPECT_GT(brightness(pixel(open, 100, 15)) - brightness(pixel(closed, 100, 15)), 15);
    EXPECT_LT(brightness(pixel(closed, 100, 15)), brightness(pixel(closed, 100, 100)));
}

TEST(Render, BackOfASurface_HasAnotherColour) {
    const TriangleMesh square = centred_square(2);
    const Colour front = pixel(picture_of(&square, from_above(CameraView::top)), 100, 100),
                 back = pixel(picture_of(&square, from_above(CameraView::bottom)), 100, 100);
    EXPECT_GT(front[0], front[2]) << "clay";
    EXPECT_LT(back[0], back[2]) << "blue-grey";
}

TEST(Render, AnyNumberOfThreads_GivesTheSameBytes) {
    const TriangleMesh surface = torus(3, 1, 60, 30);
    for (const RenderParams::Style style : {RenderParams::Style::shaded, RenderParams::Style::lines}) {
        RenderParams params;
        params.size = {160, 120};
        params.style = style;
        params.edges = style == RenderParams::Style::shaded;
        const Picture one = picture_of(&surface, params, 1);
        EXPECT_TRUE(one == picture_of(&surface, params, 2));
        EXPECT_TRUE(one == picture_of(&surface, params, 8));
    }
    PointCloud points;
    points.positions = surface.positions;
    RenderParams params;
    params.size = {160, 120};
    params.camera = {CameraView::automatic, CameraView::top};
    const Picture one = picture_of(&points, params, 1, &points, &surface);
    EXPECT_TRUE(one == picture_of(&points, params, 8, &points, &surface));
}

TEST(Render, ShiftedFrame_GivesTheSamePicture) {
    const TriangleMesh surface = torus(3, 1, 40, 20);
    TriangleMesh far = surface;
    far.frame.origin = {1e6, -2e6, 5e5};
    RenderParams params;
    params.size = {160, 120};
    EXPECT_TRUE(picture_of(&surface, params) == picture_of(&far, params));
    params.eye = {{Length(9), Length(8), Length(7)}};
    const Picture near_eye = picture_of(&surface, params);
    params.eye = {{Length(1e6 + 9), Length(-2e6 + 8), Length(5e5 + 7)}};
    EXPECT_TRUE(near_eye == picture_of(&far, params));
}

TEST(Render, Truth_SetsTheCamera) {
    // A small square drawn with the camera of a large one covers a quarter of its area.
    const TriangleMesh large = centred_square(4), small = centred_square(2);
    const Picture picture = picture_of(&small, from_above(), 2, {}, &large);
    const std::size_t covered = count_pixels(picture, [](const Colour& c) { return !is_white(c); });
    EXPECT_NEAR(static_cast<double>(covered), 90 * 90, 2 * 90);
}

TEST(Render, SeveralCameras_ShareThePicture) {
    const TriangleMesh box = cube(2);
    RenderParams params;
    params.size = {400, 300};
    params.camera = {CameraView::front, CameraView::top, CameraView::left, CameraView::right};
    const Picture picture = picture_of(&box, params);
    for (const u32 x : {100u, 300u})
        for (const u32 y : {75u, 225u}) EXPECT_FALSE(is_white(pixel(picture, x, y)));
    EXPECT_TRUE(is_white(pixel(picture, 200, 150))) << "between the views";
    EXPECT_THAT(picture.caption, HasSubstr("view front top left right"));
}

TEST(Render, Views_LookFromTheNamedSides) {
    // A box whose sides have different lengths: x 1, y 2, z 3. Its silhouettes are rectangles of two of them.
    TriangleMesh box = with_positions(cube(1), [](const Vec3& p) { return Vec3(p.x(), 2 * p.y(), 3 * p.z()); });
    RenderParams params;
    params.size = {300, 300};
    params.up = UpAxis::z;
    const auto ratio = [&](CameraView view) {  // width / height
        params.camera = {view};
        const Picture picture = picture_of(&box, params);
        u32 wide = 0, high = 0;
        for (u32 i = 0; i < 300; ++i) {
            wide += !is_white(pixel(picture, i, 150));
            high += !is_white(pixel(picture, 150, i));
        }
        return double(wide) / high;
    };
    EXPECT_NEAR(ratio(CameraView::front), 1.0 / 3, 0.01);
    EXPECT_NEAR(ratio(CameraView::back), 1.0 / 3, 0.01);
    EXPECT_NEAR(ratio(CameraView::left), 2.0 / 3, 0.01);
    EXPECT_NEAR(ratio(CameraView::right), 2.0 / 3, 0.01);
    EXPECT_NEAR(ratio(CameraView::top), 1.0 / 2, 0.01);
    EXPECT_NEAR(ratio(CameraView::bottom), 1.0 / 2, 0.01);
    params.up = UpAxis::y;
    EXPECT_NEAR(ratio(CameraView::front), 1.0 / 2, 0.01);
    params.up = UpAxis::x;
    EXPECT_NEAR(ratio(CameraView::front), 2.0 / 1, 0.02);
}

TEST(Render, UpAxis_IsThatOfTheFlatBase) {
    // A pyramid on the plane y = 0: its base faces -y, no face is perpendicular to z.
    TriangleMesh pyramid;
    pyramid.positions = Array<Vec3>{{0, 0, 0}, {2, 0, 0}, {2, 0, 2}, {0, 0, 2}, {1, 2, 1}};
    pyramid.triangles = Array<Triangle>{{0, 1, 2}, {0, 2, 3}, {1, 0, 4}, {2, 1, 4}, {3, 2, 4}, {0, 3, 4}};
    RenderParams params;
    params.size = {200, 200};
    params.camera = {CameraView::front};
    const Picture automatic = picture_of(&pyramid, params);
    params.up = UpAxis::y;
    EXPECT_TRUE(automatic == picture_of(&pyramid, params));
    params.up = UpAxis::z;
    EXPECT_FALSE(automatic == picture_of(&pyramid, params));
}

TEST(Render, Eye_SeesThePointItLooksAtInTheMiddle) {
    const TriangleMesh square = centred_square(1);
    RenderParams params = from_above();
    params.camera = RenderParams().camera;
    params.eye = {{Length(0), Length(0), Length(10)}};
    // 40 degrees over 200 pixels: a square of side 1 at distance 10 spans 200 / (2 * 10 * tan 20 deg) pixels.
    const double side = 200 / (20 * std::tan(20 * degree));
    const auto covered = [&] {
        return static_cast<double>(
            count_pixels(picture_of(&square, params), [](const Colour& c) { return !is_white(c); }));
    };
    EXPECT_NEAR(covered(), side * side, 2 * side + 4);
    params.look_at = {{Length(0), Length(5), Length(0)}};
    EXPECT_TRUE(is_white(pixel(picture_of(&square, params), 100, 100)));
}

TEST(Render, AutomaticCamera_SeesTheFrontOfAnOpenSurface) {
    // A flat surface seen from either side has the same silhouette; its front counts more.
    const TriangleMesh front = turned(centred_square(2), 90 * degree, Vec3::UnitX());
    RenderParams params;
    params.size = {100, 100};
    for (const TriangleMesh& mesh : {front, inside_out(front)}) {
        const Colour colour = pixel(picture_of(&mesh, params), 50, 50);
        EXPECT_GT(colour[0], colour[2]);
    }
}

}  // namespace
}  // namespace scanmill
