// SPDX-License-Identifier: GPL-3.0-or-later
#include "virtual_probe/virtual_probe.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "probe_planner/probe_planner.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

namespace {

/// Largest gap between ball and mesh that counts as contact, as a share of the radius.
constexpr double contact = 1e-9;
/// A ball that still moves after so many steps slides along a face, nearer than 1e-4 radii. This counts as contact,
/// too.
constexpr int most_steps = 100'000;

/// A larger share of missed touches suggests that plan and mesh are of different parts or in different positions.
constexpr double most_missed = 0.1;

/// Returns the centre of the ball at its first contact with the mesh. The centre moves by `length` from `start` along
/// `motion`. Empty without contact, or if the ball meets the mesh at `start`. In sphere tracing, each step is as long
/// as the ball's distance from the mesh.
std::optional<Vec3> met(const TriangleTree& mesh, const Vec3& start, const Vec3& motion, double length, double radius) {
    u32 hint = NearestTriangle::none;
    double travelled = 0;
    for (int step = 0; travelled <= length; ++step) {
        const Vec3 centre = start + travelled * motion;
        const NearestTriangle nearest = mesh.nearest(centre, hint);
        hint = nearest.slot;
        const double gap = std::sqrt(nearest.squared_distance) - radius;
        if (gap <= contact * radius || step == most_steps) {
            if (travelled == 0) return {};
            return centre + std::max(gap, 0.0) * motion;
        }
        travelled += gap;
    }
    return {};
}

/// A random point, uniform in the unit disc. It is found without angles, whose sines differ between processors.
Eigen::Vector2d in_disc(Random& random) {
    for (;;) {
        const Eigen::Vector2d p(random.uniform(-1, 1), random.uniform(-1, 1));
        if (p.squaredNorm() <= 1) return p;
    }
}

/// Returns the reported position of a touch; empty if the touch is missed.
std::optional<Vec3> reported(const ProbePlan& plan, const ProbeTouch& touch, const TriangleTree& mesh,
                             double reference_error, double noise, Random random) {
    const Vec3& u = touch.approach;
    Vec3 shift = Vec3::Zero();
    if (reference_error > 0) {
        const Eigen::Vector2d offset = reference_error * in_disc(random);
        shift = offset.x() * u + offset.y() * touch.tangent.cross(u).normalized();
    }
    const double retracted = (touch.start - touch.position).dot(u);
    const std::optional<Vec3> centre =
        met(mesh, touch.start + shift, -u, retracted + plan.radius + plan.scanner_error, plan.radius);
    if (!centre) return {};
    Vec3 error = Vec3::Zero();
    if (noise > 0)
        for (double& coordinate : error) coordinate = noise * random.normal();
    return *centre + error - plan.radius * u;
}

// Checks of the input.

double length_of(const Length& length, std::string_view name) {
    const double value = length.value();
    if (!(value >= 0) || !std::isfinite(value))
        throw Error("{} is {} u; it must be 0 or more", name, value).hint("give a finite length, 0 u for none");
    return value;
}

/// Returns the rows of the touches that are made, in their order.
std::vector<u32> made_touches(const ProbePlan& plan) {
    std::vector<u32> rows;
    for (u32 row = 0; row < plan.touches.size(); ++row)
        if (plan.touches[row].reason == ProbeReason::none) rows.push_back(row);
    if (rows.empty())
        throw Error("the plan has {}, of which none is made", count_text(plan.touches.size(), "touch", "touches"))
            .hint(plan.touches.empty() ? "plan with other features, or with a smaller spacing"
                                       : "the touches' `reason` gives the cause; " + way_out(plan.touches));
    std::ranges::stable_sort(rows, {}, [&](u32 row) { return plan.touches[row].order; });
    return rows;
}

void require_directions(const ProbePlan& plan, std::span<const u32> rows) {
    constexpr double most = 1e-4;  // allows for the rounding of numbers in files
    for (const u32 row : rows) {
        const ProbeTouch& touch = plan.touches[row];
        if (!touch.position.allFinite() || !touch.start.allFinite())
            throw Error("the reference point or the start of the plan's touch in row {} is not finite", row)
                .hint("plan again with `probe-planner`");
        if (!(std::abs(touch.approach.norm() - 1) <= most) || !(touch.tangent.cross(touch.approach).norm() >= 0.5))
            throw Error(
                "the touch in row {} has an approach of length {:.6g}, and its cross product with the tangent has the "
                "length {:.4g}; a unit vector across the edge is needed",
                row, touch.approach.norm(), touch.tangent.cross(touch.approach).norm())
                .hint("plan again with `probe-planner`");
    }
}

void require_plan(const ProbePlan& plan, const TriangleMesh& mesh) {
    if (!(plan.radius > 0) || !std::isfinite(plan.radius))
        throw Error("the plan's ball has the radius {} u; it must be above 0", plan.radius)
            .hint("plan again with `probe-planner`");
    require_same_frame(plan.frame, "the plan is", mesh.frame, "the mesh");
}

void require_guided(double reference_error, double radius) {
    if (!(reference_error < radius))
        throw Error(
            "reference-error is {} u and the plan's ball has the radius {} u: the ball must be larger than the error "
            "to meet the edge first",
            number_text(reference_error), number_text(radius))
            .hint("use a smaller reference-error, or plan with a larger ball");
}

void report(const VirtualProbeResult& result, std::size_t made, Context& context) {
    context.metric("points", static_cast<double>(result.points.size()));
    context.metric("missed", static_cast<double>(result.missed));
    const double share = static_cast<double>(result.missed) / static_cast<double>(made);
    if (share > most_missed)
        context.doubt(fmt::format(
            "{} of {} touches ({:.0f} %) missed the mesh: check that the plan is of this part, and in its position",
            result.missed, made, 100 * share));
}

TriangleTree tree_of(const TriangleMesh& mesh, const Frame& frame, unsigned threads) {
    require_triangles(mesh, "the ball needs at least 1 to touch");
    const Buffer<Vec3> positions = translated(mesh.positions, mesh.frame.origin - frame.origin);
    return TriangleTree(positions.span(), mesh.triangles.span(), threads);
}

}  // namespace

VirtualProbeResult virtual_probe(const ProbePlan& plan, const TriangleMesh& mesh, const VirtualProbeParams& params,
                                 Context& context) {
    const double noise = length_of(params.noise, "noise");
    const double reference_error = length_of(params.reference_error, "reference-error");
    require_plan(plan, mesh);
    require_guided(reference_error, plan.radius);
    const std::vector<u32> made = made_touches(plan);
    require_directions(plan, made);
    const TriangleTree tree = tree_of(mesh, plan.frame, context.threads());
    context.progress(0.2);

    std::vector<std::optional<Vec3>> positions(made.size());
    std::atomic<std::size_t> done = 0;
    const Random random = context.random();
    constexpr std::size_t chunk = 64;
    for_each_chunk(context.threads(), made.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i)
            positions[i] = reported(plan, plan.touches[made[i]], tree, reference_error, noise, random.stream(made[i]));
        context.progress(0.2 + 0.8 * static_cast<double>(done += end - begin) / static_cast<double>(made.size()));
    });

    VirtualProbeResult result;
    Array<Vec3> points;
    Array<double> uncertainty, approach;
    Array<u32> touch, feature;
    for (std::size_t i = 0; i < made.size(); ++i) {
        if (!positions[i]) continue;
        const ProbeTouch& row = plan.touches[made[i]];
        result.rows.push_back(made[i]);
        points.push_back(*positions[i]);
        uncertainty.push_back(noise);
        touch.push_back(row.touch);
        feature.push_back(row.feature);
        approach.insert(approach.end(), row.approach.begin(), row.approach.end());
    }
    result.missed = made.size() - result.rows.size();
    if (points.empty())
        throw Error("{} missed the mesh",
                    made.size() == 1 ? "the only touch" : fmt::format("all {} touches", made.size()))
            .hint("the plan and the mesh must be of one part, in one position; `apply-transform` moves either");
    result.points.frame = plan.frame;
    result.points.positions = std::move(points);
    ColumnTable& columns = result.points.columns;
    columns.add(Column("uncertainty", 1, Buffer<double>(std::move(uncertainty))).with_length_exponent(1));
    columns.add(Column("touch", 1, Buffer<u32>(std::move(touch))));
    columns.add(Column("feature", 1, Buffer<u32>(std::move(feature))));
    columns.add(Column("approach", 3, Buffer<double>(std::move(approach))));
    report(result, made.size(), context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
