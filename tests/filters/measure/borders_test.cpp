// SPDX-License-Identifier: GPL-3.0-or-later
/// measure against a cloud of points, with those beyond the borders of the mesh left out.
#include <gmock/gmock.h>

#include "filters/measure/cases.hpp"
#include "scanmill/base/error.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

MeasureParams without_borders() {
    MeasureParams params = few_samples();
    params.borders = MeasureParams::Borders::exclude;
    return params;
}

TEST(MeasureBorders, PointsBesideAndAboveABorder_AreLeftOutAndCounted) {
    // Above the diagonal, below a face; beside an edge, beyond a corner, above an edge, on a corner.
    MeasureParams params = without_borders();
    params.thresholds = {0.25};
    const PointCloud cloud = cloud_of({{1, 1, 0.5}, {3, 1, 0}, {0.5, 1.5, -0.25}, {3, 3, 0}, {2, 1, 1}, {0, 0, 0}});
    const Measurement result = measured(rectangle(2, 2), cloud, params);
    EXPECT_EQ(result.beyond_borders, 4u);
    EXPECT_EQ(result.from_truth.samples, 2u);
    EXPECT_DOUBLE_EQ(result.from_truth.mean, 0.375);
    EXPECT_DOUBLE_EQ(result.from_truth.max, 0.5);
    EXPECT_DOUBLE_EQ(result.both.max, 0.5);
    EXPECT_EQ(result.near.at(0).recall, 0.5);
    EXPECT_EQ(metrics_of(result).find("beyond-borders")->value, 4);
}

TEST(MeasureBorders, Included_CountLikeAllOthers) {
    const Measurement result = measured(rectangle(2, 2), cloud_of({{1, 1, 0.5}, {3, 1, 0}}), few_samples());
    EXPECT_FALSE(result.beyond_borders);
    EXPECT_DOUBLE_EQ(result.from_truth.max, 1);
    EXPECT_EQ(metrics_of(result).find("beyond-borders"), nullptr);
}

/// Several triangles are equally near; the first has only a vertex on the border.
TEST(MeasureBorders, VertexOfTheBorder_CountsForTrianglesWithoutABoundaryEdge) {
    const TriangleMesh half = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, {0, 2, 0}},
                                   {{0, 2, 3}, {0, 1, 2}, {0, 3, 4}, {0, 4, 5}, {3, 2, 6}});
    const Measurement result = measured(half, cloud_of({{0, 0, 0.2}, {0.5, 0.75, 0.1}}), without_borders());
    EXPECT_EQ(result.beyond_borders, 1u);
    EXPECT_DOUBLE_EQ(result.from_truth.max, 0.1);
}

TEST(MeasureBorders, EdgeOfThreeTriangles_IsNotABorder) {
    // Three triangles in front of their common edge; the point is behind it.
    const TriangleMesh fins =
        soup({{0, 0, 0}, {0, 2, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
    const Measurement result = measured(fins, cloud_of({{-0.125, 1, -0.125}, {-1, -1, 0}}), without_borders());
    EXPECT_EQ(result.beyond_borders, 1u) << "the point beyond the end of the edge";
    EXPECT_DOUBLE_EQ(result.from_truth.max, std::sqrt(2) / 8);
}

TEST(MeasureBorders, ClosedMesh_HasNone) {
    const TriangleMesh sphere = geodesic_sphere(1, 8);
    const PointCloud cloud = random_sphere(2000, 3);
    const Measurement with = measured(sphere, cloud, few_samples()),
                      without = measured(sphere, cloud, without_borders());
    EXPECT_EQ(without.beyond_borders, 0u);
    EXPECT_EQ(without.from_truth.samples, 2000u);
    EXPECT_EQ(without.from_truth.max, with.from_truth.max);
    EXPECT_EQ(without.from_truth.mean, with.from_truth.mean);
}

/// A point above a triangle of an inscribed mesh is at most as far away as the triangle's plane is inside the sphere.
TEST(MeasureBorders, HalfASphere_IsMeasuredByItsOwnHalf) {
    TriangleMesh half = geodesic_sphere(1, 12);
    Array<Triangle> upper;
    double least_plane = 1;
    for (const Triangle& t : half.triangles) {
        const Vec3 &a = half.positions[t[0]], &b = half.positions[t[1]], &c = half.positions[t[2]];
        if (a.z() + b.z() + c.z() < 0) continue;
        upper.push_back(t);
        least_plane = std::min(least_plane, (b - a).cross(c - a).normalized().dot(a));
    }
    half.triangles = std::move(upper);
    const PointCloud cloud = random_sphere(20'000, 5);
    EXPECT_GT(measured(half, cloud, few_samples()).from_truth.max, 1) << "from the lower pole to the border";
    const Measurement result = measured(half, cloud, without_borders());
    EXPECT_LE(result.from_truth.max, 1 - least_plane + 1e-12);
    EXPECT_EQ(*result.beyond_borders + result.from_truth.samples, cloud.size());
    EXPECT_NEAR(static_cast<double>(*result.beyond_borders), 10'000, 500) << "the lower half";
}

TEST(MeasureBorders, NothingLeft_IsRefused) {
    try {
        measured(rectangle(1, 1), cloud_of({{2, 0.5, 0}, {1, 1, 0}}), without_borders());
        FAIL() << "measured without a point";
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("all 2 points of the truth are nearest to a border of the mesh"));
    }
}

TEST(MeasureBorders, MeshAsTruth_IsRefused) {
    try {
        measured(rectangle(1, 1), rectangle(1, 1), without_borders());
        FAIL() << "excluded borders of a mesh";
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("the truth is a mesh of 2 triangles"));
    }
}

}  // namespace
}  // namespace scanmill::test
