// SPDX-License-Identifier: GPL-3.0-or-later
/// Scans with known edges: the block with five holes, and a machined part.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "filters/probe_planner_cases.hpp"
#include "region_grow/region_grow.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "support/real_data.hpp"
#include "virtual_scan/virtual_scan.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::test {
namespace {

RegionGrowResult surface_of(const TriangleMesh* mesh, const VirtualScanParams& scan, double voxel,
                            const RegionGrowParams& growing = {}) {
    Context context;
    const PointCloud points = virtual_scan(mesh, scan, context).points;
    VoxelThinParams thinning;
    thinning.bin_size = Length(voxel);
    return region_grow(voxel_thin(points, thinning, context).points, growing, context);
}

/// Seen from above: 88 x 95 x 41, a hole of radius 21 in the middle and four of radius 5.
const RegionGrowResult& block() {
    static const RegionGrowResult result = [] {
        VirtualScanParams scan;
        scan.shape = VirtualScanParams::Shape::holed_block;
        scan.size = {88., 95., 41., 21., 5.};
        scan.views = {0, 0, 1};
        scan.resolution = 0.25;
        return surface_of(nullptr, scan, 1);
    }();
    return result;
}

struct Rim {
    double x, y, radius;
};
const std::vector<Rim> rims{{0, 0, 21},
                            {0.35 * 88, 0.35 * 95, 5},
                            {-0.35 * 88, 0.35 * 95, 5},
                            {0.35 * 88, -0.35 * 95, 5},
                            {-0.35 * 88, -0.35 * 95, 5}};

const Rim& rim_of(const Vec3& point) {
    return *std::ranges::min_element(rims, {}, [&](const Rim& rim) {
        return std::abs(std::hypot(point.x() - rim.x, point.y() - rim.y) - rim.radius);
    });
}

ProbePlannerParams holes_only(double radius, double error) {
    ProbePlannerParams params = probe_of(radius, error, 1.3);
    params.features = ProbePlannerParams::Features::holes;
    return params;
}

TEST(ProbePlannerReal, BlockWithFiveHoles_EveryRimIsPlannedWithinTheError) {
    const RegionGrowResult& surface = block();
    const Planned result = planned(surface.features, surface.mesh, holes_only(2, 1));
    EXPECT_GT(result.plan.touches.size(), 180u);
    EXPECT_EQ(result.assumed, result.plan.touches.size());
    EXPECT_EQ(result.unreachable, 0u);
    EXPECT_EQ(result.false_touches, 0u);
    EXPECT_EQ(result.wrong_contacts, 0u);
    EXPECT_LT(result.edge_roughness, 1);
    EXPECT_GT(result.edge_roughness, 0.05);
    for (const ProbeTouch& touch : result.plan.touches) {
        EXPECT_EQ(touch.interior_angle, pi / 2);
        EXPECT_NEAR(touch.range.max / degree, 15, 1e-9);
        EXPECT_EQ(touch.contact, ProbeContact::edge);
        const Vec3 p = touch.position + result.plan.frame.origin;
        const Rim& rim = rim_of(p);
        EXPECT_LE(std::abs(std::hypot(p.x() - rim.x, p.y() - rim.y) - rim.radius), 1) << p.transpose();
        EXPECT_NEAR(p.z(), 20.5, 1e-6);
        // The approach leads over the hole: within the plane across the edge.
        const Vec3 inwards = Vec3(rim.x - p.x(), rim.y - p.y(), 0).normalized();
        EXPECT_GT(touch.right_normal.dot(inwards), 0.8);
    }
}

TEST(ProbePlannerReal, BlockWithFiveHoles_TouchesMeetTheTrueRims) {
    // The ball against the true block, whose rim is a circle: it meets the rim before the opposite rim and the wall.
    const RegionGrowResult& surface = block();
    ProbePlannerParams params = holes_only(2, 1);
    params.directions = 2;
    const Planned result = planned(surface.features, surface.mesh, params);
    EXPECT_EQ(result.unreachable, 0u);
    std::size_t pairs = 0;
    for (const ProbeTouch& touch : result.plan.touches) {
        const Rim& rim = rim_of(touch.position + result.plan.frame.origin);
        const Vec3 middle(rim.x, rim.y, 20.5);
        pairs += touch.phi > 0;
        for (double s = 11; s > -3; s -= 0.001) {
            const Vec3 c = touch.position + result.plan.frame.origin + s * touch.approach - middle;
            const double across = std::hypot(c.x(), c.y());
            const double to_rim = std::hypot(across - rim.radius, c.z());
            const double to_top = across >= rim.radius ? c.z() : 1e9, to_wall = c.z() <= 0 ? rim.radius - across : 1e9;
            ASSERT_GT(to_top, 2 - 0.002) << "meets the top first";
            ASSERT_GT(to_wall, 2 - 0.002) << "meets the wall first";
            if (to_rim > 2) continue;
            const Vec3 contact = rim.radius * Vec3(c.x(), c.y(), 0) / across + middle;
            EXPECT_LE((contact - touch.position - result.plan.frame.origin).norm(), 1.5)
                << "near the reference point, " << touch.position.transpose();
            break;
        }
    }
    EXPECT_EQ(2 * pairs, result.plan.touches.size()) << "27 degrees remain between two approaches everywhere";
}

TEST(ProbePlannerReal, BlockWithFiveHoles_LargeBallsDoNotPassTheSmallHoles) {
    const RegionGrowResult& surface = block();
    for (const double radius : {8.0, 12.0}) {
        const Planned result = planned(surface.features, surface.mesh, holes_only(radius, 1));
        for (const ProbeTouch& touch : result.plan.touches)
            EXPECT_EQ(touch.reason, rim_of(touch.position + result.plan.frame.origin).radius == 5
                                        ? ProbeReason::too_narrow
                                        : ProbeReason::none);
        EXPECT_GT(result.too_narrow, 50u);
    }
}

/// The sharp edges of a mesh, as segments.
TriangleTree sharp_edges_of(const TriangleMesh& mesh) {
    const FeatureGraph lines = lines_of(mesh);
    Array<Triangle> segments;
    for (const FeaturePolyline& line : lines.polylines)
        for (u32 i = line.begin; i + (line.closed ? 0 : 1) < line.end; ++i) {
            const u32 next = i + 1 < line.end ? i + 1 : line.begin;
            segments.push_back({lines.vertices[i], lines.vertices[i], lines.vertices[next]});
        }
    return TriangleTree(lines.positions.span(), segments, 1);
}

TEST(ProbePlannerReal, MachinedPart_EveryPlannedTouchIsWithinTheErrorOfATrueEdge) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/fandisk_large.off");
    const auto part = read_mesh(path);
    const double diagonal = bounding_box(part->positions.span()).diagonal();
    VirtualScanParams scan;
    scan.views = {20};
    scan.resolution = 0.002 * diagonal;
    const TriangleTree edges = sharp_edges_of(*part);
    // Within one patch, and with patches that end at sharp edges, up to 1.5 voxels before them.
    for (const double angle : {90.0, 40.0}) {
        RegionGrowParams growing;
        growing.max_normal_angle = Angle::degrees(angle);
        const RegionGrowResult surface = surface_of(part.get(), scan, 0.005 * diagonal, growing);
        const Planned result =
            planned(surface.features, surface.mesh, probe_of(0.01 * diagonal, 0.005 * diagonal, 0.01 * diagonal));
        EXPECT_GT(result.plan.touches.size(), result.unreachable + 200);
        EXPECT_EQ(result.false_touches, 0u);
        EXPECT_EQ(result.wrong_contacts, 0u);
        EXPECT_EQ(result.unreachable, result.concave + result.too_narrow + result.too_tilted + result.obstructed);
        std::size_t beyond = 0;
        for (const ProbeTouch& touch : result.plan.touches) {
            EXPECT_EQ(touch.reason == ProbeReason::none, touch.approach != Vec3::Zero());
            if (touch.reason != ProbeReason::none) continue;
            const double distance =
                std::sqrt(edges.nearest(touch.position + result.plan.frame.origin).squared_distance);
            // At corners of patches the border is farther from the edge, and the second face may remain unknown.
            beyond += distance > result.plan.scanner_error;
            EXPECT_LE(distance, (touch.assumed ? 1.15 : 1) * result.plan.scanner_error);
            EXPECT_EQ(touch.false_share, 0);
            EXPECT_EQ(touch.contact, ProbeContact::edge);
        }
        EXPECT_LE(beyond, angle == 40 ? 2u : 0u);
    }
}

TEST(ProbePlannerReal, MachinedPartItself_IsPlannedWithReasons) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/fandisk_large.off");
    const auto part = read_mesh(path);
    const double diagonal = bounding_box(part->positions.span()).diagonal();
    const ProbePlannerParams params = probe_of(0.005 * diagonal, 0.0005 * diagonal, 0.002 * diagonal);
    const Planned result = planned(*part, params);
    EXPECT_GT(result.plan.touches.size(), 4000u);
    EXPECT_GT(result.plan.touches.size() - result.unreachable, 1500u);
    EXPECT_EQ(result.false_touches, 0u);
    EXPECT_EQ(result.wrong_contacts, 0u);
    const auto bytes = [](const ProbePlan& plan) {
        return write_bytes("a.json", std::make_shared<const ProbePlan>(plan));
    };
    EXPECT_EQ(bytes(planned(*part, params, 1).plan), bytes(result.plan));
}

}  // namespace
}  // namespace scanmill::test
