// SPDX-License-Identifier: GPL-3.0-or-later
/// Creases of models whose vertices or scans have noise, by length, beside those of the clean models.

#include <gmock/gmock.h>

#include <map>

#include "filters/features/cases.hpp"
#include "region_grow/region_grow.hpp"
#include "scanmill/formats/files.hpp"
#include "support/mesh_operations.hpp"
#include "support/real_data.hpp"
#include "virtual_scan/virtual_scan.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {
namespace {

using namespace test;

/// Points on the creases, at equal distances of at most `step` on every segment, with their length.
std::vector<std::pair<Vec3, double>> samples(const FeatureGraph& graph, double step) {
    std::vector<std::pair<Vec3, double>> points;
    for (const FeaturePolyline& line : graph.polylines) {
        if (line.type != FeatureType::crease) continue;
        for (u32 i = line.begin; i + !line.closed < line.end; ++i) {
            const Vec3 &a = graph.positions[graph.vertices[i]],
                       &b = graph.positions[graph.vertices[i + 1 < line.end ? i + 1 : line.begin]];
            const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / step)));
            for (int part = 0; part < parts; ++part)
                points.emplace_back(a + (b - a) * (part + 0.5) / parts, (b - a).norm() / parts);
        }
    }
    return points;
}

/// The share of the length of `lines` that is within `distance` of `others`.
double share_within(const FeatureGraph& lines, const FeatureGraph& others, double distance) {
    const double step = distance / 20;
    std::map<std::array<long, 3>, std::vector<Vec3>> cells;
    const auto cell_of = [&](const Vec3& p) {
        return std::array{std::lround(p.x() / distance), std::lround(p.y() / distance), std::lround(p.z() / distance)};
    };
    for (const auto& [p, length] : samples(others, step)) cells[cell_of(p)].push_back(p);
    const auto is_near = [&](const Vec3& p) {
        const auto [x, y, z] = cell_of(p);
        for (long i = x - 1; i <= x + 1; ++i)
            for (long j = y - 1; j <= y + 1; ++j)
                for (long k = z - 1; k <= z + 1; ++k)
                    if (const auto found = cells.find({i, j, k}); found != cells.end())
                        for (const Vec3& q : found->second)
                            if ((p - q).norm() <= distance) return true;
        return false;
    };
    double near = 0, all = 0;
    for (const auto& [p, length] : samples(lines, step)) {
        all += length;
        near += is_near(p) ? length : 0;
    }
    return near / all;
}

class NoisyCreases : public testing::TestWithParam<const char*> {
protected:
    void expect_good(const FeatureGraph& found, const FeatureGraph& right, double diagonal) {
        EXPECT_GE(share_within(right, found, 0.005 * diagonal), 0.95) << "of the true length is found";
        EXPECT_GE(share_within(found, right, 0.005 * diagonal), 0.9) << "of the length found is true";
    }
};

TEST_P(NoisyCreases, OfAMeshAndOfAScan_AreTheModels) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam());
    const std::shared_ptr<const TriangleMesh> model = read_mesh(path);
    const double diagonal = bounding_box(model->positions.span()).diagonal();
    const FeatureGraph right = features_of(*model).graph;
    {
        SCOPED_TRACE("noise on the vertices");
        std::mt19937_64 random(1);
        std::normal_distribution<double> normal(0, 0.0005 * diagonal);
        const TriangleMesh noisy = with_positions(*model, [&](const Vec3& p) {
            const double x = normal(random), y = normal(random), z = normal(random);
            return Vec3(p + Vec3(x, y, z));
        });
        expect_good(features_of(noisy).graph, right, diagonal);
    }
    SCOPED_TRACE("noise on the rays");
    Context context;
    VirtualScanParams scan;
    scan.views = {20};
    scan.resolution = 0.005 * diagonal;
    scan.noise = 0.0005 * diagonal;
    VoxelThinParams thin;
    thin.bin_size = Length(0.005 * diagonal);
    const PointCloud points = voxel_thin(virtual_scan(model.get(), scan, context).points, thin, context).points;
    const RegionGrowResult grown = region_grow(points, {}, context);
    EXPECT_NEAR(grown.noise / (0.0005 * diagonal), 0.8, 0.2) << "along the normal less than along the ray";
    expect_good(grown.features, right, diagonal);
    TriangleMesh undeclared = grown.mesh;
    undeclared.sharp_edges = {};
    EXPECT_EQ(features_of(undeclared).counts.creases, grown.creases);
    EXPECT_EQ(features_of(grown.mesh).counts.creases, grown.creases) << "the mesh declares the creases";
}

INSTANTIATE_TEST_SUITE_P(Models, NoisyCreases, testing::Values("meshes/fandisk_large.off", "meshes/anchor_dense.off"));

TEST(CreasesOfCleanModels, AreThoseOfTheirTriangles) {
    for (const char* name : {"meshes/fandisk_large.off", "meshes/anchor_dense.off", "meshes/armadillo.off",
                             "meshes/couplingdown.off", "meshes/hand.off", "meshes/knot2.off", "meshes/eight.off"}) {
        SCANMILL_REAL_SCAN(path, fetched_data, name);
        const std::shared_ptr<const TriangleMesh> model = read_mesh(path);
        FeatureParams params;
        params.noise = 0;
        const FeatureGraph found = features_of(*model).graph, by_triangles = features_of(*model, params).graph;
        EXPECT_TRUE(std::ranges::equal(found.vertices, by_triangles.vertices)) << name;
        EXPECT_TRUE(std::ranges::equal(found.left_normals, by_triangles.left_normals)) << name;
    }
}

}  // namespace
}  // namespace scanmill
