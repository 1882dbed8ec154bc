// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Probe plans for the tests of DMIS.

#include <cmath>

#include "core/formats/support.hpp"
#include "formats/dmis_program.hpp"

namespace scanmill::test {

/// Adds a made touch at the world position, with a clearance move over a corner above it.
inline void add_touch(ProbePlan& plan, u32 number, const Vec3& position, const Vec3& approach, double distance) {
    ProbeTouch touch;
    touch.touch = number;
    touch.position = position - plan.frame.origin;
    touch.approach = approach.normalized();
    touch.tangent = Vec3::UnitY();
    touch.left_normal = Vec3::UnitZ();
    touch.right_normal = Vec3::UnitX();
    touch.start = touch.position + distance * touch.approach;
    touch.centre = touch.position + plan.radius * touch.approach;
    touch.order = 0;
    for (const ProbeTouch& one : plan.touches) touch.order += one.is_made();
    const auto row = static_cast<u32>(plan.touches.size());
    const Vec3 from = plan.moves.empty() ? Vec3(0, 0, 50) - plan.frame.origin : plan.moves.back().points.back();
    const Vec3 corner(from.x(), from.y(), touch.start.z() + 10);
    plan.moves.push_back({ProbeMoveType::clearance, row, {from, corner, touch.start}});
    plan.moves.push_back({ProbeMoveType::approach, row, {touch.start, touch.centre}});
    plan.moves.push_back({ProbeMoveType::retract, row, {touch.centre, touch.start}});
    plan.touches.push_back(touch);
}

inline void add_unmade(ProbePlan& plan, u32 number) {
    ProbeTouch touch;
    touch.touch = number;
    touch.reason = ProbeReason::concave;
    plan.touches.push_back(touch);
}

inline ProbePlan empty_plan() {
    ProbePlan plan;
    plan.frame = {LengthUnit::millimetre, Vec3::Zero(), "machine"};
    plan.radius = 1;
    plan.scanner_error = 0.25;
    plan.clearance = 2;
    plan.stylus_radius = 0.5;
    plan.stylus_length = 20;
    return plan;
}

/// One touch from above.
inline ProbePlan one_touch() {
    ProbePlan plan = empty_plan();
    add_touch(plan, 12, Vec3(1, 2, 3), Vec3::UnitZ(), 5);
    return plan;
}

/// Many touches with all digits, from both sides, in an order that is not the order of rows; some are not made.
inline ProbePlan many_touches() {
    ProbePlan plan = empty_plan();
    plan.frame.origin = Vec3(4000, -300, 0.1);
    plan.machine_axis = Vec3(0.1, -0.2, 0.9).normalized();
    for (u32 i = 0; i < 20; ++i) {
        const double t = 0.37 * i;
        const Vec3 position(4000 + 1000 * t / 3, -300 - 7 * t * t, 1.0 / (i + 3.0));
        add_touch(plan, i, position, Vec3(1, t - 3, 2), 6 + t);
        if (i % 3 == 0) add_touch(plan, i, position, Vec3(-1, 3 - t, 2), 6.5 + t);
        if (i % 5 == 4) add_unmade(plan, 100 + i);
    }
    // The machine makes the touches backwards.
    u32 made = 0;
    for (const ProbeTouch& touch : plan.touches) made += touch.is_made();
    for (ProbeTouch& touch : plan.touches)
        if (touch.is_made()) touch.order = made - 1 - touch.order;
    return plan;
}

inline std::string program_of(const ProbePlan& plan, Warnings* warnings = nullptr) {
    return write_bytes("plan.dmi", std::make_shared<const ProbePlan>(plan),
                       warnings ? warnings->writing() : WriteOptions{});
}

}  // namespace scanmill::test
