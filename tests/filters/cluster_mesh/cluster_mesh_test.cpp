// SPDX-License-Identifier: GPL-3.0-or-later
/// Shapes whose meshes are known, the laws, and bad scans.
#include <gmock/gmock.h>

#include "filters/cluster_mesh/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::Contains;
using testing::HasSubstr;

TEST(ClusterMesh, ThreePoints_AreOneTriangleThatFacesUp) {
    const PointCloud cloud = cloud_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}});
    const ClusterMeshResult result = clustered(cloud, with_max_edge(1.5));
    expect_laws(cloud, result);
    ASSERT_EQ(result.mesh.triangles.size(), 1u);
    EXPECT_EQ(result.mesh.triangles[0], (Triangle{0, 2, 1}));
    ClusterMeshParams down = with_max_edge(1.5);
    down.up = {0, 0, -2};
    EXPECT_EQ(clustered(cloud, down).mesh.triangles[0], (Triangle{0, 1, 2}));
}

TEST(ClusterMesh, AnEdgeAsLongAsMaxEdge_IsNotMade) {
    // Corners of a rectangle: sides 3 and 4, diagonals 5.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {3, 4, 0}});
    EXPECT_EQ(clustered(cloud, with_max_edge(5.000001)).mesh.triangles.size(), 2u);
    EXPECT_THROW(clustered(cloud, with_max_edge(5)), Error);
}

TEST(ClusterMesh, AGrid_IsTriangulatedCompletely) {
    for (const auto& [m, n] : {std::pair<u32, u32>(2, 2), {3, 7}, {20, 31}}) {
        const PointCloud cloud = grid(m, n);
        for (const auto in_plane : {ClusterMeshParams::InPlane::nearest, ClusterMeshParams::InPlane::paper}) {
            ClusterMeshParams params = with_max_edge(1.5);
            params.in_plane = in_plane;
            const ClusterMeshResult result = clustered(cloud, params);
            expect_laws(cloud, result);
            EXPECT_EQ(result.mesh.triangles.size(), 2 * (m - 1) * (n - 1));
            EXPECT_EQ(result.loops, 1u);
            EXPECT_EQ(result.boundary_edges, 2 * (m - 1 + n - 1));
            EXPECT_EQ(result.unused_points, 0u);
        }
    }
}

TEST(ClusterMesh, ASphere_IsClosedAndFacesOutwards_ForEveryAxisAndOrder) {
    const PointCloud cloud = fibonacci_sphere(3000, 0.004);
    for (const auto axis : {ClusterMeshParams::Axis::x, ClusterMeshParams::Axis::y, ClusterMeshParams::Axis::z})
        for (const auto in_plane : {ClusterMeshParams::InPlane::nearest, ClusterMeshParams::InPlane::paper}) {
            ClusterMeshParams params = with_max_edge(0.2);
            params.axis = axis;
            params.in_plane = in_plane;
            const ClusterMeshResult result = clustered(cloud, params);
            expect_laws(cloud, result);
            EXPECT_EQ(result.mesh.triangles.size(), 2 * cloud.size() - 4);
            EXPECT_EQ(result.clusters, 1u);
            EXPECT_NEAR(volume_of(result.mesh), 4 * std::numbers::pi / 3, 0.02);
        }
}

TEST(ClusterMesh, ATorus_HasTwiceAsManyTrianglesAsPoints) {
    const PointCloud cloud = poisson_torus(0.06);
    const ClusterMeshResult result = clustered(cloud);
    expect_laws(cloud, result);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * cloud.size());
    EXPECT_EQ(topology(result.mesh).genus, 1);
    EXPECT_GT(volume_of(result.mesh), 0);
}

TEST(ClusterMesh, TheBorderOfAnOpenScan_StaysOpen) {
    const PointCloud sphere = fibonacci_sphere(4000, 0.003);
    std::vector<Vec3> upper;
    for (const Vec3& p : sphere.positions)
        if (p.z() > -0.3) upper.push_back(p);
    const PointCloud cloud = cloud_from(upper);
    const ClusterMeshResult result = clustered(cloud);
    expect_laws(cloud, result);
    EXPECT_EQ(result.loops, 1u);
    EXPECT_EQ(result.unused_points, 0u);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * cloud.size() - 2 - result.boundary_edges);
}

TEST(ClusterMesh_Levels, TheFirst_IsThePartitionIntoConnectedComponents_ForEveryOrder) {
    for (u32 seed : {1, 2, 3}) {
        const PointCloud cloud = random_cube(400, seed);
        const double length = 0.11;
        const std::vector<u32> expected = components_within(cloud, length);
        const std::size_t count = std::set<u32>(expected.begin(), expected.end()).size();
        ASSERT_GT(count, 3u);
        for (const auto axis : {ClusterMeshParams::Axis::x, ClusterMeshParams::Axis::z})
            for (const double slice : {0.01, 0.3}) {
                ClusterMeshParams params = with_max_edge(length);
                params.axis = axis;
                params.slice = Length(slice);
                const ClusterMeshResult result = clustered(cloud, params);
                EXPECT_EQ(result.clusters, count);
                const auto first = result.mesh.vertex_columns.find("cluster-1")->values<u32>();
                const auto second = result.mesh.vertex_columns.find("cluster-2")->values<u32>();
                for (u32 v = 0; v < first.size(); ++v)
                    for (u32 w = 0; w < v; ++w) {
                        ASSERT_EQ(first[v] == first[w], expected[result.rows[v]] == expected[result.rows[w]]);
                        ASSERT_TRUE(second[v] != second[w] || first[v] == first[w]);
                    }
            }
    }
}

TEST(ClusterMesh_Levels, TheSecond_ContainsPointsThatWaited) {
    const PointCloud cloud = fibonacci_sphere(500);
    ClusterMeshParams params = with_max_edge(0.3);
    params.max_normal_angle = params.neighbour_angle = Angle::degrees(5);
    const ClusterMeshResult result = clustered(cloud, params);
    expect_laws(cloud, result);
    EXPECT_GT(result.extra, 0u);
    EXPECT_EQ(result.components, 1u);
    EXPECT_THAT(result.mesh.vertex_columns.find("cluster-2")->values<u32>(), testing::Each(0u));
}

PointCloud two_sheets(double distance, double shift = 0.3) {
    std::vector<Vec3> points;
    for (const Vec3& p : grid(25, 25).positions) {
        points.push_back(p);
        points.push_back(p + Vec3(shift, 0.4, distance));
    }
    return cloud_from(points);
}

std::size_t bridges(const TriangleMesh& mesh, double margin) {
    return static_cast<std::size_t>(std::ranges::count_if(mesh.triangles, [&](const Triangle& triangle) {
        const auto& p = mesh.positions;
        const bool inside = std::ranges::all_of(triangle, [&](u32 v) {
            return p[v].x() >= margin && p[v].x() <= 24 - margin && p[v].y() >= margin && p[v].y() <= 24 - margin;
        });
        return inside && (p[triangle[0]].z() != p[triangle[1]].z() || p[triangle[0]].z() != p[triangle[2]].z());
    }));
}

TEST(ClusterMesh, TwoSheetsFartherApartThanMaxEdge_AreTwoMeshes) {
    const PointCloud cloud = two_sheets(1.7);
    const ClusterMeshResult result = clustered(cloud, with_max_edge(1.6));
    expect_laws(cloud, result);
    EXPECT_EQ(result.clusters, 2u);
    EXPECT_EQ(result.components, 2u);
    EXPECT_EQ(result.mesh.triangles.size(), 4u * 24 * 24);
    EXPECT_EQ(bridges(result.mesh, 0), 0u);
}

TEST(ClusterMesh, TwoSheetsNearerThanMaxEdge_AreJoinedAtMostAtTheirBorders) {
    // The points' own normals do not tell borders from the rim of a thin plate.
    for (const auto& [distance, max_edge] : {std::pair(1.4, 1.6), {1.5, 2.5}, {2.0, 2.5}})
        for (const double shift : {0.1, 0.25, 0.3, 0.4, 0.55, 0.7, 0.85}) {
            const PointCloud cloud = two_sheets(distance, shift);
            const ClusterMeshResult result = clustered(cloud, with_max_edge(max_edge));
            expect_laws(cloud, result);
            EXPECT_EQ(result.clusters, 1u);
            EXPECT_EQ(bridges(result.mesh, 3), 0u) << distance << " " << max_edge << " " << shift;
        }
}

TEST(ClusterMesh, TheSidesOfABox_AreJoinedAtRightAngles) {
    const PointCloud cloud = lattice_cube(12, 1, true);  // its corners may be cut off: each is a sixth of a cube
    const ClusterMeshResult result = clustered(cloud, with_max_edge(1.5));
    expect_laws(cloud, result);
    EXPECT_EQ(result.loops, 0u);
    EXPECT_EQ(topology(result.mesh).genus, 0);
    EXPECT_LE(result.unused_points, 8u);
    EXPECT_NEAR(volume_of(result.mesh), 12.0 * 12 * 12, 3);
}

TEST(ClusterMesh, WithAnglesOf180Degrees_NoPointIsExtra) {
    ClusterMeshParams params = with_max_edge(1.5);
    params.max_normal_angle = params.neighbour_angle = Angle::degrees(180);
    EXPECT_EQ(clustered(lattice_cube(9, 1, true), params).extra, 0u);
}

TEST(ClusterMesh, SameBytesForAnyThreads_AndSameTrianglesForAnyOrderOfRows) {
    const PointCloud cloud = poisson_torus(0.08);
    const ClusterMeshResult one = clustered(cloud);
    for (unsigned threads : {2u, 3u}) {
        const ClusterMeshResult other = clustered(cloud, {}, threads);
        EXPECT_TRUE(std::ranges::equal(other.mesh.triangles, one.mesh.triangles));
        EXPECT_EQ(other.mesh.vertex_columns, one.mesh.vertex_columns);
    }
    EXPECT_EQ(by_position(clustered(shuffled(cloud, 7)).mesh), by_position(one.mesh));
}

TEST(ClusterMesh, Duplicates_AreUsedOnceAndCounted) {
    const PointCloud cloud = fibonacci_sphere(500);
    const PointCloud twice = joined(cloud, cloud);
    const ClusterMeshResult result = clustered(twice);
    expect_laws(twice, result);
    EXPECT_EQ(result.duplicates, 500u);
    EXPECT_EQ(result.mesh.triangles.size(), 996u);
}

TEST(ClusterMesh, ColumnsAndFrame_AreKept) {
    PointCloud cloud = grid(4, 4);
    cloud.frame.unit = LengthUnit::millimetre;
    cloud.frame.origin = Vec3(5e5, 4e6, 0);
    Array<float> values(16);
    for (std::size_t i = 0; i < 16; ++i) values[i] = static_cast<float>(i);
    cloud.columns.add(Column("heat", 1, Buffer<float>(std::move(values))));
    const ClusterMeshResult result = clustered(cloud);
    EXPECT_EQ(result.mesh.frame, cloud.frame);
    EXPECT_EQ(*result.mesh.vertex_columns.find("heat"), *cloud.columns.find("heat"));
}

TEST(ClusterMesh, ClustersOfAnEarlierRun_AreReplacedWithAWarning) {
    PointCloud cloud = grid(4, 4);
    cloud.columns.add(Column("cluster-1", 1, Buffer<float>(Array<float>(16, 7))));
    Heard heard;
    const ClusterMeshResult result = clustered(cloud, {}, 1, &heard);
    expect_laws(cloud, result);
    EXPECT_THAT(result.mesh.vertex_columns.find("cluster-1")->values<u32>(), testing::Each(0u));
    EXPECT_THAT(heard.warnings, testing::ElementsAre("the column 'cluster-1' of the input is replaced"));
}

TEST(ClusterMesh_MaxEdge, FollowsTheColumnBinSize_UnlessThePointsAreSparser) {
    PointCloud cloud = grid(5, 5);
    EXPECT_DOUBLE_EQ(clustered(cloud).max_edge, 2.5);
    const auto with_size = [&](double size) {
        PointCloud sized = cloud;
        Array<double> sizes(25, size);
        sizes[3] = std::numeric_limits<double>::quiet_NaN();
        sizes[4] = size / 3;
        sized.columns.add(Column("bin-size", 1, Buffer<double>(std::move(sizes))));
        return sized;
    };
    Heard heard;
    EXPECT_DOUBLE_EQ(clustered(with_size(1.2), {}, 1, &heard).max_edge, 2.3 * 1.2);
    EXPECT_THAT(heard.warnings, Contains(HasSubstr("'bin-size' has values from 0.4 to 1.2 u")));
    EXPECT_DOUBLE_EQ(clustered(with_size(0.2)).max_edge, 2.5);
}

TEST(ClusterMesh_BadScans, NoiseOfHalfASpacing_IsAManifold) {
    Random random(4);
    std::vector<Vec3> points;
    for (const Vec3& p : grid(60, 60).positions)
        points.push_back(p + 0.5 * Vec3(random.uniform() - 0.5, random.uniform() - 0.5, 2 * random.uniform() - 1));
    const PointCloud cloud = cloud_from(points);
    expect_laws(cloud, clustered(cloud));
}

TEST(ClusterMesh_BadScans, NearDuplicates_AreAManifold) {
    Random random(5);
    std::vector<Vec3> points;
    for (const Vec3& p : fibonacci_sphere(1500, 0.004).positions) {
        points.push_back(p);
        points.push_back(p + 1e-4 * Vec3(random.uniform(), random.uniform(), random.uniform()));
    }
    const PointCloud cloud = cloud_from(points);
    expect_laws(cloud, clustered(cloud, with_max_edge(0.25)));
}

TEST(ClusterMesh_BadScans, AThinPlate_HasNoSelfIntersection) {
    std::vector<Vec3> points;
    for (u32 x = 0; x <= 20; ++x)
        for (u32 y = 0; y <= 20; ++y)
            for (double z : {0.0, 0.9}) points.push_back(Vec3(x, y, z));
    const PointCloud cloud = cloud_from(points);
    expect_laws(cloud, clustered(cloud, with_max_edge(1.6)));
}

TEST(ClusterMesh_BadScans, ManyUnusedPoints_AreDoubtful) {
    PointCloud cloud = joined(grid(20, 20), moved(random_cube(40, 2, 300), 1, Vec3(100, 0, 0)));
    Heard heard;
    const ClusterMeshResult result = clustered(cloud, with_max_edge(1.5), 1, &heard);
    EXPECT_EQ(result.unused_points, 40u);
    EXPECT_THAT(heard.doubts, Contains(HasSubstr("40 of 440 distinct points are in no triangle")));
    EXPECT_EQ(heard.metrics.find("unused-points")->value, 40);
    EXPECT_EQ(heard.metrics.find("clusters")->value, static_cast<double>(result.clusters));
}

TEST(ClusterMesh, EndsWhenCancelled_InEveryStage) {
    const PointCloud cloud = fibonacci_sphere(5000);
    std::size_t checks = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++checks, false; };
    Context context(options);
    cluster_mesh(cloud, {}, context);
    const std::size_t all = checks;
    ASSERT_GE(all, 10u);
    for (std::size_t last : {std::size_t(1), all / 2, all - 1}) {
        checks = 0;
        options.is_cancelled = [&] { return ++checks >= last; };
        Context cancelled(options);
        EXPECT_THROW(cluster_mesh(cloud, {}, cancelled), Cancelled);
    }
}

}  // namespace
}  // namespace scanmill
