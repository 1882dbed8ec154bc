// SPDX-License-Identifier: GPL-3.0-or-later
/// A block with five holes is scanned, planned, touched and compensated; its edges are known.

#include <gmock/gmock.h>

#include "filters/probe_compensate/cases.hpp"
#include "probe_planner/probe_planner.hpp"
#include "region_grow/region_grow.hpp"
#include "virtual_probe/virtual_probe.hpp"
#include "virtual_scan/virtual_scan.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::test {
namespace {

/// The block's upper face and the walls below it. Rims are polygons, up to 5e-5 beside the circles.
class Block {
public:
    static constexpr double x = 44, y = 47.5, z = 20.5, large = 21, small = 5, small_x = 30.8, small_y = 33.25;
    static constexpr double sagitta = 5.1e-5;

    static TriangleMesh mesh() {
        Block block;
        const std::vector<double> xs{-x, -36.8, -24.8, -22, 22, 24.8, 36.8, x},
            ys{-y, -39.25, -27.25, -22, 22, 27.25, 39.25, y};
        for (std::size_t i = 0; i < 7; ++i)
            for (std::size_t j = 0; j < 7; ++j) {
                const bool is_large = i == 3 && j == 3, is_small = i % 4 == 1 && j % 4 == 1;
                if (is_large || is_small)
                    block.add_holed({(xs[i] + xs[i + 1]) / 2, (ys[j] + ys[j + 1]) / 2, z}, (xs[i + 1] - xs[i]) / 2,
                                    is_large ? large : small);
                else
                    block.add_quad({xs[i], ys[j], z}, {xs[i + 1], ys[j], z}, {xs[i + 1], ys[j + 1], z},
                                   {xs[i], ys[j + 1], z});
            }
        const std::vector<Vec3> corners{{-x, -y, z}, {x, -y, z}, {x, y, z}, {-x, y, z}};
        for (std::size_t i = 0; i < 4; ++i) block.add_wall(corners[i], corners[(i + 1) % 4]);
        TriangleMesh mesh;
        mesh.positions = std::move(block.positions_);
        mesh.triangles = std::move(block.triangles_);
        return mesh;
    }

    /// The distance of a point from the nearest upper edge.
    static double to_edge(const Vec3& p) {
        const double height = p.z() - z, ax = std::abs(p.x()), ay = std::abs(p.y());
        return std::min({std::hypot(std::hypot(p.x(), p.y()) - large, height),
                         std::hypot(std::hypot(ax - small_x, ay - small_y) - small, height),
                         std::hypot(ax - x, height, std::max(ay - y, 0.0)),
                         std::hypot(ay - y, height, std::max(ax - x, 0.0))});
    }

private:
    void add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
        const auto first = static_cast<u32>(positions_.size());
        positions_.insert(positions_.end(), {a, b, c, d});
        triangles_.insert(triangles_.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
    }
    void add_wall(const Vec3& from, const Vec3& to) {
        const Vec3 down(0, 0, -2 * z);
        add_quad(from + down, to + down, to, from);
    }
    /// A square with a hole in it.
    void add_holed(const Vec3& centre, double half, double radius) {
        constexpr int sides = 1440;  // a multiple of eight has the corners of the square
        std::vector<Vec3> inner, outer;
        for (int i = 0; i <= sides; ++i) {
            const double angle = 2 * std::numbers::pi * (i % sides) / sides;
            const Vec3 out(std::cos(angle), std::sin(angle), 0);
            inner.push_back(centre + radius * out);
            outer.push_back(centre + half / out.cwiseAbs().maxCoeff() * out);
        }
        for (std::size_t i = 0; i < sides; ++i) {
            add_quad(inner[i], outer[i], outer[i + 1], inner[i + 1]);
            add_wall(inner[i + 1], inner[i]);
        }
    }

    Array<Vec3> positions_;
    Array<Triangle> triangles_;
};

TEST(ProbeCompensateBlock, PairedPoints_AreWithinTheProbesErrorOfTheTrueEdges) {
    Context context;
    VirtualScanParams scan;
    scan.shape = VirtualScanParams::Shape::holed_block;
    scan.size = {88, 95, 41, Block::large, Block::small};
    scan.views = {0, 0, 1};
    scan.resolution = 0.25;
    VoxelThinParams thin;
    thin.bin_size = 1;
    const PointCloud points = virtual_scan(nullptr, scan, context).points;
    const RegionGrowResult grown = region_grow(voxel_thin(points, thin, context).points, {}, context);
    ProbePlannerParams planner;
    planner.radius = 2;
    planner.scanner_error = 1;
    planner.spacing = 2;
    planner.directions = 2;
    const ProbePlan plan = probe_planner(grown.features, grown.mesh, planner, context).plan;
    const TriangleMesh part = Block::mesh();
    for (const double noise : {0.0, 0.002}) {
        VirtualProbeParams machine;
        machine.noise = noise;
        const VirtualProbeResult touched = virtual_probe(plan, part, machine, context);
        ASSERT_EQ(touched.missed, 0u);
        const Compensated result = compensated(touched.points, with_radius(2, 1));
        EXPECT_GT(result.paired, 300u);
        double squares = 0, expected = 0;
        for (std::size_t i = 0; i < result.points.size(); ++i) {
            if (result.rows[i][1] == ProbeCompensateResult::no_row) continue;
            const double distance = Block::to_edge(result.points.positions[i]), sigma = result.number("uncertainty", i);
            EXPECT_LT(distance, 3.7 * sigma + 2 * Block::sagitta) << "one in a thousand is farther by chance";
            squares += distance * distance;
            expected += sigma * sigma;
        }
        if (noise > 0) {
            EXPECT_NEAR(std::sqrt(squares / expected), 1, 0.1);
        }
        ASSERT_EQ(result.features.polylines.size(), 6u) << "the outer edge and five rims";
        for (const FeaturePolyline& line : result.features.polylines) EXPECT_TRUE(line.closed);
        EXPECT_EQ(result.lone, 0u);
        EXPECT_TRUE(result.doubts.empty());
    }
}

}  // namespace
}  // namespace scanmill::test
