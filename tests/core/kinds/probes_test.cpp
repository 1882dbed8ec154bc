// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/probes.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <numbers>

#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A touch that is made and one that is not.
ProbePlan plan() {
    ProbePlan plan;
    plan.frame = {LengthUnit::millimetre, Vec3::Zero(), "machine"};
    ProbeTouch made;
    made.feature = 3;
    made.position = Vec3(1, 1. / 3, 0.1 + 0.2);
    made.tangent = Vec3::UnitY();
    made.left_normal = Vec3::UnitZ();
    made.right_normal = Vec3::UnitX();
    made.interior_angle = std::numbers::pi / 2;
    made.assumed = true;
    made.phi_min = -1. / 3;
    made.phi_max = 1. / 7;
    made.phi_known_min = -0.5;
    made.phi_known_max = 5e-324;
    made.phi = -0.0;
    made.approach = Vec3(0, 0.6, 0.8);
    made.start = Vec3(10, 20, 30);
    made.centre = Vec3(1, 2, 3);
    made.false_share = 0.001;
    made.contact = ProbeContact::edge;
    made.contact_distance = 0.25;
    made.order = 0;
    ProbeTouch missing;
    missing.touch = 1;
    missing.feature = 3;
    missing.position = missing.start = missing.centre = Vec3(5, 6, 7);
    missing.tangent = made.tangent;
    missing.left_normal = made.left_normal;
    missing.right_normal = made.right_normal;
    missing.interior_angle = 4;
    missing.reason = ProbeReason::too_narrow;
    plan.touches = {made, missing};
    plan.moves = {{ProbeMoveType::clearance, 0, {Vec3(0, 0, 9), Vec3(1, 0, 9), Vec3(10, 20, 30)}},
                  {ProbeMoveType::retract, 0, {Vec3(1, 2, 3), Vec3(10, 20, 30)}}};
    plan.radius = 2;
    plan.scanner_error = 0.1;
    plan.clearance = 1. / 3;
    plan.stylus_radius = 1.2;
    plan.stylus_length = 40;
    plan.machine_axis = Vec3(0, 0.6, 0.8);
    plan.dmis = {"UNITS/{unit}\n", DmisGoto::cart, 6};
    return plan;
}

Json json_of(const ProbePlan& plan) {
    Json json;
    kind_of<ProbePlan>().info().to_json(&plan, json);
    return json;
}
ProbePlan plan_of(const Json& json) {
    return *std::static_pointer_cast<ProbePlan>(kind_of<ProbePlan>().info().from_json(json, {}));
}

void expect_same_bits(double a, double b) {
    if (std::isnan(a) && std::isnan(b)) return;
    EXPECT_EQ(std::bit_cast<u64>(a), std::bit_cast<u64>(b)) << a << " and " << b;
}
void expect_same_bits(const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis) expect_same_bits(a[axis], b[axis]);
}

void expect_equal(const ProbePlan& a, const ProbePlan& b) {
    EXPECT_EQ(a.frame, b.frame);
    ASSERT_EQ(a.touches.size(), b.touches.size());
    for (std::size_t row = 0; row < a.touches.size(); ++row) {
        const ProbeTouch &one = a.touches[row], &other = b.touches[row];
        EXPECT_EQ(one.touch, other.touch);
        EXPECT_EQ(one.feature, other.feature);
        EXPECT_EQ(one.assumed, other.assumed);
        EXPECT_EQ(one.reason, other.reason);
        EXPECT_EQ(one.contact, other.contact);
        EXPECT_EQ(one.order, other.order);
        for (const auto field :
             {&ProbeTouch::position, &ProbeTouch::tangent, &ProbeTouch::left_normal, &ProbeTouch::right_normal,
              &ProbeTouch::approach, &ProbeTouch::start, &ProbeTouch::centre})
            expect_same_bits(one.*field, other.*field);
        for (const auto field :
             {&ProbeTouch::interior_angle, &ProbeTouch::phi_min, &ProbeTouch::phi_max, &ProbeTouch::phi_known_min,
              &ProbeTouch::phi_known_max, &ProbeTouch::phi, &ProbeTouch::false_share, &ProbeTouch::contact_distance})
            expect_same_bits(one.*field, other.*field);
    }
    ASSERT_EQ(a.moves.size(), b.moves.size());
    for (std::size_t row = 0; row < a.moves.size(); ++row) {
        EXPECT_EQ(a.moves[row].type, b.moves[row].type);
        EXPECT_EQ(a.moves[row].touch, b.moves[row].touch);
        ASSERT_EQ(a.moves[row].points.size(), b.moves[row].points.size());
        for (std::size_t i = 0; i < a.moves[row].points.size(); ++i)
            expect_same_bits(a.moves[row].points[i], b.moves[row].points[i]);
    }
    for (const auto size : {&ProbePlan::radius, &ProbePlan::scanner_error, &ProbePlan::clearance,
                            &ProbePlan::stylus_radius, &ProbePlan::stylus_length})
        expect_same_bits(a.*size, b.*size);
    expect_same_bits(a.machine_axis, b.machine_axis);
    EXPECT_EQ(a.dmis, b.dmis);
}

TEST(Probes, AsJsonText_AreReadBackBitForBit) { expect_equal(plan_of(parse_document(json_of(plan()).dump())), plan()); }

TEST(Probes, InAJsonFile_AreRecognised) {
    const std::string bytes = write_bytes("plan.json", std::make_shared<const ProbePlan>(plan()));
    const LoadedFile loaded = read_bytes(bytes, "plan.json");
    ASSERT_TRUE(loaded.value.find<ProbePlan>());
    expect_equal(*loaded.value.find<ProbePlan>(), plan());
}

TEST(Probes, AsCsv_HaveOneRowPerTouch) {
    ProbePlan probes = plan();
    probes.touches[0].position = Vec3(1, 2, 3);
    probes.touches[0].phi_min = -std::numbers::pi / 6;
    probes.touches[0].phi_max = std::numbers::pi / 4;
    probes.touches[0].phi_known_min = probes.touches[0].phi_known_max = ProbeTouch::nan;
    probes.touches[0].phi = 0;
    EXPECT_EQ(write_bytes("plan.csv", std::make_shared<const ProbePlan>(probes)),
              "# unit mm\n# frame machine\n"
              "touch,feature,x,y,z,i,j,k,order,reason,assumed,phi,phi-min,phi-max,phi-known-min,phi-known-max,"
              "interior-angle,start-x,start-y,start-z,centre-x,centre-y,centre-z,tangent-i,tangent-j,tangent-k,"
              "left-normal-i,left-normal-j,left-normal-k,right-normal-i,right-normal-j,right-normal-k,false-share,"
              "contact,contact-distance\n"
              "0,3,1,2,3,0,0.6,0.8,0,none,yes,0,-29.999999999999996,45,,,90,10,20,30,1,2,3,0,1,0,0,0,1,1,0,0,0.001,"
              "edge,0.25\n"
              "1,3,5,6,7,,,,,too-narrow,no,,,,,,229.1831180523293,,,,,,,0,1,0,0,0,1,1,0,0,,none,\n");
}

TEST(Probes, InAnotherUnit_HaveScaledLengths) {
    const Value metres = in_unit(std::make_shared<const ProbePlan>(plan()), LengthUnit::metre);
    const ProbePlan& probes = *metres.get<ProbePlan>();
    EXPECT_DOUBLE_EQ(probes.radius, 2e-3);
    EXPECT_DOUBLE_EQ(probes.stylus_length, 0.04);
    EXPECT_DOUBLE_EQ(probes.touches[0].start.z(), 0.03);
    EXPECT_DOUBLE_EQ(probes.touches[0].contact_distance, 2.5e-4);
    EXPECT_DOUBLE_EQ(probes.moves[0].points[0].z(), 9e-3);
    EXPECT_EQ(probes.touches[0].approach, Vec3(0, 0.6, 0.8));
    EXPECT_EQ(probes.touches[0].interior_angle, plan().touches[0].interior_angle);
}

TEST(Probes, Placed_HaveMovedPointsAndTurnedDirections) {
    RigidTransform pose;
    pose.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
    pose.translation = Vec3(100, 0, 0);
    pose.to = "room";
    const Value placed_plan = placed(std::make_shared<const ProbePlan>(plan()), pose);
    const ProbePlan& probes = *placed_plan.get<ProbePlan>();
    EXPECT_EQ(probes.frame.name, "room");
    const auto world = [&](const Vec3& p) { return Vec3(probes.frame.origin + p); };
    EXPECT_EQ(world(probes.touches[0].start), Vec3(80, 10, 30));
    EXPECT_EQ(world(probes.touches[0].centre), Vec3(98, 1, 3));
    EXPECT_EQ(world(probes.touches[1].position), Vec3(94, 5, 7));
    EXPECT_EQ(world(probes.moves[0].points[1]), Vec3(100, 1, 9));
    EXPECT_EQ(probes.touches[0].approach, Vec3(-0.6, 0, 0.8));
    EXPECT_EQ(probes.touches[0].tangent, Vec3(-1, 0, 0));
    EXPECT_EQ(probes.touches[0].left_normal, Vec3::UnitZ());
    EXPECT_EQ(probes.touches[0].right_normal, Vec3::UnitY());
    EXPECT_EQ(probes.machine_axis, Vec3(-0.6, 0, 0.8));
    EXPECT_EQ(probes.touches[1].approach, Vec3::Zero());
}

TEST(Probes, AtAnotherOrigin_KeepTheirWorldPositions) {
    const Frame frame{LengthUnit::millimetre, Vec3(100, -50, 0), "machine"};
    const Value moved = reframed(std::make_shared<const ProbePlan>(plan()), frame);
    const ProbePlan& probes = *moved.get<ProbePlan>();
    EXPECT_EQ(probes.touches[0].start, Vec3(-90, 70, 30));
    EXPECT_EQ(probes.touches[0].centre, Vec3(-99, 52, 3));
    EXPECT_EQ(probes.moves[0].points[2], Vec3(-90, 70, 30));
    EXPECT_EQ(probes.touches[0].approach, Vec3(0, 0.6, 0.8));
    EXPECT_EQ(positions_of(moved).size(), 3u * 2 + 5) << "points, starts, centres and the path";
}

TEST(Probes, HaveCounts) {
    const ProbePlan probes = plan();
    const Metrics properties = kind_of<ProbePlan>().info().properties(&probes);
    EXPECT_EQ(properties.find("touches")->value, 2);
    EXPECT_EQ(properties.find("unreachable")->value, 1);
}

TEST(ProbesRefuse, WhatIsNotUsable) {
    const auto refusal = [](const ProbePlan& probes) {
        return error_of([&] { kind_of<ProbePlan>().info().require_usable(&probes); }).sentence();
    };
    EXPECT_THAT(refusal({}), HasSubstr("no touches"));
    ProbePlan probes = plan();
    probes.moves[0].touch = 2;
    EXPECT_THAT(refusal(probes), HasSubstr("move 0 names touch 2; there are 2"));
}

TEST(ProbesRefuse, BrokenJson) {
    const auto refusal = [](auto&& change) {
        Json json = json_of(plan());
        change(json);
        return error_of([&] { plan_of(json); }).sentence();
    };
    const auto touch_refusal = [&](const char* member, const Json& value) {
        return refusal([&](Json& j) { j["touches"][0][member] = value; });
    };
    EXPECT_THAT(refusal([](Json& j) { j["touches"][0] = 1; }), HasSubstr("'touches[0]' is not an object"));
    EXPECT_THAT(touch_refusal("tangent", {1, 1, 0}), HasSubstr("'touches[0].tangent' has the length 1.41421"));
    EXPECT_THAT(touch_refusal("approach", nullptr), HasSubstr("'touches[0].approach' is not a list of 3"));
    EXPECT_THAT(refusal([](Json& j) {
                    j["touches"][1]["start"] = Json{0, 0, 0};
                }),
                HasSubstr("'touches[1].start' is not null"));
    EXPECT_THAT(touch_refusal("reason", "tired"),
                AllOf(HasSubstr("'touches[0].reason' is 'tired'"), HasSubstr("none, concave")));
    EXPECT_THAT(touch_refusal("contact", "x"), HasSubstr("'touches[0].contact' is 'x'"));
    EXPECT_THAT(touch_refusal("phi", "x"), HasSubstr("'touches[0].phi' is not a number"));
    EXPECT_THAT(touch_refusal("touch", -1), HasSubstr("'touches[0].touch' is not a whole number"));
    EXPECT_THAT(touch_refusal("assumed", 1), HasSubstr("'touches[0].assumed' is not true or false"));
    EXPECT_THAT(touch_refusal("contact-distance", -1), HasSubstr("'touches[0].contact-distance' is not a length"));
    EXPECT_THAT(refusal([](Json& j) { j["radius"] = -1; }), HasSubstr("'radius' is not a length"));
    EXPECT_THAT(refusal([](Json& j) { j.erase("radius"); }), HasSubstr("'radius' is missing"));
    EXPECT_THAT(refusal([](Json& j) { j["machine-axis"] = {0, 0, 2}; }), HasSubstr("'machine-axis' has the length 2"));
    EXPECT_THAT(refusal([](Json& j) { j["moves"][0]["touch"] = 2u; }), HasSubstr("move 0 names touch 2; there are 2"));
    EXPECT_THAT(refusal([](Json& j) { j["moves"][0]["type"] = "jump"; }), HasSubstr("'moves[0].type' is 'jump'"));
    EXPECT_THAT(refusal([](Json& j) { j["dmis"]["goto"] = "polar"; }), HasSubstr("'dmis.goto' is 'polar'"));
    EXPECT_THAT(refusal([](Json& j) { j["dmis"]["decimals"] = -1; }), HasSubstr("'dmis.decimals' is not a whole"));
    EXPECT_THAT(refusal([](Json& j) { j["moves"][1] = 1; }), HasSubstr("'moves[1]' is not an object"));
    EXPECT_THAT(refusal([](Json& j) { j["touch"] = 1; }),
                AllOf(HasSubstr("'touch' is unknown"), HasSubstr("did you mean 'touches'")));
}

}  // namespace
}  // namespace scanmill::test
