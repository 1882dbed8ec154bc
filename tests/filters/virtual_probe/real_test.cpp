// SPDX-License-Identifier: GPL-3.0-or-later
/// A machined part: its creases are planned and probed, in its own frame and in a machine's.
#include <gmock/gmock.h>

#include "apply_transform/apply_transform.hpp"
#include "features/features.hpp"
#include "filters/align/cases.hpp"
#include "probe_planner/probe_planner.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"
#include "virtual_probe/virtual_probe.hpp"

namespace scanmill::test {
namespace {

Value in_machine(auto object, const RigidTransform& motion) {
    Context context;
    return apply_transform(Value(std::make_shared<const decltype(object)>(std::move(object))), motion, context);
}

TEST(VirtualProbeReal, Fandisk_IsMeasuredAtItsEdges_InEveryFrame) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/fandisk_large.off");
    const auto mesh = read_mesh(path);
    const double diagonal = surface_box(*mesh).diagonal(), radius = 0.01 * diagonal;
    Context context;
    FeatureLines lines = features(*mesh, {}, context);
    ProbePlannerParams params;
    params.radius = radius;
    params.scanner_error = 0.2 * radius;
    params.spacing = 0.02 * diagonal;
    params.max_tilt = Angle::degrees(180);
    const ProbePlan plan = probe_planner(lines.graph, *mesh, params, context).plan;
    VirtualProbeParams errors;
    errors.reference_error = params.scanner_error;
    const VirtualProbeResult here = virtual_probe(plan, *mesh, errors, context);
    ASSERT_GT(here.points.size(), 100u);
    EXPECT_EQ(here.missed, 0u);
    // The point is off by at most the error across and by r - sqrt(r² - error²) along; an edge that turns adds to it.
    for (std::size_t i = 0; i < here.points.size(); ++i) {
        const ProbeTouch& touch = plan.touches[here.rows[i]];
        EXPECT_LT((here.points.positions[i] - touch.position).norm(), 0.5 * radius) << here.rows[i];
    }

    Random random(1);
    RigidTransform motion = random_motion(random, 10 * diagonal);
    motion.to = "machine";
    const auto there = virtual_probe(*in_machine(plan, motion).get<ProbePlan>(),
                                     *in_machine(*mesh, motion).get<TriangleMesh>(), errors, context);
    ASSERT_EQ(there.rows, here.rows);
    for (std::size_t i = 0; i < here.points.size(); ++i)
        EXPECT_LT((there.points.frame.origin + there.points.positions[i] -
                   motion.apply(here.points.frame.origin + here.points.positions[i]))
                      .norm(),
                  1e-6 * radius);
}

}  // namespace
}  // namespace scanmill::test
