// SPDX-License-Identifier: GPL-3.0-or-later
/// Points, lines, dots, labels, legends and marks on meshes.

#include <gmock/gmock.h>

#include "filters/render/cases.hpp"
#include "render/legend.hpp"
#include "render/scene.hpp"
#include "support/numbers.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

bool is_near(const Colour& colour, const Colour& wanted) { return difference(colour, wanted) < 60; }
constexpr Colour vermillion = {213, 94, 0}, blue = {0, 114, 178}, green = {0, 158, 115}, magenta = {200, 30, 140};

PointCloud grid(std::size_t side) {
    PointCloud cloud;
    Array<Vec3> positions;
    for (std::size_t i = 0; i < side; ++i)
        for (std::size_t j = 0; j < side; ++j)
            positions.push_back({double(i) / double(side - 1), double(j) / double(side - 1), 0});
    cloud.positions = std::move(positions);
    return cloud;
}

TEST(RenderPoints, Grid_HasNoGaps) {
    const PointCloud cloud = grid(40);
    const Picture picture = picture_of(&cloud, from_above());
    for (u32 y = 15; y < 185; ++y)
        for (u32 x = 15; x < 185; ++x) ASSERT_FALSE(is_white(pixel(picture, x, y))) << x << " " << y;
}

TEST(RenderPoints, OnePoint_IsDrawn) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>{{5, 5, 5}};
    const Picture picture = picture_of(&cloud, from_above());
    EXPECT_FALSE(is_white(pixel(picture, 100, 100)));
    cloud.positions = Array<Vec3>{{5, 5, 5}, {5, 5, 5}};
    EXPECT_FALSE(is_white(pixel(picture_of(&cloud, from_above()), 100, 100)));
}

TEST(RenderPoints, PointsAtOnePosition_ShowTheFirst) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(5000, Vec3(1, 2, 3));
    Array<double> values(5000, 1.0);
    values[0] = -1;
    cloud.columns.add(Column("d", 1, Buffer<double>(std::move(values))));
    RenderParams params = from_above();
    params.colour = "d";
    params.scale = {{Length(-1), Length(1)}};
    EXPECT_LE(difference(pixel(picture_of(&cloud, params), 100, 100), colour_of({-1, 1}, -1)), 8);
}

TEST(RenderPoints, PlaneOfPoints_HasTheLightOfAPlane) {
    // Normals come from the depths around a pixel: a plane of points looks like the plane.
    const PointCloud cloud = grid(40);
    const TriangleMesh plane = centred_square(1);
    const Colour points = pixel(picture_of(&cloud, from_above()), 100, 100),
                 mesh = pixel(picture_of(&plane, from_above()), 100, 100);
    EXPECT_LE(difference(points, mesh), 4);
}

TEST(RenderPoints, NormalsOfPoints_ShowTheirBack) {
    PointCloud cloud = grid(20);
    Array<double> normals;
    for (std::size_t i = 0; i < cloud.size(); ++i) normals.insert(normals.end(), {0, 0, -1});
    cloud.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
    const Colour colour = pixel(picture_of(&cloud, from_above()), 100, 100);
    EXPECT_LT(colour[0], colour[2]) << "blue-grey";
}

TEST(RenderLines, Features_HaveTheColoursOfTheirTypes) {
    FeatureGraph graph;
    graph.positions = Array<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}, {1, 0.5, 0}, {0, 1, 0}, {1, 1, 0}};
    graph.vertices = Array<u32>{0, 1, 2, 3, 4, 5};
    graph.left_normals = graph.right_normals = Array<Vec3>(6, Vec3::UnitZ());
    graph.polylines = {{FeatureType::outer_boundary, false, 0, 2},
                       {FeatureType::crease, false, 2, 4},
                       {FeatureType::hole, false, 4, 6}};
    graph.corners = Array<u32>{3};
    const Picture picture = picture_of(&graph, from_above());
    const auto has = [&](u32 y, const Colour& wanted) {
        return is_tinted(pixel(picture, 100, y), wanted) || is_tinted(pixel(picture, 100, y - 1), wanted);
    };
    EXPECT_TRUE(has(190, blue));
    EXPECT_TRUE(has(100, {30, 30, 30}));
    EXPECT_TRUE(has(10, vermillion));
    EXPECT_LT(brightness(pixel(picture, 189, 101)), 120) << "the corner is a dot";
    EXPECT_TRUE(is_white(pixel(picture, 100, 50)));
}

TEST(RenderLines, LineOnAPlateInPerspective_IsSeenAlongItsWholeLength) {
    const TriangleMesh plate = centred_square(10);
    FeatureGraph line;
    line.positions = Array<Vec3>{{0, -4.9, 0}, {0, 4.9, 0}, {0, -40, 0}};
    line.vertices = Array<u32>{0, 1, 2, 1};
    line.left_normals = line.right_normals = Array<Vec3>(4, Vec3::UnitZ());
    line.polylines = {{FeatureType::crease, false, 0, 2}};
    RenderParams params;
    params.size = {200, 200};
    params.eye = {{Length(0), Length(-8), Length(3)}};
    params.look_at = {{Length(0), Length(0), Length(0)}};
    const auto dark_rows = [&](const Picture& picture) {
        std::size_t rows = 0;
        for (u32 y = 0; y < 200; ++y) rows += brightness(pixel(picture, 100, y)) < 150;
        return rows;
    };
    const Picture without = picture_of(&plate, params), with = picture_of(&plate, params, 2, &line);
    std::size_t plate_rows = 0;
    for (u32 y = 0; y < 200; ++y) plate_rows += !is_white(pixel(without, 100, y));
    EXPECT_EQ(dark_rows(without), 0u);
    EXPECT_GE(dark_rows(with) + 8, plate_rows);
    line.polylines = {{FeatureType::crease, false, 2, 4}};  // begins behind the eye
    EXPECT_GE(dark_rows(picture_of(&plate, params, 2, &line)) + 3, plate_rows);
}

TEST(RenderLines, WhatLiesFarBeforeTheTruth_IsNotCutOff) {
    const TriangleMesh nominal = centred_square(1), clamp = centred_square(0.5, 40);
    const TriangleMesh scan = both(nominal, clamp);
    const Picture picture = picture_of(&scan, from_above(), 2, {}, &nominal),
                  plain = picture_of(&nominal, from_above());
    EXPECT_FALSE(picture == plain);
    EXPECT_LT(brightness(pixel(picture, 54, 100)), brightness(pixel(plain, 54, 100)) + 1);
}

TEST(RenderLines, Probes_ShowTouchesAndApproaches) {
    const TriangleMesh plate = centred_square(2);
    ProbePlan plan;
    ProbeTouch made;
    made.position = {0, 0, 0};
    made.start = {0.8, 0, 0.5};
    made.approach = Vec3::UnitX();
    ProbeTouch not_made;
    not_made.position = {0, -0.8, 0};
    not_made.reason = ProbeReason::concave;
    plan.touches = {made, not_made};
    const Picture picture = picture_of(&plate, from_above(), 2, &plan);
    EXPECT_TRUE(is_near(pixel(picture, 100, 100), green));
    EXPECT_LT(pixel(picture, 140, 100)[0] + 30, pixel(picture, 140, 60)[0]) << "a blue line on clay has less red";
    EXPECT_TRUE(is_near(pixel(picture, 100, 172), vermillion));
}

TEST(RenderMarks, Boundaries_OnlyOfOpenMeshes) {
    const TriangleMesh closed = cube(1), open = without_triangles(closed, {0, 1});
    RenderParams params;
    params.size = {200, 200};
    params.boundaries = true;
    const auto orange = [](const Colour& c) { return is_near(c, vermillion); };
    EXPECT_EQ(count_pixels(picture_of(&closed, params), orange), 0u);
    std::size_t seen = 0;
    for (const CameraView view : {CameraView::top, CameraView::front, CameraView::left, CameraView::back})
        params.camera = {view}, seen += count_pixels(picture_of(&open, params), orange);
    EXPECT_GT(seen, 100u);
}

TEST(RenderMarks, Creases_AreTheDeclaredOnesOrThoseByAngle) {
    TriangleMesh box = cube(1);
    RenderParams params = from_above();
    params.camera = {CameraView::automatic};
    const auto dark = [](const Colour& c) { return brightness(c) < 80; };
    EXPECT_EQ(count_pixels(picture_of(&box, params), dark), 0u);
    params.creases = true;
    const std::size_t by_angle = count_pixels(picture_of(&box, params), dark);
    EXPECT_GT(by_angle, 300u);
    box.sharp_edges = Array<Edge>{{0, 1}};
    EXPECT_LT(count_pixels(picture_of(&box, params), dark), by_angle / 2);
}

TEST(RenderMarks, Intersections_AreMagentaAndCounted) {
    const TriangleMesh one = centred_square(2), other = turned(centred_square(2), 90 * degree, Vec3::UnitX());
    const TriangleMesh crossing = both(one, other);  // along the x axis
    RenderParams params = from_above();
    params.intersections = true;
    const Picture picture = picture_of(&crossing, params);
    EXPECT_GT(count_pixels(picture, [](const Colour& c) { return is_near(c, magenta); }), 5000u);
    EXPECT_THAT(picture.caption, HasSubstr("intersections"));
    EXPECT_EQ(count_pixels(picture_of(&one, params), [](const Colour& c) { return is_near(c, magenta); }), 0u);
}

TEST(RenderMarks, Edges_DrawTheDiagonalOfASquare) {
    const TriangleMesh square = centred_square(2);
    RenderParams params = from_above();
    const double plain = brightness(pixel(picture_of(&square, params), 100, 100));
    params.edges = true;
    const Picture picture = picture_of(&square, params);
    const bool rising =
        brightness(pixel(picture, 100, 99)) < plain - 30 || brightness(pixel(picture, 100, 100)) < plain - 30;
    EXPECT_TRUE(rising);
    EXPECT_EQ(brightness(pixel(picture, 60, 100)), plain);
}

TEST(RenderStyle, Lines_AreBandsOnACurvedSurfaceAndNoneOnAPlane) {
    RenderParams params = from_above();
    params.style = RenderParams::Style::lines;
    const auto is_dark = [](const Colour& c) { return brightness(c) < 100; };
    const TriangleMesh sphere = geodesic_sphere(1, 20), plane = centred_square(2);
    const Picture round = picture_of(&sphere, params);
    int changes = 0;
    for (u32 y = 11; y < 189; ++y) changes += is_dark(pixel(round, 100, y)) != is_dark(pixel(round, 100, y + 1));
    EXPECT_GE(changes, 12);
    const std::size_t dark = count_pixels(picture_of(&plane, params), is_dark);
    EXPECT_TRUE(dark == 0 || dark >= 180u * 180u);
}

TEST(RenderLabels, LabelledPoints_ShowTheValueOfTheColouredColumn) {
    TriangleMesh square = square_with("deviation", {-0.4123, 0.2, 0, 0}, 1);
    square.vertex_columns.add(Column("label", 1, Buffer<u32>(Array<u32>{1, 2, 0, 0})));
    RenderParams params;
    params.colour = "deviation";
    Context context;
    const DrawnScene scene = make_scene({&square, {}, {}}, params, context);
    ASSERT_EQ(scene.dots.size(), 2u);
    EXPECT_EQ(scene.dots[0].label, "-0.412");
    EXPECT_EQ(scene.dots[1].label, "+0.2");
    params.colour.reset();
    EXPECT_EQ(make_scene({&square, {}, {}}, params, context).dots[1].label, "2");
}

TEST(RenderLabels, PointInADentBelowTheSurface_IsLabelled) {
    const TriangleMesh square = centred_square(2);
    PointCloud cloud;
    cloud.positions = Array<Vec3>{{0, 0, -0.02}};
    cloud.columns.add(Column("label", 1, Buffer<u32>(Array<u32>{1})));
    const Picture with = picture_of(&square, from_above(), 2, &cloud), without = picture_of(&square, from_above());
    EXPECT_LT(brightness(pixel(with, 100, 100)), 60);
    EXPECT_GT(count_pixels(with, [](const Colour& c) { return brightness(c) < 100; }),
              count_pixels(without, [](const Colour& c) { return brightness(c) < 100; }) + 20);
}

TEST(RenderLabels, PointsOver_OnlyLabelledOnesIfThereAreLabels) {
    const TriangleMesh square = centred_square(2);
    PointCloud cloud;
    cloud.positions = Array<Vec3>{{0, 0, 0}, {0.5, 0.5, 0}, {-0.5, 0, 0}};
    Context context;
    EXPECT_EQ(make_scene({&square, &cloud, {}}, {}, context).dots.size(), 3u);
    cloud.columns.add(Column("label", 1, Buffer<u32>(Array<u32>{0, 3, 0})));
    EXPECT_EQ(make_scene({&square, &cloud, {}}, {}, context).dots.size(), 1u);
}

TEST(RenderLegend, SignedLengths_HaveNumbersAndWords) {
    const TriangleMesh square = square_with("deviation", {-0.1, 0.3, nan, 0}, 1);
    RenderParams params;
    params.colour = "deviation";
    params.scale = {{Length(-0.05), Length(0.1)}};
    Context context;
    const Legend legend = legend_of(*make_scene({&square, {}, {}}, params, context).column);
    EXPECT_EQ(legend.title, "deviation [u]");
    EXPECT_EQ(legend.upper_word, "outside");
    EXPECT_EQ(legend.lower_word, "inside");
    EXPECT_TRUE(legend.shows_no_data);
    std::vector<std::string> texts;
    for (const LegendTick& tick : legend.ticks) texts.push_back(tick.text);
    EXPECT_THAT(texts, ElementsAre("-0.05", "-0.025", "0", "+0.05", "+0.1"));
    EXPECT_DOUBLE_EQ(legend.ticks[2].place, 1.0 / 3);
}

TEST(RenderLegend, Tolerance_IsMarkedOnWhicheverSideItIs) {
    const TriangleMesh square = square_with("deviation", {-0.1, 0.3, 0.1, 0}, 1);
    RenderParams params;
    params.colour = "deviation";
    const auto texts = [&](double low, double high) {
        params.tolerance = {{Length(low), Length(high)}};
        Context context;
        std::vector<std::string> found;
        for (const LegendTick& tick : legend_of(*make_scene({&square, {}, {}}, params, context).column).ticks)
            found.push_back(tick.text);
        return found;
    };
    EXPECT_THAT(texts(-0.1, 0.1), ElementsAre("-0.2", "-0.1", "0", "+0.1", "+0.2"));
    EXPECT_THAT(texts(0.1, 0.3), ElementsAre("-0.6", "0", "+0.1", "+0.3", "+0.6"));
    EXPECT_THAT(texts(-0.2, -0.1), ElementsAre("-0.4", "-0.2", "-0.1", "0", "+0.4"));
}

TEST(RenderLegend, UnsignedNumbers_HaveNoWords) {
    const TriangleMesh square = square_with("group", {0, 1, 2, 4});
    RenderParams params;
    params.colour = "group";
    Context context;
    const Legend legend = legend_of(*make_scene({&square, {}, {}}, params, context).column);
    EXPECT_EQ(legend.title, "group");
    EXPECT_EQ(legend.upper_word, "");
    EXPECT_EQ(legend.ticks.front().text, "0");
    EXPECT_EQ(legend.ticks[1].text, "2");
    EXPECT_EQ(legend.ticks.back().text, "4");
}

TEST(RenderLegend, Bar_HasTheColoursOfTheScaleAndTheTextsInk) {
    const TriangleMesh square = square_with("deviation", {-1, 1, 1, -1}, 1);
    RenderParams params;
    params.size = {400, 300};
    params.colour = "deviation";
    const Picture picture = picture_of(&square, params);
    params.legend = false;
    const Picture without = picture_of(&square, params);
    EXPECT_FALSE(picture == without);
    const auto shows = [&](double value) {  // the bar is beside the scene
        for (u32 y = 0; y < 300; ++y)
            for (u32 x = 300; x < 400; ++x)
                if (difference(pixel(picture, x, y), colour_of({-1, 1}, value)) <= 3) return true;
        return false;
    };
    EXPECT_TRUE(is_near(pixel(picture, 399, 0), {255, 255, 255}));
    std::size_t ink = 0;
    for (u32 y = 0; y < 300; ++y)
        for (u32 x = 300; x < 400; ++x) ink += brightness(pixel(picture, x, y)) < 60;
    EXPECT_GT(ink, 100u) << "numbers and words";
    for (const double value : {-0.99, -0.5, -0.25, 0.25, 0.5, 0.99}) EXPECT_TRUE(shows(value)) << value;
}

TEST(RenderLegend, ScaleTexts_HaveFourDigits) {
    EXPECT_EQ(scale_text(0.0125, true), "+0.0125");
    EXPECT_EQ(scale_text(-0.05, true), "-0.05");
    EXPECT_EQ(scale_text(-0.025, true), "-0.025");
    EXPECT_EQ(scale_text(1234.5, false), "1234");
    EXPECT_EQ(scale_text(-1e-14, true), "-1e-14");
    EXPECT_EQ(scale_text(-0.0, true), "0");
    EXPECT_EQ(scale_text(3, false), "3");
}

TEST(RenderScale, OneSign_KeepsToOneHalf) {
    TriangleMesh square = square_with("d", {1, 2, 3, 2});
    RenderParams params = from_above();
    params.colour = "d";
    params.scale = {{Length(1.5), Length(2.5)}};
    const Picture picture = picture_of(&square, params);
    const ColourScale scale{1.5, 2.5};
    EXPECT_LE(difference(pixel(picture, 12, 187), colour_of(scale, 1.5)), 2) << "1 has the colour of the lower end";
    EXPECT_LE(difference(pixel(picture, 187, 12), colour_of(scale, 2.5)), 2);
}

TEST(RenderScale, Automatic_LeavesOutAHundredthAndIsSymmetrical) {
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<double> values;
    for (int i = 0; i < 1000; ++i) {
        positions.push_back({double(i), double(i % 7), 0});
        values.push_back(i == 0 ? -1e9 : i == 999 ? 1e9 : i * 0.001 - 0.2);
    }
    mesh.positions = std::move(positions);
    mesh.triangles = Array<Triangle>{{0, 1, 2}};
    mesh.vertex_columns.add(Column("d", 1, Buffer<double>(std::move(values))));
    RenderParams params;
    params.colour = "d";
    Context context;
    const ColourScale scale = make_scene({&mesh, {}, {}}, params, context).column->scale;
    EXPECT_DOUBLE_EQ(scale.high, 989 * 0.001 - 0.2);
    EXPECT_DOUBLE_EQ(scale.low, -scale.high);
}

}  // namespace
}  // namespace scanmill
