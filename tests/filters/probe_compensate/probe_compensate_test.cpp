// SPDX-License-Identifier: GPL-3.0-or-later
/// Points that probe-compensate makes of touches of a known edge.

#include "probe_compensate/probe_compensate.hpp"

#include <gmock/gmock.h>

#include "apply_transform/apply_transform.hpp"
#include "filters/align/cases.hpp"
#include "filters/probe_compensate/cases.hpp"
#include "support/same_bits.hpp"
#include "virtual_probe/virtual_probe.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Rows = std::array<u32, 2>;
constexpr u32 no_row = ProbeCompensateResult::no_row;

TEST(ProbeCompensate, TwoApproachesAtARightAngle_MeetAtTheEdge) {
    // The edge is (1, 2, 3). Balls of radius 5 touch it with contact normals (-0.6, 0, 0.8) and (0.8, 0, 0.6), which
    // are at a right angle; the approaches are, too, and 8.13 deg off the normals.
    const Vec3 edge(1, 2, 3), u1 = Vec3(-1, 0, 1).normalized(), u2 = Vec3(1, 0, 1).normalized();
    const Vec3 o1 = edge + Vec3(-3, 0, 4), o2 = edge + Vec3(4, 0, 3);
    const std::vector<Touch> contacts{{o1 - 5 * u1, u1, 4, 7, 0.01}, {o2 - 5 * u2, u2, 4, 7, 0.01}};
    const Compensated result = compensated(contacts, with_radius(5, 0.5));
    ASSERT_EQ(result.points.size(), 1u);
    EXPECT_LT((result.points.positions[0] - edge).norm(), 1e-12);
    EXPECT_LT((result.approach(0) - Vec3(0, 0, 1)).norm(), 1e-15);
    EXPECT_NEAR(result.number("uncertainty", 0), 0.01 * std::numbers::sqrt2, 1e-15) << "the sine is 1";
    EXPECT_EQ(result.number("touch", 0), 4);
    EXPECT_EQ(result.number("feature", 0), 7);
    EXPECT_EQ(result.points.columns.find("uncertainty")->length_exponent(), 1);
    EXPECT_THAT(result.rows, ElementsAre(Rows{0, 1}));

    ProbeCompensateParams params = with_radius(5);
    params.reported = ProbeCompensateParams::Reported::centre;
    const Compensated centres = compensated({{o1, u1, 4, 7, 0.01}, {o2, u2, 4, 7, 0.01}}, params);
    EXPECT_LT((centres.points.positions[0] - edge).norm(), 1e-12);
    for (const char* metric : {"points", "paired"}) EXPECT_EQ(centres.metrics.find(metric)->value, 1) << metric;
    for (const char* metric : {"single", "unused", "lines"}) EXPECT_EQ(centres.metrics.find(metric)->value, 0);
    EXPECT_TRUE(centres.doubts.empty());
    EXPECT_TRUE(centres.warnings.empty());
}

TEST(ProbeCompensate, CentresApartAlongTheEdge_AreProjectedIntoTheirMeanPlane) {
    std::vector<Touch> touches{touch_of({0, 0, 0}, 0.4, 0.3, 2), touch_of({0, 0, 0}, -0.4, -0.2, 2)};
    touches[0].position.y() += 0.2;
    const Compensated result = compensated(touches, with_radius(2));
    EXPECT_LT((result.points.positions[0] - Vec3(0, 0.1, 0)).norm(), 1e-12);
}

TEST(ProbeCompensate, PairsAreExact_ForEveryReferencePoint) {
    Random random(1);
    for (int trial = 0; trial < 20000; ++trial) {
        const double r = random.uniform(0.5, 5), t = random.uniform(0, 0.9) * r, theta = random.uniform(0, 6.28);
        const double phi = random.uniform(5, 60) * degree;
        if (phi > std::acos(t / r)) continue;  // the ball could meet a face first
        const Vec3 edge(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50));
        std::vector<Touch> touches;
        for (const double angle : {phi, -phi}) touches.push_back(touch_of(edge, angle, t * std::sin(theta + angle), r));
        const Vec3 o1 = touches[0].position + r * touches[0].approach,
                   o2 = touches[1].position + r * touches[1].approach;
        const double sine = (o1 - edge).cross(o2 - edge).norm() / (r * r);
        if (sine < 0.05) continue;
        const Compensated result = compensated(touches, with_radius(r));
        ASSERT_EQ(result.paired, 1u);
        ASSERT_LT((result.points.positions[0] - edge).norm(), 1e-12) << trial << " of sine " << sine;
    }
}

TEST(ProbeCompensate, ASingleTouch_ErrsAcrossAndAlongItsApproach) {
    // r = 2, delta = 0.75: up to 0.75 across and 0.146 along.
    const Compensated result = compensated({touch_of({0, 0, 0}, 0, 0.75, 2)}, with_radius(2, 0.75));
    EXPECT_NEAR(result.points.positions[0].x(), 0.75, 1e-12);
    EXPECT_NEAR(result.points.positions[0].z(), -0.146, 1e-4);
    EXPECT_EQ(result.number("uncertainty", 0), 0.75);
    EXPECT_THAT(result.rows, ElementsAre(Rows{0, no_row}));

    Touch noisy = touch_of({0, 0, 0}, 0, 0, 2);
    noisy.uncertainty = 0.4;
    EXPECT_EQ(compensated({noisy}, with_radius(2, 0.3)).number("uncertainty", 0), 0.5);
}

TEST(ProbeCompensate, UncertaintyOfPairs_IsTheScatterOfNoisyTouches) {
    // The factors at 15, 30 and 45 deg between approaches are about 6, 3 and 2.1.
    const double sigma = 0.001;
    Random random(3);
    for (const auto& [gamma, factor] : {std::pair(15., 5.46), {30., 2.83}, {45., 2.0}}) {
        double sum = 0;
        constexpr int trials = 20000;
        std::vector<Touch> touches;
        for (int trial = 0; trial < trials; ++trial)
            for (const double phi : {gamma / 2 * degree, -gamma / 2 * degree}) {
                touches.push_back(touch_of({0, 0, 0}, phi, 0, 2, trial));
                touches.back().uncertainty = sigma;
                for (double& coordinate : touches.back().position) coordinate += sigma * random.normal();
            }
        const Compensated result = compensated(cloud_of(touches, Columns::without_feature), with_radius(2));
        ASSERT_EQ(result.paired, static_cast<std::size_t>(trials));
        for (const Vec3& p : result.points.positions) sum += p.x() * p.x() + p.z() * p.z();
        EXPECT_NEAR(std::sqrt(sum / trials) / sigma, factor, 0.02 * factor) << gamma;
        EXPECT_NEAR(result.number("uncertainty", 0) / sigma, factor, 0.02 * factor) << gamma;
    }
}

TEST(ProbeCompensate, TouchesOfDifferentUncertainty_AddTheirSquares) {
    std::vector<Touch> touches{touch_of({0, 0, 0}, 45 * degree, 0, 2), touch_of({0, 0, 0}, -45 * degree, 0, 2)};
    touches[0].uncertainty = 0.03;
    touches[1].uncertainty = 0.04;
    EXPECT_NEAR(compensated(touches, with_radius(2)).number("uncertainty", 0), 0.05, 1e-15);
}

TEST(ProbeCompensate, ApproachesOfTenDegrees_MakeAPair_LessDoNot) {
    const auto pair = [](double angle) {
        const Touch first = touch_of({0, 0, 0}, 0, 0, 2), second = touch_of({0, 0, 0}, angle * degree, 0.01, 2);
        return compensated({first, second}, with_radius(2));
    };
    EXPECT_EQ(pair(10).paired, 1u);
    EXPECT_EQ(pair(9.999).paired, 0u);
    EXPECT_THAT(pair(9.999).rows, ElementsAre(Rows{0, no_row}, Rows{1, no_row}));
}

TEST(ProbeCompensate, OfThreeRows_TheTwoFarthestApartAreUsed) {
    std::vector<Touch> touches{touch_of({0, 0, 0}, 0.1, 0, 2), touch_of({0, 0, 0}, -0.3, 0, 2),
                               touch_of({0, 0, 0}, 0.3, 0, 2)};
    const Compensated result = compensated(touches, with_radius(2));
    EXPECT_THAT(result.rows, ElementsAre(Rows{1, 2}));
    EXPECT_EQ(result.unused, 1u);
    EXPECT_EQ(result.metrics.find("unused")->value, 1);
}

TEST(ProbeCompensate, OfEquallyFarPairs_TheFirstIsUsed) {
    // All three pairs of the axes are at exactly 90 deg.
    std::vector<Touch> touches;
    for (const Vec3& u : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 1, 0)}) touches.push_back({Vec3::Zero(), u, 5, 0, 0});
    EXPECT_THAT(compensated(touches, with_radius(2)).rows, ElementsAre(Rows{0, 1}));
    std::swap(touches[0], touches[2]);
    EXPECT_THAT(compensated(touches, with_radius(2)).rows, ElementsAre(Rows{0, 1}));
}

TEST(ProbeCompensate, PointsAreInTheOrderOfTheirTouchesFirstRows) {
    const std::vector<Touch> touches{touch_of({0, 9, 0}, 0.3, 0, 2, 9), touch_of({0, 2, 0}, 0.3, 0, 2, 2),
                                     touch_of({0, 5, 0}, 0, 0, 2, 5), touch_of({0, 2, 0}, -0.3, 0, 2, 2),
                                     touch_of({0, 9, 0}, -0.3, 0, 2, 9)};
    const Compensated result = compensated(touches, with_radius(2));
    EXPECT_THAT(result.rows, ElementsAre(Rows{0, 4}, Rows{1, 3}, Rows{2, no_row}));
    EXPECT_EQ(result.number("touch", 0), 9);
    EXPECT_EQ(result.number("touch", 2), 5);
    EXPECT_EQ(result.paired, 2u);
    EXPECT_EQ(result.single, 1u);
}

TEST(ProbeCompensate, WithoutTheColumnTouch_AllAreSingle) {
    const std::vector<Touch> touches{touch_of({0, 0, 0}, 0.3, 0, 2), touch_of({0, 0, 0}, -0.3, 0, 2)};
    const Compensated result = compensated(cloud_of(touches, Columns::approach_only), with_radius(2, 0.5));
    EXPECT_EQ(result.single, 2u);
    EXPECT_TRUE(result.features.polylines.empty());
    EXPECT_EQ(result.points.columns.size(), 2u);
    EXPECT_EQ(result.number("uncertainty", 1), 0.5) << "sigma is 0";
}

TEST(ProbeCompensate, ColumnsKeepTheirTypes_AndOthersAreDroppedWithAWarning) {
    PointCloud cloud = cloud_of({touch_of({0, 0, 0}, 0.3, 0, 2)}, Columns::approach_only);
    cloud.columns.add(Column("touch", 1, Buffer<u32>{12}));
    cloud.columns.add(Column("temperature", 1, Buffer<float>{20}));
    const Compensated result = compensated(cloud, with_radius(2));
    EXPECT_EQ(result.points.columns.find("touch")->type(), ScalarType::uint32);
    EXPECT_EQ(result.points.columns.find("temperature"), nullptr);
    ASSERT_EQ(result.warnings.size(), 1u);
    EXPECT_THAT(result.warnings[0], HasSubstr("temperature"));
}

TEST(ProbeCompensate, ApproachesRoundedAsInFiles_AreUnitVectors) {
    Touch touch = touch_of({0, 0, 0}, 0, 0, 2);
    touch.approach = Vec3(0.3333, 0.6667, 0.6667);  // of length 1.00003
    EXPECT_NEAR(compensated({touch}, with_radius(2)).approach(0).norm(), 1, 1e-15);
}

TEST(ProbeCompensate, RigidMotions_MoveTheResult) {
    Random random(5);
    std::vector<Touch> touches;
    for (int i = 0; i < 50; ++i)
        for (const double phi : {0.3, -0.2})
            touches.push_back(touch_of({0, 2.0 * i, 0}, phi, random.uniform(-0.5, 0.5), 2, i, i / 25));
    touches.resize(91);
    const PointCloud cloud = cloud_of(touches);
    const Compensated here = compensated(cloud, with_radius(2, 0.5));
    for (int trial = 0; trial < 5; ++trial) {
        RigidTransform motion = random_motion(random);
        Context context;
        const Value moved = apply_transform(Value(std::make_shared<const PointCloud>(cloud)), motion, context);
        const Compensated there = compensated(*moved.get<PointCloud>(), with_radius(2, 0.5));
        ASSERT_EQ(there.rows, here.rows);
        ASSERT_EQ(there.features.polylines.size(), here.features.polylines.size());
        for (std::size_t i = 0; i < here.points.size(); ++i) {
            EXPECT_LT(
                (there.points.frame.origin + there.points.positions[i] - motion.apply(here.points.positions[i])).norm(),
                1e-9);
            EXPECT_LT((there.approach(i) - motion.rotation * here.approach(i)).norm(), 1e-12);
            EXPECT_NEAR(there.number("uncertainty", i), here.number("uncertainty", i), 1e-12);
        }
    }
}

TEST(ProbeCompensate, TouchesOfVirtualProbe_GiveTheEdgeOfAWedge) {
    TriangleMesh wedge;  // of 60 deg, with its edge along y
    wedge.positions = {{0, -50, 0}, {0, 50, 0}, {-50, -50, -86.6}, {-50, 50, -86.6}, {50, -50, -86.6}, {50, 50, -86.6}};
    wedge.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}};
    Random random(2);
    ProbePlan plan;
    plan.radius = 2;
    plan.scanner_error = 0.75;
    for (u32 i = 0; i < 400; ++i) {
        ProbeTouch touch;
        touch.touch = i / 2;
        touch.order = i;
        touch.position = {random.uniform(-0.5, 0.5), 0.2 * i - 40, random.uniform(-0.5, 0.5)};
        if (i % 2 == 1) touch.position = plan.touches.back().position;
        touch.tangent = Vec3::UnitY();
        touch.approach = approach_at(i % 2 ? 0.4 : -0.4);
        touch.start = touch.position + 12 * touch.approach;
        plan.touches.push_back(touch);
    }
    Context context;
    const Compensated pairs = compensated(virtual_probe(plan, wedge, {}, context).points, with_radius(2, 0.75));
    EXPECT_EQ(pairs.paired, 200u);
    for (const Vec3& p : pairs.points.positions) EXPECT_LT(std::hypot(p.x(), p.z()), 1e-7 * 2);

    for (std::size_t i = 1; i < 400; i += 2) plan.touches[i].reason = ProbeReason::obstructed;
    const Compensated singles = compensated(virtual_probe(plan, wedge, {}, context).points, with_radius(2, 0.75));
    EXPECT_EQ(singles.single, 200u);
    for (std::size_t i = 0; i < singles.points.size(); ++i) {
        const ProbeTouch& touch = plan.touches[2 * i];
        const Vec3 u = touch.approach, across = touch.tangent.cross(u);
        const double d = touch.position.dot(across);
        EXPECT_NEAR(singles.points.positions[i].dot(across), d, 2e-8);
        EXPECT_NEAR(singles.points.positions[i].dot(u), std::sqrt(4 - d * d) - 2, 2e-8);
    }
}

TEST(ProbeCompensate, ContactsTakenForCentres_AreDoubted_AndCentresForContacts) {
    std::vector<Touch> contacts, centres;
    Random random(4);
    for (int i = 0; i < 40; ++i) {
        const double t = random.uniform(0.2, 0.6);  // above or below the edge
        for (const double phi : {15 * degree, -15 * degree}) {
            contacts.push_back(touch_of({0, 1.0 * i, 0}, phi, (i % 2 ? t : -t) * std::sin(phi), 2, i));
            centres.push_back(contacts.back());
            centres.back().position += 2 * centres.back().approach;
        }
    }
    ProbeCompensateParams as_centres = with_radius(2);
    as_centres.reported = ProbeCompensateParams::Reported::centre;
    EXPECT_TRUE(compensated(contacts, with_radius(2)).doubts.empty());
    EXPECT_TRUE(compensated(centres, as_centres).doubts.empty());
    const Compensated wrong = compensated(contacts, as_centres);
    ASSERT_EQ(wrong.doubts.size(), 1u);
    EXPECT_THAT(wrong.doubts[0].text, HasSubstr("of 40 pairs: check `radius`"));
    EXPECT_EQ(compensated(centres, with_radius(2)).doubts.size(), 1u);
}

TEST(ProbeCompensate, EqualInput_GivesEqualBytes) {
    std::vector<Touch> touches;
    for (int i = 0; i < 30; ++i) touches.push_back(touch_of({0, 1.0 * (i / 2), 0}, i % 2 ? 0.3 : -0.3, 0.1, 2, i / 2));
    const Compensated once = compensated(touches, with_radius(2)), again = compensated(touches, with_radius(2));
    EXPECT_TRUE(same_bits(once.points.positions, again.points.positions));
    EXPECT_TRUE(same_bits(once.features.positions, again.features.positions));
}

TEST(ProbeCompensate, ACancelledRun_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(probe_compensate(cloud_of({touch_of({0, 0, 0}, 0, 0, 2)}), with_radius(2), context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
