// SPDX-License-Identifier: GPL-3.0-or-later
// Creases of meshes with noise, where the true ones are known.

#include <gmock/gmock.h>

#include "filters/features/cases.hpp"
#include "support/mesh_operations.hpp"

namespace scanmill {
namespace {

using namespace test;

/// A square of 60 by 60 edges of length 1 with noise in each coordinate. Along x = 30 its normal turns by `degrees`.
TriangleMesh noisy_roof(double degrees, double noise) {
    constexpr u32 size = 60;
    const double slope = std::tan(degrees / 2 * std::numbers::pi / 180);
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal(0, noise);
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    for (u32 y = 0; y <= size; ++y)
        for (u32 x = 0; x <= size; ++x) {
            const double dx = normal(random), dy = normal(random), dz = normal(random);
            positions.emplace_back(x + dx, y + dy, dz - slope * std::abs(x - size / 2.0));
        }
    for (u32 y = 0; y < size; ++y)
        for (u32 x = 0; x < size; ++x) {
            const u32 a = y * (size + 1) + x, c = a + size + 1;
            triangles.push_back({a, a + 1, c + 1});
            triangles.push_back({a, c + 1, c});
        }
    return mesh_of(positions, triangles);
}

struct CreaseLength {
    double near = 0, far = 0;  ///< of creases, within 1.5 of x = 30 and farther
    std::vector<bool> found = std::vector<bool>(60, false);  ///< by y
};

CreaseLength length_of(const FeatureGraph& graph) {
    CreaseLength length;
    for (const FeaturePolyline& line : graph.polylines) {
        if (line.type != FeatureType::crease) continue;
        for (u32 i = line.begin; i + !line.closed < line.end; ++i) {
            const Vec3 &a = graph.positions[graph.vertices[i]],
                       &b = graph.positions[graph.vertices[i + 1 < line.end ? i + 1 : line.begin]];
            const bool near = std::abs((a + b).x() / 2 - 30) < 1.5;
            (near ? length.near : length.far) += (b - a).norm();
            if (near) length.found[static_cast<std::size_t>(std::clamp((a + b).y() / 2, 0.0, 59.0))] = true;
        }
    }
    return length;
}

TEST(FeaturesOfANoisyPlane, AreItsBoundaryAlone) {
    for (const double noise : {0.1, 0.2}) {
        const FeatureLines lines = features_of(noisy_roof(0, noise));
        EXPECT_EQ(lines.counts.creases, 0u) << noise;
        EXPECT_EQ(lines.counts.boundaries, 1u);
        EXPECT_GT(lines.counts.unreliable, 0u);
        EXPECT_NEAR(lines.noise / noise, 1, 0.15);
    }
}

TEST(FeaturesOfANoisyRoof, FollowItsRidge) {
    for (const double degrees : {60.0, 90.0}) {
        const CreaseLength length = length_of(features_of(noisy_roof(degrees, 0.15)).graph);
        EXPECT_GE(std::ranges::count(length.found, true), 55) << degrees;
        EXPECT_LT(length.far, length.near / 10) << degrees;
        EXPECT_LT(length.near, 120) << degrees << ": one line, at most of twice the length";
    }
}

TEST(FeaturesOfANoisyRoof, AreFewLines_AlthoughTheyZigzag) {
    const FeatureLines lines = features_of(noisy_roof(90, 0.15));
    EXPECT_LT(lines.counts.creases, 25u);
}

/// Faces of 24 by 24 edges of length 1.
TriangleMesh noisy_cube(double noise) {
    constexpr int size = 24;
    MeshBuilder builder;
    for (int axis = 0; axis < 3; ++axis)
        for (const bool upper : {false, true})
            for (int i = 0; i < size; ++i)
                for (int j = 0; j < size; ++j) {
                    const auto corner = [&](int u, int v) {
                        Vec3 p;
                        p[axis] = upper ? size : 0;
                        p[(axis + 1) % 3] = u;
                        p[(axis + 2) % 3] = v;
                        return p;
                    };
                    const Vec3 a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
                    upper ? builder.quad(a, b, c, d) : builder.quad(a, d, c, b);
                }
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal(0, noise);
    return with_positions(builder.mesh(), [&](const Vec3& p) {
        const double x = normal(random), y = normal(random), z = normal(random);
        return Vec3(p + Vec3(x, y, z));
    });
}

TEST(FeaturesOfANoisyRoof, HaveDifferentNormalsOnTheTwoSidesOfEverySegment) {
    // About the sharp angle, the ridge has gaps. Edges that close them can have the same normal on both sides.
    std::size_t segments = 0;
    for (const double degrees : {36.0, 38.0, 45.0})
        for (const double noise : {0.1, 0.15}) {
            const FeatureGraph graph = features_of(noisy_roof(degrees, noise)).graph;
            for (const FeaturePolyline& line : graph.polylines) {
                if (line.type != FeatureType::crease) continue;
                for (u32 i = line.begin; i + !line.closed < line.end; ++i, ++segments)
                    EXPECT_GT((graph.left_normals[i] - graph.right_normals[i]).norm(), 0) << degrees << ", " << noise;
            }
        }
    EXPECT_GT(segments, 100u);
}

TEST(FeaturesOfANoisyCube, AreItsTwelveEdges_AndACornerIsNearEachOfItsCorners) {
    EXPECT_EQ(features_of(noisy_cube(0)).counts.creases, 12u);
    const FeatureLines lines = features_of(noisy_cube(0.1));
    EXPECT_NEAR(lines.noise, 0.1, 0.03);
    double length = 0;
    for (const FeaturePolyline& line : lines.graph.polylines)
        for (u32 i = line.begin; i + 1 < line.end; ++i)
            length +=
                (lines.graph.positions[lines.graph.vertices[i + 1]] - lines.graph.positions[lines.graph.vertices[i]])
                    .norm();
    EXPECT_NEAR(length, 12 * 24, 0.15 * 12 * 24);
    EXPECT_LT(lines.counts.creases, 25u);
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner = 24 * Vec3(i & 1, i >> 1 & 1, i >> 2 & 1);
        EXPECT_TRUE(std::ranges::any_of(lines.graph.corners, [&](u32 v) {
            return (lines.graph.positions[v] - corner).norm() < 2.5;
        })) << i;
    }
}

TEST(FeaturesOfANoisyRoof, OfLessThanTheSharpAngle_AreFew) {
    const CreaseLength length = length_of(features_of(noisy_roof(20, 0.15)).graph);
    EXPECT_LT(length.near + length.far, 6);
}

TEST(FeaturesWithoutNoise_JudgeEveryTriangle, AsOfACleanMesh) {
    const TriangleMesh mesh = noisy_roof(0, 0.2);
    FeatureParams params;
    params.noise = 0;
    const FeatureLines lines = features_of(mesh, params);
    EXPECT_GT(lines.counts.creases, 100u);
    EXPECT_EQ(lines.counts.unreliable, 0u);
    EXPECT_EQ(lines.noise, 0);
}

TEST(FeaturesOfACleanMesh, AreJudgedByTriangles) {
    ContextOptions options;
    Context context(options);
    const FeatureLines lines = features(cube(2), {}, context);
    EXPECT_EQ(lines.noise, 0);
    EXPECT_EQ(lines.counts.unreliable, 0u);
    EXPECT_EQ(lines.counts.creases, 12u);
    EXPECT_EQ(lines.mesh_vertices.size(), lines.graph.positions.size());
}

TEST(FeaturesRefuse, NoiseOutOfRange) {
    FeatureParams params;
    params.noise = -0.5;
    EXPECT_THAT(features_refusal(cube(), params), testing::HasSubstr("noise must be 0 or more; it is -0.5 u"));
    params.noise = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(features_refusal(cube(), params), testing::HasSubstr("noise must be 0 or more"));
}

}  // namespace
}  // namespace scanmill
