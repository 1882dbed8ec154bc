// SPDX-License-Identifier: GPL-3.0-or-later
/// What crop refuses, with numbers and a way out.

#include <gmock/gmock.h>

#include <limits>

#include "filters/crop/cases.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

template <class... Near>
Error refusal(const PointCloud& cloud, const CropParams& params, const Near&... near) {
    const Error error = error_of([&] { cropped(cloud, params, 1, near...); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error;
}

PointCloud two() { return cloud_of({{0, 0, 0}, {4, 0, 0}}); }

TEST(CropRefusals, NoRegion_IsRefused) {
    const Error error = refusal(two(), {});
    EXPECT_EQ(error.sentence(), "no region is given; 1 of 3 is needed");
    EXPECT_EQ(error.hint(), "give `box`, `centre` with `radius`, or `within` with a value at `near`");
}

TEST(CropRefusals, SeveralRegions_AreNamed) {
    CropParams params = in_box({0, 0, 0}, {1, 1, 1});
    params.within = 1;
    EXPECT_EQ(refusal(two(), params, cube()).sentence(), "2 regions are given, `box` and `within`; only 1 is possible");
    params.radius = 1;
    EXPECT_EQ(refusal(two(), params).sentence(),
              "3 regions are given, `box`, `centre` with `radius` and `within`; only 1 is possible");
}

TEST(CropRefusals, HalfABall_IsRefused) {
    CropParams centre = in_ball({0, 0, 0}, 1), radius = centre;
    centre.radius.reset();
    radius.centre.reset();
    EXPECT_EQ(refusal(two(), centre).sentence(), "`centre` is given without `radius`; a ball needs both");
    EXPECT_EQ(refusal(two(), radius).sentence(), "`radius` is given without `centre`; a ball needs both");
}

TEST(CropRefusals, OtherNumbersOfLengths_AreRefused) {
    CropParams box, ball = in_ball({0, 0, 0}, 1);
    box.box = {1, 2, 3};
    ball.centre = {1};
    EXPECT_EQ(refusal(two(), box).sentence(), "`box` has 3 lengths; it needs 6");
    EXPECT_EQ(refusal(two(), ball).sentence(), "`centre` has 1 length; it needs 3");
}

TEST(CropRefusals, LowAboveHigh_IsRefusedWithItsAxis) {
    EXPECT_EQ(refusal(two(), in_box({0, 3, 0}, {5, 2, 5})).sentence(),
              "the box's low corner is above its high corner along y: 3 and 2 u");
}

TEST(CropRefusals, LengthsThatAreNotNumbers_AreRefused) {
    for (const double value : {nan, infinity, -infinity}) {
        EXPECT_THAT(refusal(two(), in_box({0, 0, value}, {1, 1, 1})).sentence(), HasSubstr("a length of `box` is"));
        EXPECT_THAT(refusal(two(), in_ball({value, 0, 0}, 1)).sentence(), HasSubstr("a length of `centre` is"));
        EXPECT_THAT(refusal(two(), in_ball({0, 0, 0}, value)).sentence(), HasSubstr("`radius` is"));
        EXPECT_THAT(refusal(two(), in_reach(value), cube()).sentence(), HasSubstr("`within` is"));
    }
}

TEST(CropRefusals, NegativeDistances_AreRefused) {
    EXPECT_EQ(refusal(two(), in_ball({0, 0, 0}, -1)).sentence(), "`radius` is -1 u; it must be 0 or more");
    EXPECT_EQ(refusal(two(), in_reach(-1), cube()).sentence(), "`within` is -1 u; it must be 0 or more");
}

TEST(CropRefusals, ACloudWithoutPoints_IsRefused) {
    EXPECT_EQ(refusal({}, in_ball({0, 0, 0}, 1)).sentence(), "the cloud has 0 points; cropping needs at least 1");
    EXPECT_EQ(refusal({}, in_reach(1), cube()).sentence(), "the cloud has 0 points; cropping needs at least 1");
}

TEST(CropRefusals, CoordinatesThatAreNotNumbers_AreRefused) {
    for (const double value : {nan, infinity}) {
        const PointCloud bad = cloud_of({{0, 0, 0}, {0, value, 0}});
        TriangleMesh mesh = cube();
        Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
        positions[3].x() = value;
        mesh.positions = std::move(positions);
        for (const Error& error : {error_of([&] {
                                       cropped(bad, in_box({0, 0, 0}, {1, 1, 1}));
                                   }),
                                   error_of([&] { cropped(bad, in_reach(1), 1, cube()); }),
                                   error_of([&] { cropped(two(), in_reach(1), 1, bad); }),
                                   error_of([&] { cropped(two(), in_reach(1), 1, mesh); })})
            EXPECT_THAT(error.sentence(), HasSubstr("1 of ")) << error.sentence();
    }
}

TEST(CropRefusals, WithinWithoutNear_AndNearWithoutWithin) {
    const Error alone = refusal(two(), in_reach(2));
    EXPECT_EQ(alone.sentence(), "`within` is 2 u, but no points and no mesh are wired to `near`; it needs 1 of them");
    EXPECT_THAT(alone.hint(), HasSubstr("in: {points:"));
    EXPECT_EQ(refusal(two(), in_ball({0, 0, 0}, 1), two()).sentence(),
              "2 points are wired to `near`, but `within` is not given");
    EXPECT_EQ(refusal(two(), in_box({0, 0, 0}, {1, 1, 1}), cube()).sentence(),
              "8 vertices are wired to `near`, but `within` is not given");
}

TEST(CropRefusals, NearWithoutPointsOrTriangles_IsRefused) {
    EXPECT_EQ(refusal(two(), in_reach(1), PointCloud{}).sentence(),
              "the cloud at `near` has 0 points; a distance needs at least 1");
    TriangleMesh mesh = cube();
    mesh.triangles = {};
    EXPECT_EQ(refusal(two(), in_reach(1), mesh).sentence(),
              "the mesh at `near` has 8 vertices and 0 triangles; a distance needs at least 1");
}

TEST(CropRefusals, NearInAnotherUnit_IsRefused) {
    PointCloud cloud = two(), near = two();
    cloud.frame.unit = LengthUnit::millimetre;
    EXPECT_EQ(refusal(cloud, in_reach(1), near).sentence(),
              "the 2 points are in mm, and the 2 points or vertices at `near` in u; both need one unit");
    TriangleMesh mesh = cube();
    mesh.frame.unit = LengthUnit::metre;
    EXPECT_THAT(refusal(cloud, in_reach(1), mesh).sentence(), HasSubstr("at `near` in m;"));
    near.frame.unit = LengthUnit::millimetre;
    EXPECT_EQ(cropped(cloud, in_reach(1), 1, near).kept.size(), 2u);
}

TEST(CropRefusals, AnEmptyResult_NamesTheRegionTheNearestPointAndTheBox) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {4, 0, 1}});
    cloud.frame = {LengthUnit::millimetre, {100, 0, 0}, ""};
    EXPECT_EQ(refusal(cloud, in_box({0, 0, 0}, {97, 1, 1})).sentence(),
              "none of 2 points lies in the box from (0, 0, 0) to (97, 1, 1) mm; the nearest is at a distance of 3 mm, "
              "and the box of all points is (100, 0, 0) to (104, 0, 1)");
    EXPECT_EQ(refusal(cloud, in_ball({100, 3, 4}, 2)).sentence(),
              "none of 2 points lies within 2 mm of (100, 3, 4); the nearest is at a distance of 5 mm, and the box of "
              "all points is (100, 0, 0) to (104, 0, 1)");
    PointCloud near = cloud_of({{104, 0, 8}, {0, 0, 0}});
    near.frame.unit = LengthUnit::millimetre;
    EXPECT_EQ(refusal(cloud, in_reach(6), near).sentence(),
              "none of 2 points lies within 6 mm of the 2 points at `near`; the nearest is at a distance of 7 mm, and "
              "the box of all points is (100, 0, 0) to (104, 0, 1)");
    EXPECT_THAT(refusal(two(), in_box({5, 0, 0}, {6, 1, 1})).hint(), HasSubstr("coordinates of the file"));
}

}  // namespace
}  // namespace scanmill::test
