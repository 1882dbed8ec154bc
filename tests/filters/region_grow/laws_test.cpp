// SPDX-License-Identifier: GPL-3.0-or-later
/// Laws for any points: manifoldness, limits, order, threads, scale, duplicates.
#include <gmock/gmock.h>

#include "filters/region_grow/cases.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using namespace test;

/// Points of the plane z = 0 in [0, width] × [0, height], `step` apart and jittered by up to half of that, where
/// `solid`.
template <class Solid>
PointCloud plate(double width, double height, double step, const Solid& solid) {
    Random random(5);
    std::vector<Vec3> points;
    for (double x = 0; x <= width; x += step)
        for (double y = 0; y <= height; y += step) {
            const Vec3 p(std::clamp(x + random.uniform(-step, step) / 2, 0.0, width),
                         std::clamp(y + random.uniform(-step, step) / 2, 0.0, height), 0);
            if (solid(p)) points.push_back(p);
        }
    return cloud_from(std::move(points));
}

struct Hole {
    double x, y, radius;
};

void expect_holes(const RegionGrowResult& result, const std::vector<Hole>& holes, double voxel) {
    expect_consistent(result);
    EXPECT_EQ(result.loops, holes.size() + 1);
    EXPECT_EQ(result.holes, holes.size());
    EXPECT_EQ(result.components, 1u);
    std::vector<bool> found(holes.size(), false);
    for (const FeaturePolyline& line : result.features.polylines) {
        if (line.type != FeatureType::hole) continue;
        Vec3 middle = Vec3::Zero();
        for (u32 i = line.begin; i < line.end; ++i) middle += result.features.positions[result.features.vertices[i]];
        middle /= line.end - line.begin;
        for (std::size_t h = 0; h < holes.size(); ++h) {
            const Vec3 centre(holes[h].x, holes[h].y, 0);
            if ((middle - centre).norm() > voxel) continue;
            found[h] = true;
            double radius = 0;
            for (u32 i = line.begin; i < line.end; ++i)
                radius += (result.features.positions[result.features.vertices[i]] - centre).norm();
            EXPECT_NEAR(radius / (line.end - line.begin), holes[h].radius, voxel);
        }
    }
    EXPECT_THAT(found, testing::Each(true));
}

TEST(RegionGrow_PlateWithFiveRoundHoles, HasSixLoops) {
    const std::vector<Hole> holes{{20, 20, 8}, {50, 30, 12}, {80, 20, 6}, {20, 45, 5}, {80, 45, 7}};
    const PointCloud dense = plate(100, 60, 0.5, [&](const Vec3& p) {
        return std::ranges::none_of(holes,
                                    [&](const Hole& h) { return std::hypot(p.x() - h.x, p.y() - h.y) < h.radius; });
    });
    for (double voxel : {1.0, 2.0}) expect_holes(grown(thinned(dense, voxel)), holes, voxel);
}

TEST(RegionGrow_TopOfTheThesissBlock, HasItsFiveHolesWithVoxelsOf3) {
    const std::vector<Hole> holes{{44, 47.5, 21}, {11, 12, 5}, {77, 12, 5}, {11, 83, 5}, {77, 83, 5}};
    const PointCloud dense = plate(88, 95, 0.8, [&](const Vec3& p) {
        return std::ranges::none_of(holes,
                                    [&](const Hole& h) { return std::hypot(p.x() - h.x, p.y() - h.y) < h.radius; });
    });
    expect_holes(grown(thinned(dense, 3)), holes, 3);
}

TEST(RegionGrow_RandomPointsOfAPlane, DoNotOverlap) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        std::vector<Vec3> points;
        for (const Vec3& p : random_cube(250, seed).positions) points.push_back(Vec3(p.x(), p.y(), 0));
        const PointCloud cloud = cloud_from(std::move(points));
        for (const auto score : {RegionGrowParams::Score::circumradius, RegionGrowParams::Score::midpoint}) {
            RegionGrowParams params;
            params.score = score;
            const RegionGrowResult result = grown(cloud, params);
            expect_consistent(result);
            EXPECT_EQ(overlapping_pairs(result.mesh), 0u) << seed;
        }
    }
}

TEST(RegionGrow_ThinnedPlane, TouchesEveryPointAndDoesNotOverlap) {
    const PointCloud dense = plate(30, 20, 0.2, [](const Vec3&) { return true; });
    const RegionGrowResult result = grown(thinned(dense, 1));
    expect_consistent(result);
    EXPECT_EQ(result.unused_points, 0u);
    EXPECT_EQ(result.loops, 1u);
    EXPECT_EQ(overlapping_pairs(result.mesh), 0u);
}

TEST(RegionGrow_FirstPass, KeepsTheLimits) {
    for (const double degrees : {10.0, 20.0}) {
        RegionGrowParams params;
        params.min_angle = Angle::degrees(degrees);
        const RegionGrowResult result = grown(thinned(fibonacci_sphere(20000, 0.01), 0.1), params);
        expect_consistent(result);
        std::size_t kept = 0;
        for (std::size_t row = 0; row < result.passes.size(); ++row) {
            if (result.passes[row] != 0) continue;
            ++kept;
            EXPECT_GE(smallest_angle(result.mesh, result.mesh.triangles[row]), params.min_angle.in_radians() - 1e-9);
        }
        EXPECT_GT(10 * kept, 7 * result.passes.size());
        // No dihedral deviation exceeds the last relaxed limit, unless a small hole was closed there.
        std::map<Edge, std::vector<std::size_t>> at_edge;
        for (std::size_t row = 0; row < result.passes.size(); ++row)
            for (std::size_t i = 0; i < 3; ++i) {
                const Triangle& t = result.mesh.triangles[row];
                at_edge[make_edge(t[i], t[(i + 1) % 3])].push_back(row);
            }
        // What the pass of the later of the two triangles at an edge allows.
        const std::array<double, 4> least_cosine{0, std::cos(std::numbers::pi / 2 * 7 / 6), -0.5, -0.5};
        const auto last_pass = [&](const std::vector<std::size_t>& rows) {
            u8 last = 0;
            for (const std::size_t row : rows) last = std::max(last, result.passes[row]);
            return last;
        };
        for (const auto& [edge, edge_rows] : at_edge)
            if (const u8 pass = last_pass(edge_rows); edge_rows.size() == 2 && pass < 4) {
                const Vec3 a = normal_of(result.mesh, result.mesh.triangles[edge_rows[0]]);
                const Vec3 b = normal_of(result.mesh, result.mesh.triangles[edge_rows[1]]);
                EXPECT_GE(a.dot(b), (least_cosine[pass] - 1e-8) * a.norm() * b.norm()) << int(pass);
            }
    }
}

/// Without `bin-size`, which would not be scaled with the positions.
PointCloud torus_scan() {
    PointCloud scan = thinned(poisson_torus(0.02, 0.4, 200, 3, 30000), 0.05);
    scan.columns = {};
    return scan;
}

TEST(RegionGrow_OrderOfThePoints, ChangesNothingButNumbers) {
    const PointCloud cloud = joined(torus_scan(), moved(grid(8, 8), 0.05, Vec3(3, 0, 0)));
    const auto triangles = by_position(grown(cloud).mesh);
    for (std::uint64_t seed = 1; seed <= 3; ++seed)
        EXPECT_EQ(by_position(grown(shuffled(cloud, seed)).mesh), triangles);
}

TEST(RegionGrow_OrderOfRowsAtOnePosition, ChangesNothing) {
    // Every position three times, each with its own bin-size and tilted normal, some of them unknown.
    const PointCloud one = thinned(fibonacci_sphere(20000, 0.01), 0.1);
    PointCloud cloud = joined(joined(one, one), one);
    Random random(3);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Array<double> sizes, normals;
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        sizes.push_back(random.uniform(0, 3) < 1 ? nan : random.uniform(0.06, 0.2));
        const Vec3 tilt(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const Vec3 normal = random.uniform(0, 3) < 1 ? Vec3::Zero() : Vec3(cloud.positions[row] + 0.9 * tilt);
        normals.insert(normals.end(), normal.begin(), normal.end());
    }
    const Column size_column("bin-size", 1, Buffer<double>(std::move(sizes)));
    const Column normal_column("normal", 3, Buffer<double>(std::move(normals)));
    for (const Column& column : {size_column, normal_column}) {
        cloud.columns = {};
        cloud.columns.add(column);
        const auto triangles = by_position(grown(cloud).mesh);
        for (std::uint64_t seed = 1; seed <= 2; ++seed)
            EXPECT_TRUE(by_position(grown(shuffled(cloud, seed)).mesh) == triangles) << column.name() << ", " << seed;
    }
}

TEST(RegionGrow_Threads, GiveTheSameBytes) {
    const PointCloud cloud = torus_scan();
    const RegionGrowResult one = grown(cloud), two = grown(cloud, {}, 2);
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(one.mesh.positions, two.mesh.positions));
    EXPECT_TRUE(std::ranges::equal(one.mesh.sharp_edges, two.mesh.sharp_edges));
    EXPECT_EQ(topology(one.mesh).genus, 1);
    EXPECT_TRUE(topology(one.mesh).closed);
}

TEST(RegionGrow_Scale, ChangesNothing) {
    const PointCloud cloud = torus_scan();
    const Buffer<Triangle> triangles = grown(cloud).mesh.triangles;
    for (double factor : {0x1p-28, 0x1p-10, 0x1p10, 0x1p28})
        EXPECT_TRUE(std::ranges::equal(grown(moved(cloud, factor)).mesh.triangles, triangles)) << factor;
}

TEST(RegionGrow_Duplicates, AreCountedAndChangeNothing) {
    const PointCloud cloud = torus_scan();
    const RegionGrowResult twice = grown(joined(cloud, cloud));
    EXPECT_EQ(twice.duplicates, cloud.size());
    EXPECT_EQ(twice.mesh.positions.size() + twice.unused_points, cloud.size());
    EXPECT_EQ(by_position(twice.mesh), by_position(grown(cloud).mesh));
}

TEST(RegionGrow_DensityThatVariesAHundredfold, LeavesNoHole) {
    // Steps that grow from 0.1 to 1 in both directions.
    std::vector<double> steps{0};
    for (double step = 0.1; step < 1; step *= 1.06) steps.push_back(steps.back() + step);
    std::vector<Vec3> points;
    Random random(2);
    for (std::size_t i = 0; i < steps.size(); ++i)
        for (double y = 0; y <= 20;) {
            const double step = i == 0 ? 0.1 : steps[i] - steps[i - 1];
            points.push_back(
                Vec3(steps[i] + step * random.uniform(-0.2, 0.2), y + step * random.uniform(-0.2, 0.2), 0));
            y += step;
        }
    const RegionGrowResult result = grown(cloud_from(std::move(points)));
    expect_consistent(result);
    EXPECT_EQ(result.holes, 0u);
    EXPECT_EQ(result.components, 1u);
    EXPECT_EQ(overlapping_pairs(result.mesh), 0u);
}

TEST(RegionGrow_NoiseOfHalfAVoxel, IsStillAManifold) {
    Random random(4);
    std::vector<Vec3> points;
    for (const Vec3& p : fibonacci_sphere(20000).positions) points.push_back(p * (1 + 0.05 * random.normal()));
    const RegionGrowResult result = grown(thinned(cloud_from(std::move(points)), 0.1));
    expect_consistent(result);
    EXPECT_LT(20 * result.unused_points, result.mesh.positions.size());
}

class RegionGrowOfAnything : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RegionGrowOfAnything, IsAManifoldAndCountsEveryPoint) {
    const std::uint64_t seed = GetParam();
    PointCloud flat = flat_square(0.02);
    for (const PointCloud& cloud : {random_cube(300, seed), random_sphere(400, seed), shuffled(flat, seed),
                                    joined(random_sphere(200, seed), flat), lattice_cube(5),
                                    l_block_surface(4, 1, 4, 0.02, seed), fibonacci_sphere(500, 0.05, seed)}) {
        for (const auto score : {RegionGrowParams::Score::circumradius, RegionGrowParams::Score::midpoint}) {
            RegionGrowParams params;
            params.score = score;
            params.close_holes = static_cast<u32>(seed % 3) * 5;
            params.max_normal_angle = Angle::degrees(60 + 30 * static_cast<double>(seed % 5));
            const RegionGrowResult result = grown(cloud, params);
            expect_consistent(result);
            // Every row is a vertex, repeats an earlier row, or is the first at a position without a vertex.
            std::set<std::array<double, 3>> positions, used;
            for (const Vec3& p : cloud.positions) positions.insert({p.x(), p.y(), p.z()});
            for (const u32 row : result.rows) {
                const Vec3& p = cloud.positions[row];
                used.insert({p.x(), p.y(), p.z()});
            }
            EXPECT_EQ(result.duplicates, cloud.size() - positions.size());
            EXPECT_EQ(result.unused_points, positions.size() - used.size());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RegionGrowOfAnything, testing::Range<std::uint64_t>(1, 13));

}  // namespace
}  // namespace scanmill
