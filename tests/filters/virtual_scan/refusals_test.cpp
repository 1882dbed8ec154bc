// SPDX-License-Identifier: GPL-3.0-or-later
/// The refusals of virtual-scan.
#include <gmock/gmock.h>

#include <limits>

#include "filters/virtual_scan/cases.hpp"
#include "scanmill/base/error.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const VirtualScanParams& params, const TriangleMesh* mesh = nullptr) {
    try {
        Context context;
        virtual_scan(mesh, params, context);
    } catch (const Error& error) {
        EXPECT_NE(error.hint(), "") << error.sentence();
        return error.what();
    }
    return "no refusal";
}

TEST(VirtualScanRefusals, NeitherMeshNorShape) {
    EXPECT_THAT(refusal(VirtualScanParams{}), HasSubstr("nothing to scan"));
}

TEST(VirtualScanRefusals, MeshAndShape) {
    const TriangleMesh mesh = cube();
    EXPECT_THAT(refusal(sphere(0.1), &mesh), HasSubstr("only one is possible"));
}

TEST(VirtualScanRefusals, MeshWithoutTriangles) {
    TriangleMesh mesh;
    EXPECT_THAT(refusal({}, &mesh), HasSubstr("no triangles"));
}

TEST(VirtualScanRefusals, MeshWithoutExtent) {
    TriangleMesh mesh = cube();
    mesh.positions = Array<Vec3>(8, Vec3(1, 2, 3));
    EXPECT_THAT(refusal({}, &mesh), HasSubstr("no extent: all 12 triangles are one point"));
    mesh.triangles = {{0, 1, 2}};
    EXPECT_THAT(refusal({}, &mesh), HasSubstr("no extent: its only triangle is one point"));
}

TEST(VirtualScanRefusals, MeshOfSliversOnly) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_THAT(refusal({}, &mesh), HasSubstr("none of"));
}

TEST(VirtualScanRefusals, MeshWithANaN) {
    TriangleMesh mesh = cube();
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    positions[3].y() = std::numeric_limits<double>::quiet_NaN();
    mesh.positions = std::move(positions);
    EXPECT_THAT(refusal({}, &mesh), HasSubstr("vertices"));
}

TEST(VirtualScanRefusals, MeshWithAnIndexOutOfRange) {
    TriangleMesh mesh = cube();
    mesh.triangles = {{0, 1, 8}};
    Context context;
    EXPECT_EQ(sentence_of([&] { virtual_scan(&mesh, {}, context); }), "triangle 0 names vertex 8; there are 8");
}

TEST(VirtualScanRefusals, ResolutionNotAboveZero) {
    EXPECT_THAT(refusal(sphere(0)), HasSubstr("resolution is 0 u"));
    EXPECT_THAT(refusal(sphere(-1)), HasSubstr("resolution is -1 u"));
}

TEST(VirtualScanRefusals, TooManyRays_WithAResolutionThatFits) {
    const std::string text = refusal(sphere(1e-5));
    EXPECT_THAT(text, HasSubstr("12 views"));
    EXPECT_THAT(text, HasSubstr("at most 268435456"));
    EXPECT_THAT(text, HasSubstr("hint: a resolution of 0.000"));
    VirtualScanParams params = sphere(1e-5);
    params.views = {1};
    EXPECT_THAT(refusal(params), HasSubstr("1 view at a resolution of 1e-05 u takes"));
}

TEST(VirtualScanRefusals, ParametersOutOfRange) {
    VirtualScanParams params = sphere(0.1);
    params.noise = -1;
    EXPECT_THAT(refusal(params), HasSubstr("noise is -1 u"));
    params = sphere(0.1);
    params.outliers = Ratio::percent(-1);
    EXPECT_THAT(refusal(params), HasSubstr("outliers is -1 %"));
    params = sphere(0.1);
    params.overlap = Ratio::percent(101);
    EXPECT_THAT(refusal(params), HasSubstr("overlap is 101 %"));
    params = sphere(0.1);
    params.max_angle = Angle::degrees(0);
    EXPECT_THAT(refusal(params), HasSubstr("max-angle is 0 deg"));
    params.max_angle = Angle::degrees(91);
    EXPECT_THAT(refusal(params), HasSubstr("at most 90 deg"));
}

TEST(VirtualScanRefusals, InvalidViews) {
    VirtualScanParams params = sphere(0.1);
    for (const std::vector<double>& views :
         {std::vector<double>{0}, {2.5}, {-3}, {1e9}, {std::numeric_limits<double>::quiet_NaN()}}) {
        params.views = views;
        EXPECT_THAT(refusal(params), HasSubstr("a single number must be a whole number"));
    }
    params.views = {1, 2};
    EXPECT_THAT(refusal(params), HasSubstr("views has 2 numbers"));
    params.views = {};
    EXPECT_THAT(refusal(params), HasSubstr("views has 0 numbers"));
    params.views = {1, 0, 0, 0, 0, 0};
    EXPECT_THAT(refusal(params), HasSubstr("view 1 looks from (0 0 0)"));
}

TEST(VirtualScanRefusals, SizesThatFitNoShape) {
    VirtualScanParams params = sphere(0.1);
    params.size = {1.0, 2.0};
    EXPECT_THAT(refusal(params), HasSubstr("a sphere has 1 dimension (radius); size has 2"));
    params.size = {-1.0};
    EXPECT_THAT(refusal(params), HasSubstr("the radius of the sphere is -1 u"));
    params.shape = Shape::torus;
    params.size = {1.0, 1.0};
    EXPECT_THAT(refusal(params), HasSubstr("leaves no hole"));
}

TEST(VirtualScanRefusals, SizesBeyondTheSupportedRange) {
    VirtualScanParams params = sphere(0.1);
    params.resolution = Length::percent_of_diagonal(5);
    for (const double extreme : {1.01e9, 0.99e-9}) {
        params.shape = Shape::hyperboloid;
        params.size = {1.0, extreme};
        EXPECT_THAT(refusal(params), HasSubstr(fmt::format("the height of the hyperboloid is {:.3g} u", extreme)));
        params.size = {extreme, 1.0};
        EXPECT_THAT(refusal(params), HasSubstr("1e-09 to 1e+09 u is supported"));
        params.shape = Shape::torus;
        params.size = {2 * extreme, extreme};
        EXPECT_THAT(refusal(params), HasSubstr("of the torus is"));
    }
    params.size = {4e8, 2e8};
    EXPECT_THAT(refusal(params), HasSubstr("the longest side of the torus is 1.2e+09 u; at most 1e+09 u is supported"));
}

TEST(VirtualScanRefusals, NoiseAndResolutionBeyondTheSupportedRange) {
    EXPECT_THAT(refusal(sphere(1.01e9)), HasSubstr("the resolution is 1.01e+09 u; at most 1e+09 u is supported"));
    VirtualScanParams params = sphere(0.1);
    params.noise = 1.01e9;
    EXPECT_THAT(refusal(params),
                AllOf(HasSubstr("the noise is 1.01e+09 u; at most 1e+09 u is supported"), HasSubstr("%diag")));
    const TriangleMesh mesh = cube();
    params.shape = Shape::none;
    EXPECT_THAT(refusal(params, &mesh), HasSubstr("the noise is"));
}

/// Powers of two, so that nothing is rounded otherwise.
TEST(VirtualScanRefusals, SizesNearTheLimits_GiveThePointsOfAnyOther) {
    for (const auto& [shape, second] : {std::pair(Shape::hyperboloid, 0.75), std::pair(Shape::torus, 0.4)})
        for (const double unit : {0x1p-28, 0x1p28}) {
            VirtualScanParams params = sphere(0.1);
            params.shape = shape;
            params.size = {1.0, second};
            Context context;
            const Buffer<Vec3> plain = virtual_scan(nullptr, params, context).points.positions;
            params.resolution = 0.1 * unit;
            params.size = {unit, second * unit};
            const Buffer<Vec3> scaled = virtual_scan(nullptr, params, context).points.positions;
            ASSERT_GT(plain.size(), 500u);
            ASSERT_EQ(scaled.size(), plain.size());
            for (std::size_t i = 0; i < plain.size(); ++i) ASSERT_EQ(scaled[i], Vec3(unit * plain[i]));
        }
    VirtualScanParams params = sphere(0.1);
    params.shape = Shape::hyperboloid;
    params.resolution = Length::percent_of_diagonal(2);
    params.size = {4e8, 1e-9};
    Context context;
    EXPECT_NO_THROW(require_finite(virtual_scan(nullptr, params, context).points.positions.span(), "points"));
    params.size = {1e-9, 4e8};
    EXPECT_THAT(refusal(params), HasSubstr("none of 968 rays")) << "a line, between the rays";
}

TEST(VirtualScanRefusals, MeshesNearTheLimits_GiveThePointsOfAnyOther) {
    const TriangleMesh plain_mesh = cube();
    VirtualScanParams params;
    params.resolution = Length::percent_of_diagonal(5);
    Context context;
    const Buffer<Vec3> plain = virtual_scan(&plain_mesh, params, context).points.positions;
    ASSERT_GT(plain.size(), 500u);
    for (const double unit : {0x1p-29, 0x1p29}) {
        const TriangleMesh mesh = cube(unit);
        const Buffer<Vec3> scaled = virtual_scan(&mesh, params, context).points.positions;
        ASSERT_EQ(scaled.size(), plain.size());
        for (std::size_t i = 0; i < plain.size(); ++i) ASSERT_EQ(scaled[i], Vec3(unit * plain[i]));
    }
}

TEST(VirtualScanRefusals, SizesRelativeToTheShape) {
    VirtualScanParams params = sphere(0.1);
    for (const Length size : {Length::percent_of_diagonal(5), Length::spacings(5), Length(5, Length::In::millimetre)}) {
        params.size = {size};
        EXPECT_THAT(refusal(params),
                    AllOf(HasSubstr("the radius of the sphere is " + size.text() + "; a shape has no unit"),
                          HasSubstr("in the scan's own unit, as 5 u")));
    }
}

TEST(VirtualScanRefusals, SpacingOfAShape) {
    VirtualScanParams params = sphere(0.1);
    params.resolution = Length::spacings(1);
    EXPECT_THAT(refusal(params), HasSubstr("cannot be resolved"));
}

}  // namespace
}  // namespace scanmill::test
