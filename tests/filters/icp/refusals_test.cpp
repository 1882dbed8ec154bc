// SPDX-License-Identifier: GPL-3.0-or-later
/// What icp refuses, with numbers and a way out.

#include <gmock/gmock.h>

#include <limits>

#include "filters/icp/cases.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class Target>
Error refusal(const PointCloud& source, const Target& target, const IcpParams& params = {}) {
    const Error error = error_of([&] { refined(source, target, params); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error;
}

std::vector<Vec3> far_away(std::vector<Vec3> points, double z) {
    for (Vec3& p : points) p.z() += z;
    return points;
}

TEST(IcpRefusals, FewerThanSixPoints_AreCounted) {
    std::vector<Vec3> five = corner_points();
    five.resize(5);
    EXPECT_THAT(refusal(cloud(five), room_corner(10)).sentence(), HasSubstr("5 points; a motion needs at least 6"));
    EXPECT_THAT(refusal(cloud({}), room_corner(10)).sentence(), HasSubstr("0 points"));
    EXPECT_THAT(refusal(cloud({}), room_corner(10)).frames(), ElementsAre("at 'source'"));
}

TEST(IcpRefusals, CoordinatesThatAreNotNumbers_AreRefused) {
    std::vector<Vec3> bad = corner_points();
    bad[3].y() = nan;
    EXPECT_THAT(refusal(cloud(bad), room_corner(10)).frames(), ElementsAre("at 'source'"));
    EXPECT_THAT(refusal(cloud(corner_points()), cloud(bad)).frames(), ElementsAre("at 'target'"));
    const TriangleMesh mesh =
        with_positions(room_corner(10), [](const Vec3& p) -> Vec3 { return p.x() > 5 ? Vec3(nan, 0, 0) : p; });
    EXPECT_THAT(refusal(cloud(corner_points()), mesh).frames(), ElementsAre("at 'target'"));
}

TEST(IcpRefusals, DifferentUnits_AreRefused) {
    PointCloud source = cloud(corner_points(), "scanner");
    source.frame.unit = LengthUnit::millimetre;
    TriangleMesh target = room_corner(10);
    target.frame.unit = LengthUnit::inch;
    target.frame.name = "machine";
    EXPECT_EQ(refusal(source, target).sentence(), "the source is in mm, the target in in; both need one unit");
}

TEST(IcpRefusals, AMeshWithoutTriangles_OrWithoutArea) {
    EXPECT_THAT(refusal(cloud(corner_points()), TriangleMesh()).sentence(), HasSubstr("no triangles"));
    const TriangleMesh flat = soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 2, 3}});
    EXPECT_EQ(refusal(cloud(corner_points()), flat).sentence(), "2 triangles of the target have no area");
}

TEST(IcpRefusals, ATargetOfAFewPoints_IsRefused) {
    EXPECT_THAT(refusal(cloud(corner_points()), cloud({})).sentence(), HasSubstr("0 points"));
    EXPECT_THAT(refusal(cloud(corner_points()), cloud({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}})).sentence(),
                HasSubstr("2 different positions; planes need at least 6"));
}

TEST(IcpRefusals, PointsAtOnePosition_AreRefused) {
    EXPECT_EQ(refusal(cloud(std::vector<Vec3>(7, Vec3(1, 1, 0))), room_corner(10)).sentence(),
              "all 7 points of the source are at one position");
}

TEST(IcpRefusals, ParametersOutOfRange_AreRefused) {
    const auto sentence = [](const IcpParams& params) {
        return refusal(cloud(corner_points()), room_corner(10), params).sentence();
    };
    EXPECT_EQ(sentence(within(0)), "`max-distance` is 0 u; it must be finite and above 0");
    EXPECT_THAT(sentence(within(nan)), HasSubstr("`max-distance` is nan u"));
    IcpParams params;
    params.trim = Ratio::percent(100);
    EXPECT_EQ(sentence(params), "`trim` is 100 %; it must be at least 0 and below 100 %");
    params = {};
    params.max_iterations = 0;
    EXPECT_EQ(sentence(params), "`max-iterations` is 0; at least 1 is needed");
}

TEST(IcpRefusals, AScanFarAway_IsSentToAlign) {
    // From (2, 2, 50) to the upper edge of a wall at (2, 0, 10): sqrt(40² + 2²).
    const Error error = refusal(cloud(far_away(corner_points(), 50)), room_corner(10), within(2));
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("only 0 of 147 points"), HasSubstr("`max-distance`, 2 u"),
                                        HasSubstr("at least 8 are needed"), HasSubstr("nearest point is 40.05 u")));
    EXPECT_THAT(error.hint(), AllOf(HasSubstr("`align`"), HasSubstr("`max-distance`")));
    EXPECT_THAT(error.hint(), testing::Not(HasSubstr("unit")));
}

TEST(IcpRefusals, AWrongUnit_IsNamedByItsFactor) {
    for (const auto& [factor, text] : {std::pair(25.4, "about 25.4"), std::pair(1e-3, "about 1/1000"),
                                       std::pair(10.0, "about 10"), std::pair(1000.0, "about 1000")}) {
        Random random(1);
        const PointCloud source = cloud(far_away(scan_of(l_block(40), 1000, 0, random).points, 7));
        const Error error = refusal(source, shifted(scaled(l_block(40), factor), Vec3(-300, -300, -300)));
        EXPECT_THAT(error.hint(), AllOf(HasSubstr(text), HasSubstr("unit"))) << factor;
    }
}

TEST(IcpRefusals, PointsBesideTheTargetOnly_AreCountedAtItsBoundary) {
    std::vector<Vec3> points;
    for (int i = 0; i < 10; ++i) points.emplace_back(-0.5, i + 0.25, 0.1 * i);
    EXPECT_THAT(refusal(cloud(points), square(10), within(1)).sentence(),
                AllOf(HasSubstr("only 0 of 10"), HasSubstr("points are nearest to its boundary")));
}

TEST(IcpRefusals, AnOverlapThatVanishes_IsRefused) {
    // 54 of 1000 points are near at the beginning, but only 48 of them fit; the others are on both sides of the planes.
    std::vector<Vec3> points;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 18; ++i) {
            Vec3 p;
            p[axis] = i < 16 ? 0 : i == 16 ? 0.5 : -0.5;
            p[(axis + 1) % 3] = i < 16 ? 2 + i % 4 * 2 : 5;
            p[(axis + 2) % 3] = i < 16 ? 2 + i / 4 * 2 : 5;
            points.push_back(p);
        }
    while (points.size() < 1000) points.emplace_back(100 + points.size() % 30, 100 + points.size() % 7, 100);
    const Error error = refusal(cloud(points), room_corner(10), within(1));
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("only 48 of 1000 points"), HasSubstr("at least 50 are needed"),
                                        HasSubstr("iterations")));
}

TEST(IcpRefusals, PointsOnALine_DoNotDetermineAMotion) {
    std::vector<Vec3> line;
    for (int i = 0; i < 20; ++i) line.emplace_back(1 + 0.4 * i, 5, 0.01);
    EXPECT_EQ(refusal(cloud(line), square(10), within(1)).sentence(),
              "the pairs determine only 2 of 6 directions of motion; a plane or a sphere determines 3");
}

}  // namespace
}  // namespace scanmill::test
