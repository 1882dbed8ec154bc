// SPDX-License-Identifier: GPL-3.0-or-later
/// Two patches end in two lines along one edge, which is touched once.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "filters/probe_planner/cases.hpp"
#include "region_grow/region_grow.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

/// Two half planes that meet in the y axis: z = 0 for x <= 0, x = 0 for z <= 0.
PointCloud two_planes(u32 steps) {
    Array<Vec3> points;
    for (u32 y = 0; y <= steps; ++y) {
        for (u32 x = 0; x <= steps; ++x) points.push_back(Vec3(-1.0 * x, y, 0));
        for (u32 z = 1; z <= steps; ++z) points.push_back(Vec3(0, y, -1.0 * z));
    }
    PointCloud cloud;
    cloud.positions = std::move(points);
    return cloud;
}

Planned planned_of(const PointCloud& cloud, double max_normal_angle) {
    RegionGrowParams params;
    params.max_normal_angle = Angle::degrees(max_normal_angle);
    Context context;
    const RegionGrowResult surface = region_grow(cloud, params, context);
    ProbePlannerParams probe = probe_of(0.5, 0.05, 1);
    probe.machine_axis = {1, 0, 1};
    return planned(surface.features, surface.mesh, probe);
}

bool is_on_edge(const ProbeTouch& touch) {
    return std::hypot(touch.position.x(), touch.position.z()) < 1e-9 && !touch.assumed;
}

TEST(ProbePlannerPairs, TwoPlanesAsTwoPatches_AreOneEdge) {
    const Planned two = planned_of(two_planes(20), 60);
    EXPECT_EQ(two.paired_lines, 1u);
    EXPECT_EQ(two.metrics.find("paired-lines")->value, 1);
    std::vector<double> along;
    for (const ProbeTouch& touch : two.plan.touches) {
        if (touch.assumed) {
            EXPECT_GT(std::hypot(touch.position.x(), touch.position.z()) +
                          std::min(touch.position.y(), 20 - touch.position.y()),
                      0.2);
            continue;
        }
        EXPECT_TRUE(is_on_edge(touch)) << touch.position.transpose();
        EXPECT_NEAR(std::abs(touch.tangent.y()), 1, 1e-9);
        EXPECT_NEAR(touch.interior_angle, pi / 2, 1e-9);
        along.push_back(touch.position.y());
    }
    // Once each: no two touches nearer than half a spacing.
    std::ranges::sort(along);
    ASSERT_GE(along.size(), 18u);
    for (std::size_t i = 1; i < along.size(); ++i) EXPECT_GT(along[i] - along[i - 1], 0.5);
}

TEST(ProbePlannerPairs, TwoPlanesAsOnePatch_HaveACreaseAndNoPair) {
    const Planned one = planned_of(two_planes(20), 100);
    EXPECT_EQ(one.paired_lines, 0u);
    // The 20 of the crease, and at most one at either end, where a triangle across the edge cuts off the corner.
    std::vector<double> along;
    for (const ProbeTouch& touch : one.plan.touches)
        if (is_on_edge(touch)) along.push_back(touch.position.y());
    std::ranges::sort(along);
    EXPECT_GE(along.size(), 20u);
    EXPECT_LE(along.size(), 22u);
    for (std::size_t i = 1; i < along.size(); ++i) EXPECT_GE(along[i] - along[i - 1], 0.5 - 1e-9);
}

TEST(ProbePlannerPairs, TheTwoRimsOfASlot_AreTwoEdges) {
    // Two tops beside each other, 0.5 apart; between them the surface goes down on both sides.
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const double left : {0.0, 5.5})
        for (const auto& p : box(Vec3(left, 0, 0), Vec3(left + 5, 20, 0.01), 4).positions) positions.push_back(p);
    const TriangleMesh one = box(Vec3(0, 0, 0), Vec3(5, 20, 0.01), 4);
    const auto half = static_cast<u32>(positions.size() / 2);
    for (const u32 first : {0u, half})
        for (const auto& [a, b, c] : one.triangles)
            if (positions[a].z() == 0.01 && positions[b].z() == 0.01 && positions[c].z() == 0.01)
                triangles.push_back({a + first, b + first, c + first});
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    FeatureGraph features = lines_of(mesh);
    const Buffer<Vec3> none = features.right_normals;
    for (const bool both : {true, false}) {
        Array<Vec3> right(none.begin(), none.end());
        std::size_t sides = 0;
        for (std::size_t i = 0; i < right.size(); ++i) {
            const double x = features.positions[features.vertices[i]].x();
            if (x != 5 && !(both && x == 5.5)) continue;
            right[i] = x == 5 ? Vec3::UnitX() : Vec3(-Vec3::UnitX());
            ++sides;
        }
        ASSERT_GT(sides, both ? 30u : 15u);
        features.right_normals = std::move(right);
        EXPECT_EQ(planned(features, mesh, probe_of(0.2, 0.01, 1)).paired_lines, 0u);
    }
}

/// The rows of two patches that end about 0.42 from an edge along y, with noise across their faces; the second face is
/// turned by `angle` from the first, the plane z = 0. Normals are those of triangles of edge length 1.
struct TwoRows {
    TriangleMesh mesh;
    FeatureGraph features;
};

TwoRows two_rows(double angle, double noise, std::uint64_t seed) {
    Random random(seed);
    constexpr u32 count = 400, rows = 4;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    const Vec3 down(std::cos(angle), 0, -std::sin(angle)),
        normals[2] = {Vec3::UnitZ(), Vec3(std::sin(angle), 0, std::cos(angle))};
    for (const int side : {0, 1}) {
        const auto first = static_cast<u32>(positions.size());
        for (u32 i = 0; i < count; ++i)
            for (u32 row = 0; row < rows; ++row) {
                const double off = row + random.uniform(0.1, 0.74), along = i + random.uniform(-0.3, 0.3);
                const Vec3 in_face = side == 0 ? Vec3(-off, along, 0) : Vec3(along * Vec3::UnitY() + off * down);
                positions.push_back(in_face + noise * random.normal() * normals[side]);
            }
        for (u32 i = 0; i + 1 < count; ++i)
            for (u32 row = 0; row + 1 < rows; ++row) {
                const u32 a = first + i * rows + row, b = a + rows;
                if (side == 0)
                    triangles.insert(triangles.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
                else
                    triangles.insert(triangles.end(), {{a, b + 1, b}, {a, a + 1, b + 1}});
            }
    }
    TwoRows result;
    result.mesh.positions = std::move(positions);
    result.mesh.triangles = std::move(triangles);
    result.features = lines_of(result.mesh, 180);
    // Beyond the edge is the other face, with the noise of a mean over a vertex.
    Array<Vec3> right(result.features.right_normals.begin(), result.features.right_normals.end());
    for (std::size_t i = 0; i < right.size(); ++i) {
        const Vec3& p = result.features.positions[result.features.vertices[i]];
        const FeaturePolyline& line =
            *std::ranges::find_if(result.features.polylines, [&](const FeaturePolyline& l) { return i < l.end; });
        const u32 next = i + 1 < line.end ? static_cast<u32>(i) + 1 : line.begin;
        const Vec3& q = result.features.positions[result.features.vertices[next]];
        if (std::max(std::hypot(p.x(), p.z()), std::hypot(q.x(), q.z())) > 0.9 || std::abs(q.y() - p.y()) < 0.2)
            continue;
        const bool is_first =
            result.features.left_normals[i].dot(normals[0]) > result.features.left_normals[i].dot(normals[1]);
        right[i] = normals[is_first ? 1 : 0];
    }
    result.features.right_normals = std::move(right);
    return result;
}

TEST(ProbePlannerPairs, RowsBesideAnEdge_GiveTheIntersectionOfTheFaces) {
    for (const double angle : {50.0, 90.0, 120.0})
        for (const double noise : {0.0, 0.02, 0.05, 0.1}) {
            const TwoRows rows = two_rows(angle * degree, noise, 7);
            ProbePlannerParams probe = probe_of(2, 0.8, 1);
            probe.max_tilt = Angle::degrees(180);
            const Planned result = planned(rows.features, rows.mesh, probe);
            EXPECT_EQ(result.paired_lines, 1u);
            std::vector<double> off;
            for (const ProbeTouch& touch : result.plan.touches)
                if (!touch.assumed && touch.position.y() > 5 && touch.position.y() < 395)
                    off.push_back(std::hypot(touch.position.x(), touch.position.z()));
            ASSERT_GT(off.size(), 350u);
            EXPECT_LT(off.size(), 420u) << "once, not along both lines";
            std::ranges::sort(off);
            EXPECT_LE(off[off.size() * 95 / 100], 4 * noise + 1e-9) << "angle " << angle << " noise " << noise;
        }
}

}  // namespace
}  // namespace scanmill::test
