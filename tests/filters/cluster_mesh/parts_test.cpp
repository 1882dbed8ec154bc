// SPDX-License-Identifier: GPL-3.0-or-later
/// The parts of cluster-mesh: slices, the two levels of clusters, the triangles of one point.
#include <gmock/gmock.h>

#include "cluster_mesh/clusters.hpp"
#include "cluster_mesh/insertion_order.hpp"
#include "cluster_mesh/mesh_components.hpp"
#include "cluster_mesh/triangulation.hpp"
#include "filters/cluster_mesh/cases.hpp"
#include "scanmill/geometry/growing/point_normals.hpp"

namespace scanmill {
namespace {

using namespace test;
using namespace clustering;
using testing::ElementsAre;

TEST(ClusterMesh_Slices, BetweenTwoPlanes_APointBelongsToTheUpperOne) {
    const std::vector<double> x{-0.0625, 0.0624, 0.0625, 0.1875};
    const Array<u32> slices = slices_of(x, 0, 0.125);
    EXPECT_THAT(std::vector<u32>(slices.begin(), slices.end()), ElementsAre(0, 0, 1, 2));
}

std::vector<Vec3> in_order(const PointCloud& cloud, double slice, InPlane in_plane, int axis = 0) {
    const growing::DistinctPoints points = growing::distinct_points_of(cloud.positions.span());
    const growing::Neighbourhoods neighbourhoods(points, 1);
    Execution execution;
    std::vector<Vec3> ordered;
    for (u32 point : insertion_order(points, neighbourhoods, axis, slice, in_plane, execution))
        ordered.push_back(points.positions[point]);
    return ordered;
}

TEST(ClusterMesh_Order, OfThePaper_IsByDistanceToThePlaneThenByTheOtherCoordinates) {
    const PointCloud cloud =
        cloud_of({{0.3, 9, 0}, {0, 5, 0}, {0.1, 0, 0}, {1.2, 0, 0}, {0.9, 0, 7}, {1, 2, 1}, {1, 2, 0}});
    EXPECT_THAT(in_order(cloud, 1, InPlane::paper),
                ElementsAre(Vec3(0, 5, 0), Vec3(0.1, 0, 0), Vec3(0.3, 9, 0), Vec3(1, 2, 0), Vec3(1, 2, 1),
                            Vec3(0.9, 0, 7), Vec3(1.2, 0, 0)));
}

TEST(ClusterMesh_Order, NearestFirst_EveryPointOfAConnectedSliceIsNearAnEarlierOne) {
    const PointCloud cloud = shuffled(grid(1, 40), 3);
    const std::vector<Vec3> ordered = in_order(cloud, 1, InPlane::nearest);
    for (std::size_t i = 1; i < ordered.size(); ++i) {
        double nearest = 100;
        for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (ordered[i] - ordered[j]).norm());
        EXPECT_EQ(nearest, 1);
    }
}

TEST(ClusterMesh_Order, SlicesAscend_AlongEveryAxis) {
    const PointCloud cloud = random_cube(500, 5);
    for (int axis : {0, 1, 2})
        for (InPlane in_plane : {InPlane::paper, InPlane::nearest}) {
            const std::vector<Vec3> ordered = in_order(cloud, 0.1, in_plane, axis);
            ASSERT_EQ(ordered.size(), cloud.size());
            double lowest = 10;
            for (const Vec3& p : cloud.positions) lowest = std::min(lowest, p[axis]);
            for (std::size_t i = 1; i < ordered.size(); ++i)
                EXPECT_LE(std::floor((ordered[i - 1][axis] - lowest) / 0.1 + 0.5),
                          std::floor((ordered[i][axis] - lowest) / 0.1 + 0.5));
        }
}

TEST(ClusterMesh_Clusters, TheFourCases) {
    Clusters clusters(6);
    const auto insert = [&](u32 point, std::vector<u32> near) {
        const int found = clusters.meet(point, near);
        clusters.join(point);
        return found;
    };
    EXPECT_EQ(insert(0, {}), 2);
    EXPECT_EQ(insert(1, {0}), 1);
    EXPECT_EQ(insert(2, {1}), 3);  // one of two points: its own cluster of level 2
    EXPECT_EQ(clusters.first_level().count, 4u);  // 0-1-2 and the three points to come
    const Clusters::Numbers second = clusters.second_level();
    EXPECT_EQ(second.of_point[0], second.of_point[1]);
    EXPECT_NE(second.of_point[0], second.of_point[2]);
    EXPECT_EQ(insert(3, {0, 1, 2}), 4);  // two of {0, 1}, and the only point of {2}
    EXPECT_EQ(clusters.size(3), 4u);
    EXPECT_EQ(insert(4, {}), 2);
    EXPECT_EQ(insert(5, {4, 3}), 1);  // {4} alone; one of four of the other cluster
    EXPECT_EQ(clusters.size(5), 2u);
    EXPECT_EQ(clusters.first_level().count, 1u);
    EXPECT_EQ(clusters.second_level().count, 2u);
}

TEST(ClusterMesh_Clusters, APointThatDoesNotJoin_KeepsItsOwnCluster) {
    Clusters clusters(4);
    clusters.meet(0, {});
    const std::vector<u32> near{0};
    clusters.meet(1, near);
    clusters.join(1);
    const std::vector<u32> both{0, 1};
    EXPECT_EQ(clusters.meet(2, both), 4);
    EXPECT_EQ(clusters.size(2), 1u);
    clusters.unite(2, 0);
    EXPECT_EQ(clusters.size(2), 3u);
}

TEST(ClusterMesh_MeshComponents, ListTheirPoints) {
    MeshComponents components(6);
    components.join(0, 3);
    components.join(5, 4);
    components.join(4, 0);
    std::set<u32> members;
    components.for_each(5, [&](u32 point) { members.insert(point); });
    EXPECT_THAT(members, ElementsAre(0, 3, 4, 5));
    EXPECT_EQ(components.size(3), 4u);
    EXPECT_TRUE(components.are_joined(5, 3));
    EXPECT_FALSE(components.are_joined(5, 1));
    components.separate(3);
    for (u32 point : {0, 3, 4, 5}) EXPECT_EQ(components.size(point), 1u);
    EXPECT_FALSE(components.are_joined(0, 3));
}

/// A surface over a few points, inserted by hand.
struct ByHand {
    growing::DistinctPoints points;
    growing::Neighbourhoods neighbourhoods;
    Surface surface;
    Triangulation triangulation;

    ByHand(std::initializer_list<Vec3> positions, double max_edge, const WinnerLimits& winner = usual())
        : points(growing::distinct_points_of(cloud_of(positions).positions.span())),
          neighbourhoods(points, 1),
          surface(points, neighbourhoods, growing::principal_normals(points, neighbourhoods, 1),
                  Array<double>(positions.size(), max_edge), Array<double>(positions.size(), max_edge), false),
          triangulation(surface, max_edge, Vec3(0, 0, 1), winner) {}

    static WinnerLimits usual() {
        return {-1e-9, 1e-9, std::cos(std::numbers::pi / 18), std::tan(std::numbers::pi / 18)};
    }
    static Limits lenient() {
        return {.edge_share = 1,
                .least_sine = 0.01,
                .joint_cosine = -0.5,
                .point_cosine = -1,
                .sharp_cosine = -1,
                .empty_circle = false,
                .leaves_room = false,
                .in_space = true};
    }
    u32 at(const Vec3& position) const {
        return static_cast<u32>(std::ranges::find(points.positions, position) - points.positions.begin());
    }
    /// `near`: the points that it may see, in order.
    Outcome insert(const Vec3& position, std::initializer_list<Vec3> near, bool may_start = true) {
        std::vector<u32> rows;
        for (const Vec3& other : near) rows.push_back(at(other));
        return triangulation.insert(at(position), rows, may_start, lenient());
    }
    std::size_t triangles() const {
        std::size_t sum = 0;
        for (u32 point = 0; point < points.size(); ++point) sum += surface.fans.count(point);
        return sum / 3;
    }
    bool has(const Vec3& a, const Vec3& b, const Vec3& c) const { return surface.fans.left_of(at(a), at(b)) == at(c); }
};

const Vec3 a(0, 0, 0), b(1, 0, 0), c(0.5, 0.8, 0);

TEST(ClusterMesh_OnePoint, TheThirdStarts_FacingUp) {
    ByHand hand({a, b, c}, 1.2);
    EXPECT_EQ(hand.insert(a, {}), Outcome::loose);
    EXPECT_EQ(hand.insert(b, {a}), Outcome::loose);
    EXPECT_EQ(hand.insert(c, {a, b}), Outcome::first);
    EXPECT_EQ(hand.triangles(), 1u);
    EXPECT_TRUE(hand.has(a, b, c));
}

TEST(ClusterMesh_OnePoint, AtTheNearestBoundaryEdge_ContinuesTheOrientation) {
    const Vec3 d(1.2, 0.7, 0);
    ByHand hand({a, b, c, d}, 1.3);
    hand.insert(a, {});
    hand.insert(b, {a});
    hand.insert(c, {a, b});
    EXPECT_EQ(hand.insert(d, {c, b}), Outcome::joined);
    EXPECT_EQ(hand.triangles(), 2u);
    EXPECT_TRUE(hand.has(b, d, c));
}

TEST(ClusterMesh_OnePoint, OverTheCentroid_SplitsTheTriangleIntoThree) {
    const Vec3 centroid(0.5, 0.8 / 3, 0.01);
    ByHand hand({a, b, c, centroid}, 1.2);
    hand.insert(a, {});
    hand.insert(b, {a});
    hand.insert(c, {a, b});
    EXPECT_EQ(hand.insert(centroid, {a, b, c}), Outcome::split);
    EXPECT_EQ(hand.triangles(), 3u);  // one more pair
    EXPECT_TRUE(hand.has(a, b, centroid) && hand.has(b, c, centroid) && hand.has(c, a, centroid));
}

TEST(ClusterMesh_OnePoint, OverAnEdge_SplitsBothTriangles) {
    const Vec3 d(0.5, -0.8, 0), middle(0.5, 0.002, 0);
    ByHand hand({a, b, c, d, middle}, 1.2);
    hand.insert(a, {});
    hand.insert(b, {a});
    hand.insert(c, {a, b});
    EXPECT_EQ(hand.insert(d, {a, b}), Outcome::joined);
    EXPECT_EQ(hand.insert(middle, {a, b, c, d}), Outcome::split);
    EXPECT_EQ(hand.triangles(), 4u);
    EXPECT_EQ(hand.surface.states[hand.at(middle)], growing::PointState::interior);
}

TEST(ClusterMesh_OnePoint, HighOverATriangle_Waits) {
    const Vec3 above(0.5, 0.8 / 3, 0.4);
    ByHand hand({a, b, c, above}, 1.2);
    hand.insert(a, {});
    hand.insert(b, {a});
    hand.insert(c, {a, b});
    // A single triangle has no neighbours that could show that the surface bends here.
    EXPECT_EQ(hand.insert(above, {a, b, c}, false), Outcome::extra);
    EXPECT_EQ(hand.triangles(), 1u);
}

TEST(ClusterMesh_OnePoint, MeshesThatFaceApart_AreJoinedAfterReversingOne) {
    // Two triangles with opposite orientations in one plane, and a point between them.
    const Vec3 d(3, 0, 0), e(4, 0, 0), f(3.5, 0.8, 0), between(2, 0.1, 0);
    ByHand hand({a, b, c, d, e, f, between}, 1.8);
    hand.insert(a, {});
    hand.insert(b, {a});
    hand.insert(c, {a, b});
    hand.insert(d, {});
    hand.insert(e, {d});
    hand.insert(f, {d, e});
    ASSERT_TRUE(hand.has(d, e, f));
    for (const Vec3& point : {d, e, f}) {
        hand.surface.fans.reverse(hand.at(point));
        hand.surface.normals[hand.at(point)] = -hand.surface.normals[hand.at(point)];
    }
    EXPECT_EQ(hand.insert(between, {b, d, c, f}), Outcome::joined);
    EXPECT_TRUE(hand.has(a, b, c) == hand.has(d, e, f));
    EXPECT_GE(hand.triangles(), 4u);
}

}  // namespace
}  // namespace scanmill
