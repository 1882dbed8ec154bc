// SPDX-License-Identifier: GPL-3.0-or-later
/// virtual-probe against wedges, whose edge is known.

#include "virtual_probe/virtual_probe.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <numbers>

#include "filters/align/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
constexpr double pi = std::numbers::pi;

/// A wedge of the interior angle alpha with its edge along y, from -50 to 50, and n0 = z; faces 100 wide.
TriangleMesh wedge(double alpha) {
    const double x = 100 * std::sin(alpha / 2), z = -100 * std::cos(alpha / 2);
    TriangleMesh mesh;
    mesh.positions = {{0, -50, 0}, {0, 50, 0}, {-x, -50, z}, {-x, 50, z}, {x, -50, z}, {x, 50, z}};
    mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}};
    return mesh;
}

/// A touch of the wedge's edge with e = y, so that x of the plane across the edge is y cross z = x.
ProbeTouch touch_at(const Vec3& position, double phi, u32 number = 0) {
    ProbeTouch touch;
    touch.touch = number;
    touch.feature = 7;
    touch.position = position;
    touch.tangent = Vec3::UnitY();
    touch.phi = phi;
    touch.approach = Vec3(-std::sin(phi), 0, std::cos(phi));
    touch.start = position + 12 * touch.approach;
    touch.order = number;
    return touch;
}

ProbePlan plan_of(std::vector<ProbeTouch> touches, double radius = 2, double scanner_error = 0.75) {
    ProbePlan plan;
    plan.touches = std::move(touches);
    plan.radius = radius;
    plan.scanner_error = scanner_error;
    return plan;
}

struct Probed : VirtualProbeResult {
    Metrics metrics;
    std::vector<Doubt> doubts;
};

Probed probed(const ProbePlan& plan, const TriangleMesh& mesh, const VirtualProbeParams& params = {},
              unsigned threads = 1, u64 seed = 0) {
    ContextOptions options;
    options.threads = threads;
    options.seed = seed;
    Context context(options);
    VirtualProbeResult result = virtual_probe(plan, mesh, params, context);
    return {std::move(result), context.metrics(), context.doubts()};
}

TEST(VirtualProbe, OnTheBisector_TheBallStopsOneRadiusAboveTheEdge) {
    const Probed result = probed(plan_of({touch_at({0, 3, 0}, 0, 4)}), wedge(pi / 2));
    ASSERT_EQ(result.points.size(), 1u);
    EXPECT_LT((result.points.positions[0] - Vec3(0, 3, 0)).norm(), 1e-8);
    EXPECT_EQ(result.points.columns.find("touch")->number(0), 4);
    EXPECT_EQ(result.points.columns.find("feature")->number(0), 7);
    EXPECT_EQ(result.points.columns.find("uncertainty")->number(0), 0);
    EXPECT_EQ(result.points.columns.find("uncertainty")->length_exponent(), 1);
    EXPECT_EQ(result.points.columns.find("approach")->number(0, 2), 1);
    EXPECT_EQ(result.metrics.find("points")->value, 1);
    EXPECT_EQ(result.metrics.find("missed")->value, 0);
}

TEST(VirtualProbe, OnAFace_TheBallStopsAtTheFace) {
    // At x = 2.5 the ball meets the face x + z = 0, whose distance from its centre is (x + z) / sqrt(2).
    const Probed result = probed(plan_of({touch_at({2.5, 0, 0}, 0)}), wedge(pi / 2));
    EXPECT_NEAR(result.points.positions[0].z() + 2, -2.5 + 2 * std::numbers::sqrt2, 1e-8);
}

TEST(VirtualProbe, AWedgeGivesTheClosedForm) {
    // O - Q = sqrt(r² - d²) u + d w, where d is the distance of T from Q across u: while the edge is met first.
    Random random(1);
    int made = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const double alpha = random.uniform(0.2, 3), r = random.uniform(0.5, 5), t = random.uniform(0, 0.9) * r;
        const double largest = std::acos(t / r) - alpha / 2;
        if (largest <= 0) continue;
        const double phi = random.uniform(-largest, largest), theta = random.uniform(0, 2 * pi);
        const Vec3 edge(0, random.uniform(-20, 20), 0);
        const ProbeTouch touch = touch_at(edge + t * Vec3(std::sin(theta), 0, std::cos(theta)), phi);
        const Probed result = probed(plan_of({touch}, r, t), wedge(alpha));
        const Vec3 u = touch.approach, w = touch.tangent.cross(u);
        const double d = (touch.position - edge).dot(w);
        const Vec3 centre = result.points.positions[0] + r * u;
        ASSERT_LT((centre - (edge + std::sqrt(r * r - d * d) * u + d * w)).norm(), 1e-8 * r)
            << trial << ": alpha " << alpha << " phi " << phi;
        ++made;
    }
    EXPECT_GT(made, 500);
}

TEST(VirtualProbe, TwoDirections_FixTheEdge) {
    // Q is the one of the two circles' intersections that lies away from the approaches.
    const TriangleMesh mesh = wedge(pi / 3);
    Random random(2);
    for (int trial = 0; trial < 200; ++trial) {
        const Vec3 position(random.uniform(-0.3, 0.3), 0, random.uniform(-0.3, 0.3));
        const Probed result = probed(plan_of({touch_at(position, 0.4), touch_at(position, -0.4)}), mesh);
        Vec3 centre[2];
        for (int i = 0; i < 2; ++i) {
            const Column& approach = *result.points.columns.find("approach");
            const auto row = static_cast<std::size_t>(i);
            centre[i] = result.points.positions[row] +
                        2 * Vec3(approach.number(row, 0), approach.number(row, 1), approach.number(row, 2));
        }
        const Vec3 chord = centre[1] - centre[0], middle = (centre[0] + centre[1]) / 2;
        const Vec3 across = Vec3(-chord.z(), 0, chord.x()).normalized();
        const double height = std::sqrt(4 - chord.squaredNorm() / 4);
        const Vec3 edge = middle + (across.z() < 0 ? height : -height) * across;
        ASSERT_LT(edge.norm(), 2e-7) << trial;
    }
}

TEST(VirtualProbe, ReferenceError_IsUniformInADiscAcrossTheEdge) {
    std::vector<ProbeTouch> touches;
    for (u32 i = 0; i < 20000; ++i) touches.push_back(touch_at(Vec3::Zero(), 0, i));
    VirtualProbeParams params;
    params.reference_error = 0.75;
    const Probed result = probed(plan_of(touches), wedge(pi / 3), params);
    double sum = 0, across = 0, along = 0;
    for (const Vec3& p : result.points.positions) {
        ASSERT_NEAR((p + Vec3(0, 0, 2)).norm(), 2, 1e-8) << "the ball touches the edge";
        ASSERT_NEAR(p.y(), 0, 1e-12);
        sum += p.x() * p.x();
        across = std::max(across, std::abs(p.x()));
        along = std::max(along, -p.z());
    }
    EXPECT_NEAR(std::sqrt(sum / 20000), 0.375, 0.005);
    EXPECT_NEAR(across, 0.75, 0.005);
    EXPECT_NEAR(along, 0.1458, 0.003);
    EXPECT_EQ(result.missed, 0u);
}

TEST(VirtualProbe, Noise_IsAddedToEachCoordinate) {
    std::vector<ProbeTouch> touches;
    for (u32 i = 0; i < 20000; ++i) touches.push_back(touch_at(Vec3::Zero(), 0.1, i));
    VirtualProbeParams params;
    params.noise = 0.01;
    const Probed result = probed(plan_of(touches), wedge(pi / 3), params);
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : result.points.positions) sum += p.cwiseAbs2();
    for (const double square : sum) EXPECT_NEAR(std::sqrt(square / 20000), 0.01, 0.0003);
    EXPECT_EQ(result.points.columns.find("uncertainty")->number(17), 0.01);
}

TEST(VirtualProbe, TheBytesDependOnTheSeed_NotOnTheThreads) {
    std::vector<ProbeTouch> touches;
    for (u32 i = 0; i < 500; ++i) touches.push_back(touch_at({0, 0.05 * i, 0}, 0.2, i));
    VirtualProbeParams params;
    params.reference_error = 0.5;
    params.noise = 0.01;
    const auto bytes = [&](unsigned threads, u64 seed) {
        const Probed result = probed(plan_of(touches), wedge(1), params, threads, seed);
        return std::string(reinterpret_cast<const char*>(result.points.positions.data()), 500 * sizeof(Vec3));
    };
    EXPECT_EQ(bytes(1, 3), bytes(7, 3));
    EXPECT_NE(bytes(1, 3), bytes(1, 4));
}

TEST(VirtualProbe, TouchesThatAreNotMade_AreLeftOut_AndOthersSortedByOrder) {
    std::vector<ProbeTouch> touches{touch_at({0, 0, 0}, 0, 0), touch_at({0, 1, 0}, 0, 1), touch_at({0, 2, 0}, 0, 2)};
    touches[0].order = 1;
    touches[1].order = ProbeTouch::no_order;
    touches[1].reason = ProbeReason::concave;
    touches[1].approach = Vec3::Zero();
    touches[2].order = 0;
    const Probed result = probed(plan_of(touches), wedge(1));
    EXPECT_THAT(result.rows, ElementsAre(2, 0));
    EXPECT_NEAR(result.points.positions[0].y(), 2, 1e-12);
}

TEST(VirtualProbe, WithoutContact_OrInContactAtTheStart_ATouchIsMissed) {
    std::vector<ProbeTouch> touches{touch_at({0, 0, 0}, 0, 0), touch_at({0, 80, 0}, 0, 1), touch_at({0, 1, 0}, 0, 2),
                                    touch_at({0, 0, 5}, 0, 3)};
    touches[2].start = {0, 1, 1};  // the ball of radius 2 meets the edge there
    const Probed result = probed(plan_of(touches), wedge(1));
    EXPECT_THAT(result.rows, ElementsAre(0));  // the last stops 2.75 below its T, 2.25 above the edge
    EXPECT_EQ(result.missed, 3u);
    EXPECT_EQ(result.metrics.find("missed")->value, 3);
}

TEST(VirtualProbe, MoreThanATenthMissed_IsDoubtful) {
    std::vector<ProbeTouch> touches;
    for (u32 i = 0; i < 20; ++i) touches.push_back(touch_at({0, i < 18 ? 1.0 * i : 80, 0}, 0, i));
    const Probed tenth = probed(plan_of(touches), wedge(1));
    EXPECT_EQ(tenth.missed, 2u);
    EXPECT_TRUE(tenth.doubts.empty()) << "exactly a tenth";
    touches[0].position.y() = touches[0].start.y() = 80;
    const Probed more = probed(plan_of(touches), wedge(1));
    ASSERT_EQ(more.doubts.size(), 1u);
    EXPECT_EQ(more.doubts[0].text,
              "3 of 20 touches (15 %) missed the mesh: check that the plan is of this part, and in its position");
}

TEST(VirtualProbe, ABallThatSlidesAlongAWall_DoesNotTakeForever) {
    // A wall at x = r plus some 1e-9 radii beside the path down to the edge.
    TriangleMesh mesh = wedge(1);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    const double x = 2 + 4e-9;
    positions.insert(positions.end(), {{x, -50, 5}, {x, 50, 5}, {x, 0, 50}});
    triangles.push_back({6, 7, 8});
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    EXPECT_GT(probed(plan_of({touch_at({0, 0, 0}, 0)}), mesh).points.positions[0].z(), 5);
}

TEST(VirtualProbe, OtherOrigins_MakeNoDifference) {
    ProbePlan plan = plan_of({touch_at({0, 3, 0}, 0.2)});
    TriangleMesh mesh = wedge(1);
    const Vec3 expected = probed(plan, mesh).points.positions[0];
    plan.frame.origin = Vec3(1000, 0, 0);
    plan.touches[0].position -= plan.frame.origin;
    plan.touches[0].start -= plan.frame.origin;
    const Probed moved = probed(plan, mesh);
    EXPECT_LT((moved.points.frame.origin + moved.points.positions[0] - expected).norm(), 1e-8);
}

// Refusals.

Error refusal(const ProbePlan& plan, const TriangleMesh& mesh, const VirtualProbeParams& params = {}) {
    const Error error = error_of([&] { probed(plan, mesh, params); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error;
}

TEST(VirtualProbeRefusals, PlansWithoutTouches) {
    ProbePlan plan = plan_of({touch_at({0, 0, 0}, 0)});
    plan.touches[0].reason = ProbeReason::obstructed;
    EXPECT_EQ(refusal(plan, wedge(1)).sentence(), "the plan has 1 touch, of which none is made");
    EXPECT_THAT(refusal(plan, wedge(1)).hint(), HasSubstr("smaller ball"));
    plan.touches[0].reason = ProbeReason::too_narrow;
    plan.touches[0].phi_min = plan.touches[0].phi_max = ProbeTouch::nan;
    EXPECT_THAT(refusal(plan, wedge(1)).hint(), HasSubstr("larger ball")) << "no direction was safe";
    EXPECT_EQ(refusal(plan_of({}), wedge(1)).sentence(), "the plan has 0 touches, of which none is made");
    EXPECT_EQ(refusal(plan_of({touch_at({0, 300, 0}, 0)}), wedge(1)).sentence(), "the only touch missed the mesh");
    EXPECT_EQ(refusal(plan_of({touch_at({0, 300, 0}, 0), touch_at({0, 301, 0}, 0)}), wedge(1)).sentence(),
              "all 2 touches missed the mesh");
}

TEST(VirtualProbeRefusals, LengthsRadiusAndDirections) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const ProbePlan plan = plan_of({touch_at({0, 0, 0}, 0)});
    VirtualProbeParams noise, error;
    noise.noise = -1;
    error.reference_error = nan;
    EXPECT_EQ(refusal(plan, wedge(1), noise).sentence(), "noise is -1 u; it must be 0 or more");
    EXPECT_EQ(refusal(plan, wedge(1), error).sentence(), "reference-error is nan u; it must be 0 or more");
    error.reference_error = 2;
    EXPECT_EQ(refusal(plan, wedge(1), error).sentence(),
              "reference-error is 2 u and the plan's ball has the radius 2 u: the ball must be larger than the error "
              "to meet the edge first");
    error.reference_error = 1.9;
    EXPECT_EQ(probed(plan, wedge(1), error).missed, 0u);
    EXPECT_EQ(refusal(plan_of({touch_at({0, 0, 0}, 0)}, 0), wedge(1)).sentence(),
              "the plan's ball has the radius 0 u; it must be above 0");
    ProbePlan crooked = plan, endless = plan, lengthwise = plan;
    lengthwise.touches[0].tangent = lengthwise.touches[0].approach;
    EXPECT_EQ(refusal(lengthwise, wedge(1)).sentence(),
              "the touch in row 0 has an approach of length 1, and its cross product with the tangent has the length "
              "0; a unit vector across the edge is needed");
    crooked.touches[0].approach *= 2;
    endless.touches[0].start.x() = nan;
    EXPECT_THAT(refusal(crooked, wedge(1)).sentence(), HasSubstr("the touch in row 0 has an approach of length 2"));
    EXPECT_THAT(refusal(endless, wedge(1)).sentence(), HasSubstr("touch in row 0 is not finite"));
}

TEST(VirtualProbeRefusals, Meshes) {
    const ProbePlan plan = plan_of({touch_at({0, 0, 0}, 0)});
    TriangleMesh empty = wedge(1), wrong = wedge(1), bad = wedge(1);
    empty.triangles = {};
    wrong.triangles = {{0, 1, 9}};
    bad.positions = {{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0}};
    bad.triangles = {{0, 1, 2}};
    EXPECT_EQ(refusal(plan, empty).sentence(), "the mesh has no triangles; the ball needs at least 1 to touch");
    EXPECT_THAT(refusal(plan, wrong).sentence(), HasSubstr("triangle 0 names vertex 9; there are 6"));
    EXPECT_THAT(refusal(plan, bad).sentence(), HasSubstr("1 of "));
}

TEST(VirtualProbeRefusals, OtherFramesAndUnits) {
    ProbePlan plan = plan_of({touch_at({0, 0, 0}, 0)});
    TriangleMesh mesh = wedge(1);
    plan.frame.name = "machine";
    mesh.frame.name = "scanner";
    EXPECT_EQ(refusal(plan, mesh).sentence(),
              "the plan is in the frame 'machine', the mesh in 'scanner'; both need one frame");
    mesh.frame.unit = LengthUnit::inch;
    EXPECT_EQ(refusal(plan, mesh).sentence(), "the plan is in u, the mesh in in; both need one unit");
}

TEST(VirtualProbe, ACancelledRun_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(virtual_probe(plan_of({touch_at({0, 0, 0}, 0)}), wedge(1), {}, context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
