// SPDX-License-Identifier: GPL-3.0-or-later
/// Scans with known edges: the block with five holes, and a machined part.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "filters/probe_planner/cases.hpp"
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
        EXPECT_NEAR(touch.phi_max / degree, 15, 1e-9);
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
        bool is_met = false;
        for (double s = 11; s > -3; s -= 0.001) {
            const Vec3 c = touch.position + result.plan.frame.origin + s * touch.approach - middle;
            const double across = std::hypot(c.x(), c.y());
            const double to_rim = std::hypot(across - rim.radius, c.z());
            const double to_top = across >= rim.radius ? c.z() : 1e9, to_wall = c.z() <= 0 ? rim.radius - across : 1e9;
            ASSERT_GT(to_top, 2 - 0.002) << "meets the top first";
            ASSERT_GT(to_wall, 2 - 0.002) << "meets the wall first";
            if (to_rim > 2) continue;
            const Vec3 contact = rim.radius * Vec3(c.x(), c.y(), 0) / across + middle;
            const Vec3 off = contact - touch.position - result.plan.frame.origin;
            EXPECT_LE(off.norm(), 1.5) << "near the reference point, " << touch.position.transpose();
            EXPECT_LE((off - touch.tangent.dot(off) * touch.tangent).norm(), 1) << "across the edge";
            is_met = true;
            break;
        }
        EXPECT_TRUE(is_met) << touch.position.transpose();
    }
    EXPECT_EQ(2 * pairs, result.plan.touches.size()) << "27 degrees remain between two approaches everywhere";
}

/// An edge as it is: a point of it, and the unit vectors there.
struct TrueEdge {
    Vec3 point, tangent, left_normal, right_normal;
};

double distance_across(const TrueEdge& edge, const Vec3& point) {
    const Vec3 off = point - edge.point;
    return (off - edge.tangent.dot(off) * edge.tangent).norm();
}

/// For 1,000 random positions of T within the error of the true edge: how often a circle that moves along the
/// planned approach meets a true face before the edge. Does not use the planner's closed form, angles or normals.
int faces_met_first(const ProbePlan& plan, const ProbeTouch& touch, const TrueEdge& edge, Random& random) {
    const Vec3 bisector = (edge.left_normal + edge.right_normal).normalized(), x = edge.tangent.cross(bisector);
    const double phi = std::atan2(-touch.approach.dot(x), touch.approach.dot(bisector));
    const Wedge wedge{pi - std::acos(std::clamp(edge.left_normal.dot(edge.right_normal), -1.0, 1.0)), plan.radius};
    int faces = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        const double t = plan.scanner_error * std::sqrt(random.uniform()), theta = random.uniform(0, 2 * pi);
        faces += !(lead_of_edge(wedge, phi, {t * std::sin(theta), t * std::cos(theta)}) > 0);
    }
    return faces;
}

TEST(ProbePlannerReal, BlockWithFiveHoles_ASweptBallMeetsTheTrueEdgeFirst) {
    const RegionGrowResult& surface = block();
    const Planned result = planned(surface.features, surface.mesh, holes_only(2, 1));
    Random random(1);
    for (const ProbeTouch& touch : result.plan.touches) {
        ASSERT_EQ(touch.reason, ProbeReason::none);
        const Vec3 p = touch.position + result.plan.frame.origin;
        const Rim& rim = rim_of(p);
        const Vec3 inwards = Vec3(rim.x - p.x(), rim.y - p.y(), 0).normalized();
        const Vec3 point = Vec3(rim.x, rim.y, 20.5) - rim.radius * inwards;
        const TrueEdge edge{point, Vec3::UnitZ().cross(inwards), Vec3::UnitZ(), inwards};
        EXPECT_LE(distance_across(edge, p), 1);
        EXPECT_EQ(faces_met_first(result.plan, touch, edge, random), 0) << p.transpose();
    }
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

TEST(ProbePlannerReal, DoubleCone_ASweptBallMeetsTheTrueEdgeFirst) {
    // Radius and height 20, from all sides.
    VirtualScanParams scan;
    scan.shape = VirtualScanParams::Shape::bicone;
    scan.size = {20., 20.};
    scan.views = {-1, -1, -1, -1, -1, 1, -1, 1, -1, -1, 1, 1, 1, -1, -1, 1, -1, 1, 1, 1, -1, 1, 1, 1};
    scan.resolution = 0.1;
    const RegionGrowResult surface = surface_of(nullptr, scan, 0.4);
    const double error = 0.4 * 0.4 + 1.5 * 0.1;  // errors of the voxels and of the scan points, as the page gives them
    ProbePlannerParams params = probe_of(1, error, 2);
    params.max_tilt = Angle::degrees(180);
    const Planned result = planned(surface.features, surface.mesh, params);
    Random random(2);
    std::size_t simulated = 0;
    for (const ProbeTouch& touch : result.plan.touches) {
        const Vec3 p = touch.position + result.plan.frame.origin;
        if (std::abs(p.z()) > 1 || touch.reason != ProbeReason::none) continue;  // at a tip
        const Vec3 outwards = Vec3(p.x(), p.y(), 0).normalized();
        const Vec3 up = (outwards + Vec3::UnitZ()).normalized(), down = (outwards - Vec3::UnitZ()).normalized();
        const bool is_up_left = touch.left_normal.z() > 0;
        const Vec3 &left = is_up_left ? up : down, &right = is_up_left ? down : up;
        const TrueEdge edge{20 * outwards, left.cross(right).normalized(), left, right};
        EXPECT_LE(distance_across(edge, p), error) << p.transpose();
        EXPECT_EQ(faces_met_first(result.plan, touch, edge, random), 0) << p.transpose();
        ++simulated;
    }
    EXPECT_GT(simulated, 50u);
}

/// The sharp edges of a mesh.
class SharpEdges {
public:
    explicit SharpEdges(const TriangleMesh& mesh) : lines_(lines_of(mesh)) {
        Array<Triangle> segments;
        for (const FeaturePolyline& line : lines_.polylines)
            for (u32 i = line.begin; i + (line.closed ? 0 : 1) < line.end; ++i) {
                const u32 next = i + 1 < line.end ? i + 1 : line.begin;
                segments.push_back({lines_.vertices[i], lines_.vertices[i], lines_.vertices[next]});
                rows_.push_back(i);
            }
        tree_.emplace(lines_.positions.span(), segments, 1);
    }

    double distance(const Vec3& point) const { return std::sqrt(tree_->nearest(point).squared_distance); }

    TrueEdge nearest(const Vec3& point) const {
        const NearestTriangle found = tree_->nearest(point);
        const auto& corners = tree_->corners(found.slot);
        const u32 row = rows_[found.triangle];
        return {tree_->nearest_point(point, found.slot), (corners[2] - corners[0]).normalized(),
                lines_.left_normals[row], lines_.right_normals[row]};
    }

private:
    FeatureGraph lines_;
    std::vector<u32> rows_;  ///< rows where the segments start in the lines
    std::optional<TriangleTree> tree_;
};

/// Moves the ball along the planned approach against the part itself, for 1,000 random positions of T within the error
/// of the true edge. Returns the largest distance from a sharp edge to the contact; infinite if the ball misses.
double farthest_contact(const TriangleTree& part, const ProbePlan& plan, const ProbeTouch& touch,
                        const SharpEdges& edges, Random& random) {
    const double radius = plan.radius, error = plan.scanner_error, retract = (touch.start - touch.position).norm();
    const TrueEdge edge = edges.nearest(touch.position + plan.frame.origin);
    const Vec3 x = edge.tangent.unitOrthogonal(), y = edge.tangent.cross(x);
    double farthest = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        const double t = error * std::sqrt(random.uniform()), theta = random.uniform(0, 2 * pi);
        const Vec3 position = edge.point + t * (std::cos(theta) * x + std::sin(theta) * y);
        u32 hint = NearestTriangle::none;
        double s = retract, gap = 1;
        while (s > -(radius + error)) {
            const NearestTriangle nearest = part.nearest(position + s * touch.approach, hint);
            hint = nearest.slot;
            gap = std::sqrt(nearest.squared_distance) - radius;
            if (gap < 1e-6 * radius) break;
            s -= std::max(gap, 1e-5 * radius);
        }
        if (!(gap < 1e-6 * radius)) return std::numeric_limits<double>::infinity();
        farthest = std::max(farthest, edges.distance(part.nearest_point(position + s * touch.approach, hint)));
    }
    return farthest;
}

TEST(ProbePlannerReal, MachinedPart_EveryPlannedTouchIsWithinTheErrorOfATrueEdge) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/fandisk_large.off");
    const auto part = read_mesh(path);
    const double diagonal = bounding_box(part->positions.span()).diagonal();
    VirtualScanParams scan;
    scan.views = {20};
    scan.resolution = 0.002 * diagonal;
    const SharpEdges edges(*part);
    const TriangleTree part_tree(part->positions.span(), part->triangles.span(), 1);
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
        Random random(3);
        for (const ProbeTouch& touch : result.plan.touches) {
            EXPECT_EQ(touch.reason == ProbeReason::none, touch.approach != Vec3::Zero());
            if (touch.reason != ProbeReason::none) continue;
            const Vec3 p = touch.position + result.plan.frame.origin;
            const double distance = edges.distance(p);
            // At corners of patches the border is farther from the edge, and the second face may remain unknown.
            beyond += distance > result.plan.scanner_error;
            EXPECT_LE(distance, (touch.assumed ? 1.15 : 1) * result.plan.scanner_error);
            EXPECT_EQ(touch.false_share, 0);
            EXPECT_EQ(touch.contact, ProbeContact::edge);
            // With the second face assumed, and the border up to 1.5 voxels before the edge, the error is larger.
            if (touch.assumed) continue;
            EXPECT_LE(farthest_contact(part_tree, result.plan, touch, edges, random), result.plan.scanner_error);
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
