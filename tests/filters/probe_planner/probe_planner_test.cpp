// SPDX-License-Identifier: GPL-3.0-or-later
/// Touches on parts whose edges are known: directions, ranges, reasons.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "filters/probe_planner/cases.hpp"
#include "probe_planner/contact_range.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const TriangleMesh& fine_cube() {
    static const TriangleMesh mesh = box(Vec3::Zero(), Vec3::Constant(10), 5);
    return mesh;
}

void expect_sound(const ProbePlan& plan) {
    for (const ProbeTouch& touch : plan.touches) {
        EXPECT_NEAR(touch.tangent.dot(touch.left_normal), 0, 1e-12);
        EXPECT_NEAR(touch.tangent.dot(touch.right_normal), 0, 1e-12);
        if (touch.reason != ProbeReason::none) {
            EXPECT_EQ(touch.approach, Vec3::Zero());
            EXPECT_EQ(touch.start, touch.position);
            EXPECT_EQ(touch.order, ProbeTouch::no_order);
            continue;
        }
        EXPECT_NEAR(touch.approach.norm(), 1, 1e-12);
        EXPECT_NEAR(touch.approach.dot(touch.tangent), 0, 1e-12);
        EXPECT_NEAR((touch.centre - touch.position - plan.radius * touch.approach).norm(), 0, 1e-12 * plan.radius);
        EXPECT_NEAR((touch.start - touch.position).normalized().dot(touch.approach), 1, 1e-12);
        // phi is the angle from the bisector, positive towards the left normal.
        const Vec3 bisector = (touch.left_normal + touch.right_normal).normalized();
        const Vec3 across = touch.tangent.cross(bisector);
        EXPECT_NEAR(std::atan2(-touch.approach.dot(across), touch.approach.dot(bisector)), touch.phi, 1e-12);
    }
}

TEST(ProbePlanner, Cube_IsTouchedAlongTheBisectorsOfItsFaces) {
    const Planned result = planned(fine_cube(), probe_of(1, 0.1, 2.5));
    ASSERT_EQ(result.plan.touches.size(), 48u) << "four on each of twelve edges";
    expect_sound(result.plan);
    EXPECT_EQ(result.too_tilted, 16u) << "the edges below";
    EXPECT_EQ(result.unreachable, 16u);
    EXPECT_EQ(result.assumed, 0u);
    EXPECT_EQ(result.false_touches, 0u);
    EXPECT_EQ(result.wrong_contacts, 0u);
    for (const ProbeTouch& touch : result.plan.touches) {
        // Half a spacing from the ends: 1.25, 3.75, 6.25, 8.75 along the edge.
        const double along = std::abs(touch.tangent.dot(touch.position));
        EXPECT_NEAR(std::fmod(along, 2.5), 1.25, 1e-12);
        EXPECT_NEAR(touch.interior_angle, pi / 2, 1e-12);
        EXPECT_NEAR(touch.phi_max, std::acos(0.1) - pi / 4, 1e-12);
        const Vec3 outwards = (touch.left_normal + touch.right_normal).normalized();
        EXPECT_GT(outwards.dot(touch.position - Vec3::Constant(5)), 0);
        EXPECT_EQ(touch.reason != ProbeReason::none, outwards.z() < -0.1) << touch.position.transpose();
        if (touch.reason != ProbeReason::none) continue;
        EXPECT_EQ(touch.phi, 0);
        EXPECT_NEAR((touch.approach - outwards).norm(), 0, 1e-12);
        EXPECT_EQ(touch.contact, ProbeContact::edge);
        EXPECT_NEAR(touch.contact_distance, 0, 1e-6);
        EXPECT_NEAR((touch.start - touch.position).norm(), 4 * 1 + 0.1 + 1, 1e-12);
    }
    const auto value = [&](const char* name) { return result.metrics.find(name)->value; };
    EXPECT_EQ(value("touches"), 48);
    EXPECT_EQ(value("too-tilted"), 16);
    EXPECT_EQ(value("unreachable"), 16);
    EXPECT_EQ(value("travel"), result.travel);
    for (const char* name : {"assumed", "too-narrow", "concave", "obstructed", "false-touches", "wrong-contacts",
                             "paired-lines", "edge-roughness"})
        EXPECT_EQ(value(name), 0) << name;
    EXPECT_THAT(result.warnings, IsEmpty());
    EXPECT_THAT(result.doubts, IsEmpty());
}

TEST(ProbePlanner, OtherAxis_ReachesOtherEdges) {
    ProbePlannerParams params = probe_of(1, 0.1, 2.5);
    params.machine_axis = {-3, 0, 0};
    const Planned result = planned(fine_cube(), params);
    EXPECT_EQ(result.plan.machine_axis, Vec3(-1, 0, 0));
    for (const ProbeTouch& touch : result.plan.touches)
        EXPECT_EQ(touch.reason == ProbeReason::too_tilted, (touch.left_normal + touch.right_normal).x() > 0.1);
    params.max_tilt = Angle::degrees(40);
    for (const ProbeTouch& touch : planned(fine_cube(), params).plan.touches) {
        const bool is_top = (touch.left_normal + touch.right_normal).x() < -0.1;
        EXPECT_EQ(touch.reason, is_top ? ProbeReason::none : ProbeReason::too_tilted);
        if (!is_top) continue;
        // 45 degrees along the bisector: leans towards the top by 5.
        EXPECT_NEAR(std::abs(touch.phi) / degree, 5, 1e-9);
        EXPECT_GT(touch.approach.dot(Vec3(-1, 0, 0)), std::cos(40.001 * degree));
    }
}

TEST(ProbePlanner, FromBelow_IsPossibleWhereTheStylusPassesBesideThePart) {
    ProbePlannerParams params = probe_of(1, 0.1, 2.5);
    params.max_tilt = Angle::degrees(180);
    EXPECT_EQ(planned(fine_cube(), params).unreachable, 0u);
    params.stylus_radius = 0.8;  // the ball's centre is 0.71 beside the face
    const Planned thick = planned(fine_cube(), params);
    int from_below = 0;
    for (const ProbeTouch& touch : thick.plan.touches) {
        if (!((touch.left_normal + touch.right_normal).z() < -0.1) || touch.reason != ProbeReason::none) continue;
        ++from_below;
        EXPECT_GE(std::abs(touch.phi), 8 * degree);
    }
    EXPECT_EQ(from_below, 16);
    params.approach = Angle::degrees(0);
    EXPECT_EQ(planned(fine_cube(), params).obstructed, 16u);
}

TEST(ProbePlanner, ConcaveEdge_IsReported) {
    const TriangleMesh mesh = refined(l_block(10), 4);
    const Planned result = planned(mesh, probe_of(1, 0.1, 2.5));
    EXPECT_EQ(result.concave, 4u) << "one reflex edge of length 10";
    for (const ProbeTouch& touch : result.plan.touches)
        if (touch.reason == ProbeReason::concave) {
            EXPECT_NEAR(touch.interior_angle, 1.5 * pi, 1e-9);
            EXPECT_TRUE(std::isnan(touch.phi_max));
        }
}

TEST(ProbePlanner, WideWedge_IsTooNarrowForTheError) {
    // A prism over a triangle with angles of 150, 15 and 15 degrees at its side edges.
    TriangleMesh prism;
    const double rise = 10 * std::tan(15 * degree);
    prism.positions = {Vec3(-10, 0, 0),  Vec3(10, 0, 0),  Vec3(0, 0, rise),
                       Vec3(-10, 20, 0), Vec3(10, 20, 0), Vec3(0, 20, rise)};
    prism.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 1}, {1, 3, 4}, {1, 4, 2}, {2, 4, 5}, {2, 5, 0}, {0, 5, 3}};
    const TriangleMesh mesh = refined(prism, 4);
    const FeatureGraph features = lines_of(mesh, 20);
    const auto ridge_reason = [&](double error) {
        for (const ProbeTouch& touch : planned(features, mesh, probe_of(1, error, 30)).plan.touches)
            if (std::abs(touch.position.x()) < 1e-9 && touch.position.y() > 5 && touch.position.y() < 15)
                return touch.reason;
        return ProbeReason::obstructed;
    };
    // acos(error) must be 75 degrees at least: an error of 0.2588.
    EXPECT_EQ(ridge_reason(0.25), ProbeReason::none);
    EXPECT_EQ(ridge_reason(0.27), ProbeReason::too_narrow);
}

TEST(ProbePlanner, EdgesWithoutSafeDirections_NeedALargerBall) {
    // acos(error / radius) must be 45 degrees at least: a radius of 1.414 for an error of 1.
    const TriangleMesh mesh = box(Vec3::Zero(), Vec3::Constant(20), 3);
    ProbePlannerParams params = probe_of(1.3, 1, 10);
    params.max_tilt = Angle::degrees(180);
    const Planned narrow = planned(mesh, params);
    EXPECT_EQ(narrow.too_narrow, narrow.plan.touches.size());
    ASSERT_EQ(narrow.doubts.size(), 1u);
    EXPECT_THAT(narrow.doubts[0].text, AllOf(HasSubstr("larger ball"), Not(HasSubstr("smaller ball"))));
    params.radius = 2;
    EXPECT_LT(planned(mesh, params).unreachable, narrow.unreachable) << "the way out leads out";
}

TEST(ProbePlanner, TheWayOut_FollowsTheMostFrequentReason) {
    const auto touch = [](ProbeReason reason, double range = ProbeTouch::nan) {
        ProbeTouch made;
        made.reason = reason;
        made.phi_min = -range;
        made.phi_max = range;
        return made;
    };
    using enum ProbeReason;
    EXPECT_THAT(way_out(std::vector{touch(too_narrow), touch(obstructed), touch(too_narrow)}),
                HasSubstr("larger ball"));
    EXPECT_THAT(way_out(std::vector{touch(too_narrow, 0.5)}), HasSubstr("smaller ball"));
    EXPECT_THAT(way_out(std::vector{touch(too_tilted, 0.5), touch(none, 0.5)}), HasSubstr("max-tilt"));
    EXPECT_THAT(way_out(std::vector{touch(obstructed, 0.5)}), HasSubstr("stylus"));
    EXPECT_THAT(way_out(std::vector{touch(concave)}), HasSubstr("features"));
    EXPECT_THAT(way_out(std::vector{touch(concave), touch(too_narrow)}), HasSubstr("larger ball")) << "a tie";
}

/// Two blocks with a slot between them.
TriangleMesh slot(double width) {
    return joined(box(Vec3(-10, 0, 0), Vec3(0, 10, 10), 6), box(Vec3(width, 0, 0), Vec3(width + 10, 10, 10), 6));
}

TEST(ProbePlanner, NarrowSlot_IsApproachedMoreSteeply) {
    // The centre at sin(45 - phi) beside the edge meets the other edge if its distance from it is below 1:
    // width <= 2 sin(45 - phi).
    for (const auto& [width, least] : {std::pair(1.5, 0.0), std::pair(1.2, 9.0), std::pair(0.8, 22.0)}) {
        const Planned result = planned(slot(width), probe_of(1, 0.05, 5));
        int found = 0;
        for (const ProbeTouch& touch : result.plan.touches) {
            const bool is_rim = std::abs(touch.position.z() - 10) < 1e-9 && std::abs(touch.tangent.y()) > 0.9 &&
                                touch.position.x() > -1 && touch.position.x() < width + 1;
            if (!is_rim) continue;
            ++found;
            EXPECT_EQ(touch.reason, ProbeReason::none);
            EXPECT_NEAR(std::abs(touch.phi) / degree, least, 1e-9) << width;
            EXPECT_GE(touch.approach.z(), std::sqrt(0.5) - 1e-12) << "leans upwards";
        }
        EXPECT_EQ(found, 4);
    }
}

TEST(ProbePlanner, SlotNarrowerThanTheBallCanLean_IsObstructed) {
    // phi is at most acos(0.3) - 45 = 27.5 degrees; a slot of 0.58 needs 28.1.
    const Planned result = planned(slot(0.58), probe_of(1, 0.3, 5));
    int rims = 0;
    for (const ProbeTouch& touch : result.plan.touches)
        if (std::abs(touch.position.z() - 10) < 1e-9 && std::abs(touch.tangent.y()) > 0.9 &&
            std::abs(touch.position.x() - 0.29) < 1) {
            ++rims;
            EXPECT_EQ(touch.reason, ProbeReason::obstructed);
            EXPECT_TRUE(std::isnan(touch.phi));
        }
    EXPECT_EQ(rims, 4);
    EXPECT_EQ(result.metrics.find("obstructed")->value, static_cast<double>(result.obstructed));
}

TEST(ProbePlanner, SeamOfTwoParts_IsNoEdge) {
    for (const int times : {0, 4}) {
        const TriangleMesh mesh =
            joined(box(Vec3::Zero(), Vec3::Constant(10), times), box(Vec3(10, 0, 0), Vec3(20, 10, 10), times));
        ProbePlannerParams params = probe_of(0.5, 0.1, 1);
        const Planned result = planned(mesh, params);
        int of_seam = 0;
        for (const ProbeTouch& touch : result.plan.touches) {
            if (std::abs(touch.position.x() - 10) > 0.01) {
                EXPECT_TRUE(touch.reason == ProbeReason::none || touch.reason == ProbeReason::too_tilted);
                continue;
            }
            ++of_seam;
            EXPECT_NE(touch.reason, ProbeReason::none) << touch.position.transpose();
        }
        EXPECT_EQ(of_seam, 80) << "of eight edges";
        EXPECT_EQ(result.obstructed, 60u) << "the others are below";
        params.approach = Angle::degrees(0);
        EXPECT_EQ(planned(mesh, params).wrong_contacts + planned(mesh, params).obstructed, 60u);
    }
}

TEST(ProbePlanner, OnAMeshOfLongEdges_ObstaclesFartherThanTheRadiusAreSeen) {
    // A wall beside the edge x = 10 of a block of two triangles per face: its foot is 1.5 away.
    const TriangleMesh mesh =
        joined(box(Vec3::Zero(), Vec3(10, 10, 10), 0), box(Vec3(11.2, -5, 0), Vec3(14, 15, 30), 0));
    const Planned result = planned(mesh, probe_of(0.5, 0.1, 5));
    const Planned fine = planned(refined(mesh, 5), probe_of(0.5, 0.1, 5));
    ASSERT_EQ(result.plan.touches.size(), fine.plan.touches.size());
    for (std::size_t row = 0; row < fine.plan.touches.size(); ++row)
        EXPECT_EQ(result.plan.touches[row].reason, fine.plan.touches[row].reason)
            << result.plan.touches[row].position.transpose();
    EXPECT_GT(result.obstructed, 0u);
}

TEST(ProbePlanner, GivenApproach_IsJudgedByItsFalseTouches) {
    ProbePlannerParams params = probe_of(2, 0.75, 0.05);
    params.features = ProbePlannerParams::Features::creases;
    const TriangleMesh mesh = box(Vec3::Zero(), Vec3::Constant(40), 6);
    params.spacing = 1;
    for (const auto& [phi, share] :
         {std::pair(22.0, 0.0), std::pair(30.0, 0.0986), std::pair(-30.0, 0.0986), std::pair(40.0, 0.353)}) {
        params.approach = Angle::degrees(phi);
        const Planned result = planned(mesh, params);
        const auto made = static_cast<double>(result.plan.touches.size() - result.unreachable);
        ASSERT_GT(made, 100);
        const double tries = 1000 * made;
        EXPECT_NEAR(static_cast<double>(result.false_touches) / tries, share,
                    3 * std::sqrt(share * (1 - share) / tries) + 0.0001)
            << phi;
        double sum = 0;
        for (const ProbeTouch& touch : result.plan.touches)
            if (touch.reason == ProbeReason::none) {
                sum += touch.false_share;
                EXPECT_NEAR(touch.phi / degree, phi, 1e-9);
                EXPECT_NEAR(touch.false_share, share, 5 * std::sqrt(share * (1 - share) / 1000));
            }
        EXPECT_NEAR(1000 * sum, static_cast<double>(result.false_touches), 1e-6);
        expect_sound(result.plan);
    }
}

TEST(ProbePlanner, TwoDirections_AreOnBothSidesOfTheBisector) {
    ProbePlannerParams params = probe_of(1, 0.1, 2.5);
    params.directions = 2;
    const Planned result = planned(fine_cube(), params);
    EXPECT_EQ(result.plan.touches.size(), 80u) << "two where both approaches are possible";
    EXPECT_EQ(result.single, 0u);
    EXPECT_EQ(result.metrics.find("single")->value, 0);
    for (std::size_t row = 0; row < result.plan.touches.size(); ++row) {
        const ProbeTouch& touch = result.plan.touches[row];
        if (touch.reason != ProbeReason::none || touch.phi < 0) continue;
        EXPECT_NEAR(touch.phi / degree, 30, 1e-9);
        EXPECT_NEAR(result.plan.touches[row + 1].phi / degree, -30, 1e-9);
        EXPECT_EQ(result.plan.touches[row + 1].touch, touch.touch);
        EXPECT_EQ(result.plan.touches[row + 1].position, touch.position);
    }
    params = probe_of(1, 0.65, 2.5);  // leaves 4.5 degrees on either side: 8.1 between the two
    params.directions = 2;
    const Planned single = planned(fine_cube(), params);
    EXPECT_EQ(single.plan.touches.size(), 48u);
    EXPECT_EQ(single.plan.touches[0].phi, 0);
    EXPECT_EQ(single.single, 32u) << "16 of 48 are too tilted";
    EXPECT_EQ(single.metrics.find("single")->value, 32);
    params.directions = 1;
    EXPECT_EQ(planned(fine_cube(), params).single, 0u) << "one was asked for";
}

TEST(ProbePlanner, BeyondABorder_ARightAngleIsAssumed) {
    // The top of a block alone.
    TriangleMesh top = box(Vec3(0, 0, 0), Vec3(16, 16, 10), 5);
    Array<Triangle> upper;
    for (const Triangle& t : top.triangles)
        if (top.positions[t[0]].z() == 10 && top.positions[t[1]].z() == 10 && top.positions[t[2]].z() == 10)
            upper.push_back(t);
    top.triangles = std::move(upper);
    const Planned result = planned(top, probe_of(2, 0.5, 4));
    EXPECT_EQ(result.plan.touches.size(), 16u) << "one closed line of length 64";
    EXPECT_EQ(result.assumed, 16u);
    EXPECT_EQ(result.unreachable, 0u);
    for (const ProbeTouch& touch : result.plan.touches) {
        EXPECT_TRUE(touch.assumed);
        EXPECT_EQ(touch.interior_angle, pi / 2);
        EXPECT_NEAR(touch.left_normal.z(), 1, 1e-12);
        EXPECT_GT(touch.right_normal.dot(touch.position - Vec3(8, 8, 10)), 0) << "away from the top";
        EXPECT_NEAR(touch.phi_max / degree, 30.522, 0.0005);
        EXPECT_NEAR(touch.phi_known_min / degree, -45, 1e-9);
        EXPECT_NEAR(touch.phi_known_max / degree, 30.964, 0.0005);
    }
    // An error of 1.94 leaves nothing by equation 5.7; the known side leaves -45 to 0.87 degrees.
    for (const ProbeTouch& touch : planned(top, probe_of(2, 1.94, 4)).plan.touches) {
        EXPECT_TRUE(std::isnan(touch.phi_max));
        EXPECT_EQ(touch.reason, ProbeReason::none);
        EXPECT_NEAR(touch.phi_known_max / degree, 0.87, 0.005);
        EXPECT_NEAR(touch.phi / degree, (-45 + 0.87) / 2, 0.005);
        EXPECT_EQ(touch.false_share, 0);
        EXPECT_GT(touch.approach.dot(touch.right_normal), touch.approach.dot(touch.left_normal));
    }
}

TEST(ProbePlanner, WhereLinesMeet_NormalsOfTwoFacesAreNotMixed) {
    // Two strips that meet in the y axis at 30 degrees; the border turns there by 30 degrees only.
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    constexpr u32 across = 21, along = 6;
    const Vec3 down(std::cos(30 * degree), 0, -std::sin(30 * degree));
    for (u32 j = 0; j < along; ++j)
        for (u32 i = 0; i < across; ++i) {
            const double x = static_cast<double>(i) - 10;
            positions.push_back(Vec3(j * Vec3::UnitY() + x * (x < 0 ? Vec3::UnitX() : down)));
            if (i == 0 || j == 0) continue;
            const u32 here = j * across + i;
            triangles.insert(triangles.end(),
                             {{here, here - 1, here - across}, {here - 1, here - across - 1, here - across}});
        }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    const FeatureGraph features = lines_of(mesh, 20);
    ASSERT_EQ(features.polylines.size(), 2u) << "the border and the crease";
    ProbePlannerParams params = probe_of(0.5, 0.05, 0.5);
    params.features = ProbePlannerParams::Features::boundaries;
    for (const ProbeTouch& touch : planned(features, mesh, params).plan.touches) {
        const Vec3 normal =
            touch.position.x() < 0 ? Vec3::UnitZ() : Vec3(std::sin(30 * degree), 0, std::cos(30 * degree));
        EXPECT_NEAR((touch.left_normal - normal).norm(), 0, 1e-9) << touch.position.transpose();
    }
}

/// A double cone: radius 10 at z = 0, apexes at z = ± height.
TriangleMesh bicone(double height, u32 around) {
    TriangleMesh mesh;
    Array<Vec3> positions{Vec3(0, 0, height), Vec3(0, 0, -height)};
    Array<Triangle> triangles;
    for (u32 i = 0; i < around; ++i) {
        positions.push_back(10 * Vec3(std::cos(2 * pi * i / around), std::sin(2 * pi * i / around), 0));
        const u32 next = (i + 1) % around;
        triangles.insert(triangles.end(), {{0, 2 + i, 2 + next}, {1, 2 + next, 2 + i}});
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TEST(ProbePlanner, CircularEdge_HasOneRangeAndDirectionsThatRotateWithThePoint) {
    const TriangleMesh mesh = bicone(6, 180);
    const FeatureGraph features = lines_of(mesh);
    ASSERT_EQ(features.polylines.size(), 1u);
    ASSERT_TRUE(features.polylines[0].closed);
    const Planned result = planned(features, mesh, probe_of(0.5, 0.02, 1));
    EXPECT_EQ(result.plan.touches.size(), 63u) << "a circumference of 62.8";
    EXPECT_EQ(result.unreachable, 0u);
    expect_sound(result.plan);
    const double alpha = 2 * std::atan(0.6);
    for (const ProbeTouch& touch : result.plan.touches) {
        EXPECT_NEAR(touch.interior_angle, alpha, 1e-3);
        EXPECT_NEAR(touch.phi_max, std::acos(0.04) - alpha / 2, 1e-3);
        EXPECT_NEAR(touch.phi_max, result.plan.touches[0].phi_max, 1e-4);
        EXPECT_NEAR(touch.approach.dot(touch.tangent), 0, 1e-12);
        const Vec3 outwards = Vec3(touch.position.x(), touch.position.y(), 0).normalized();
        EXPECT_NEAR(touch.approach.dot(outwards), 1, 2e-4) << "within half of the segments' 2 degrees";
        EXPECT_EQ(touch.phi, 0);
    }
}

TEST(ProbePlanner, RoundHole_IsTooNarrowIfTheBallPassesItsAxis) {
    // A square plate from -20 to 20 with a hole of radius 5.
    constexpr u32 around = 96;
    TriangleMesh plate;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 ring = 0; ring < 9; ++ring)
        for (u32 i = 0; i < around; ++i) {
            const double angle = 2 * pi * i / around, radius = 5 + 2 * ring;
            positions.push_back(radius * Vec3(std::cos(angle), std::sin(angle), 0));
            if (ring == 0) continue;
            const u32 next = (i + 1) % around, a = (ring - 1) * around;
            triangles.insert(triangles.end(),
                             {{a + i, a + around + i, a + around + next}, {a + i, a + around + next, a + next}});
        }
    plate.positions = std::move(positions);
    plate.triangles = std::move(triangles);
    const FeatureGraph features = lines_of(plate);
    ProbePlannerParams params = probe_of(7, 0.5, 3);
    params.features = ProbePlannerParams::Features::holes;
    EXPECT_EQ(planned(features, plate, params).too_narrow, 0u) << "7 sin 45 deg = 4.95";
    params.radius = 7.2;
    const Planned wide = planned(features, plate, params);
    EXPECT_EQ(wide.too_narrow, wide.plan.touches.size()) << "7.2 sin 45 deg = 5.09";
    EXPECT_EQ(wide.plan.touches.size(), 10u);
    ASSERT_EQ(wide.doubts.size(), 1u);
    EXPECT_THAT(
        wide.doubts[0].text,
        AllOf(HasSubstr("none of 10 touches can be made: 0 concave, 10 too narrow, 0 too tilted and 0 obstructed"),
              HasSubstr("a smaller ball")));
    params.approach = Angle::degrees(10);  // steeper: 7.2 sin 35 deg = 4.13
    EXPECT_EQ(planned(features, plate, params).too_narrow, 0u);
    params.approach.reset();
    params.features = ProbePlannerParams::Features::boundaries;
    const Planned outside = planned(features, plate, params);
    EXPECT_EQ(outside.too_narrow, 0u) << "only holes are narrow";
    EXPECT_GT(outside.plan.touches.size(), 40u);
}

TEST(ProbePlanner, Moved_PlansTheSameTouches) {
    const TriangleMesh mesh = refined(l_block(10), 4);
    const ProbePlannerParams params = probe_of(1, 0.1, 3);
    const FeatureGraph features = lines_of(mesh);
    const Planned before = planned(features, mesh, params);
    RigidTransform pose;
    pose.rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    pose.translation = Vec3(30, -7, 100);
    const Value moved = placed(std::make_shared<const TriangleMesh>(mesh), pose),
                moved_features = placed(std::make_shared<const FeatureGraph>(features), pose);
    ProbePlannerParams turned = params;
    const Vec3 axis = pose.rotation * Vec3::UnitZ();
    turned.machine_axis = {axis.x(), axis.y(), axis.z()};
    const Planned after = planned(*moved_features.get<FeatureGraph>(), *moved.get<TriangleMesh>(), turned);
    ASSERT_EQ(after.plan.touches.size(), before.plan.touches.size());
    for (std::size_t row = 0; row < before.plan.touches.size(); ++row) {
        const ProbeTouch &one = before.plan.touches[row], &other = after.plan.touches[row];
        EXPECT_EQ(one.reason, other.reason);
        EXPECT_NEAR((pose.rotation * one.approach - other.approach).norm(), 0, 1e-9);
        EXPECT_NEAR((pose.apply(one.position) - (other.position + after.plan.frame.origin)).norm(), 0, 1e-9);
    }
}

TEST(ProbePlanner, Scaled_PlansTheSameTouches) {
    const Planned before = planned(refined(l_block(10), 4), probe_of(1, 0.1, 3)),
                  after = planned(refined(l_block(30), 4), probe_of(3, 0.3, 9));
    ASSERT_EQ(after.plan.touches.size(), before.plan.touches.size());
    EXPECT_NEAR(after.travel, 3 * before.travel, 1e-9 * after.travel);
    for (std::size_t row = 0; row < before.plan.touches.size(); ++row)
        EXPECT_EQ(before.plan.touches[row].reason, after.plan.touches[row].reason);
}

TEST(ProbePlanner, FeaturesAtAnotherOrigin_AreTheSamePart) {
    const Planned before = planned(fine_cube(), probe_of(1, 0.1, 2.5));
    TriangleMesh mesh = mapped(fine_cube(), [](const Vec3& p) { return Vec3(p - Vec3(64, 0, 8)); });
    mesh.frame.origin = Vec3(64, 0, 8);
    const Planned after = planned(lines_of(fine_cube()), mesh, probe_of(1, 0.1, 2.5));
    EXPECT_EQ(write_bytes("a.json", std::make_shared<const ProbePlan>(before.plan)),
              write_bytes("a.json", std::make_shared<const ProbePlan>(after.plan)));
}

TEST(ProbePlanner, AnyNumberOfThreads_GivesTheSameBytes) {
    ProbePlannerParams params = probe_of(1, 0.1, 0.5);
    params.directions = 2;
    const auto bytes = [&](unsigned threads) {
        return write_bytes("a.json", std::make_shared<const ProbePlan>(planned(slot(1.2), params, threads).plan));
    };
    const std::string one = bytes(1);
    EXPECT_EQ(bytes(2), one);
    EXPECT_EQ(bytes(7), one);
}

TEST(ProbePlanner, RoughLines_AreWarnedOf) {
    // The rim of a disc whose vertices are ± 0.3 off.
    TriangleMesh disc;
    constexpr u32 around = 200;
    Array<Vec3> positions{Vec3::Zero()};
    Array<Triangle> triangles;
    for (u32 i = 0; i < around; ++i) {
        const double radius = 30 + (i % 3 == 0 ? 0.3 : i % 3 == 1 ? -0.3 : 0);
        positions.push_back(radius * Vec3(std::cos(2 * pi * i / around), std::sin(2 * pi * i / around), 0));
        triangles.push_back({0, 1 + i, 1 + (i + 1) % around});
    }
    disc.positions = std::move(positions);
    disc.triangles = std::move(triangles);
    const Planned result = planned(disc, probe_of(2, 0.1, 5));
    EXPECT_GT(result.edge_roughness, 0.15);
    EXPECT_LT(result.edge_roughness, 0.4);
    ASSERT_EQ(result.warnings.size(), 1u);
    EXPECT_THAT(result.warnings[0], testing::HasSubstr("above scanner-error, 0.1 u"));
    EXPECT_THAT(planned(disc, probe_of(2, 0.5, 5)).warnings, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
