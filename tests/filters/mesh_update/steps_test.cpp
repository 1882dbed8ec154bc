// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "filters/mesh_update/blocks.hpp"
#include "mesh_update/replacement.hpp"
#include "mesh_update/resample.hpp"
#include "scanmill/base/random.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using namespace updating;
using ::testing::ElementsAre;
using ::testing::IsSubsetOf;

constexpr double degree = std::numbers::pi / 180;

TEST(Projection, EquationThree_FootInsideTheFacet) {
    const std::array<Vec3, 3> facet{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    const Projection found = project({0.2, 0.3, 0.5}, facet);
    EXPECT_EQ(found.distance, 0.5);
    EXPECT_EQ(found.foot, Vec3(0.2, 0.3, 0));
    EXPECT_TRUE(found.is_inside);
    EXPECT_EQ(project({0.2, 0.3, -0.5}, facet).distance, -0.5);
}

TEST(Projection, BordersAreInside_PointsBesideAreNot) {
    const std::array<Vec3, 3> facet{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    EXPECT_TRUE(project({0.5, 0, 3}, facet).is_inside);
    EXPECT_TRUE(project({0, 1, 3}, facet).is_inside);
    EXPECT_FALSE(project({0.51, 0.51, 0}, facet).is_inside);
    EXPECT_FALSE(project({-0.01, 0.5, 0}, facet).is_inside);
}

TEST(Projection, InsideIsWhereTheAnglesBetweenTheCornersAddUpToAFullTurn) {
    const std::array<Vec3, 3> facet{Vec3(0.3, -1, 2), Vec3(4, 0.5, 1), Vec3(-1, 3, 0)};
    for (int i = -5; i < 15; ++i)
        for (int j = -5; j < 15; ++j) {
            const Vec3 point =
                facet[0] + (i + 0.31) * 0.1 * (facet[1] - facet[0]) + (j + 0.17) * 0.1 * (facet[2] - facet[0]);
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 a = (facet[k] - point).normalized(), b = (facet[(k + 1) % 3] - point).normalized();
                sum += std::acos(std::clamp(a.dot(b), -1.0, 1.0));
            }
            EXPECT_EQ(project(point, facet).is_inside, std::abs(sum - 2 * std::numbers::pi) < 1e-6) << i << " " << j;
        }
}

/// A direction at this angle from -x, in the plane across the y axis.
Vec3 turned(double angle) { return {-std::cos(angle), 0, std::sin(angle)}; }

TEST(DihedralAngle, FigureEleven) {
    const Vec3 start(0, 0, 0), end(0, 1, 0), apex(-1, 0.5, 0), middle(0, 0.5, 0);
    for (const double angle : {4.45, 173.76})
        EXPECT_NEAR(dihedral_angle(start, end, apex, middle, middle + 3 * turned(angle * degree)), angle * degree,
                    1e-12);
}

TEST(DihedralAngle, SupplementOfThePrintedFormula) {
    const Vec3 start(0.2, -1, 0.4), end(1, 1.5, 0), apex(-1, 0.5, 0.7), vertex(2, 0.1, -0.6);
    const Vec3 cloud = (start - end).cross(start - apex).normalized();
    const Vec3 group = (start - vertex).cross(start - end).normalized();
    EXPECT_NEAR(dihedral_angle(start, end, apex, start, vertex), std::numbers::pi - std::acos(cloud.dot(group)), 1e-12);
}

TEST(DihedralAngle, DoesNotDependOnTheDirectionOfTheEdge) {
    const Vec3 start(0.2, -1, 0.4), end(1, 1.5, 0), apex(-1, 0.5, 0.7), middle = (start + end) / 2,
                                                                        vertex(2, 0.1, -0.6);
    EXPECT_NEAR(dihedral_angle(start, end, apex, middle, vertex), dihedral_angle(end, start, apex, middle, vertex),
                1e-12);
}

TEST(DihedralAngle, AnEdgeAboveTheModelHasTheAngleOfOneOnIt) {
    const Vec3 lift(0, 0, 0.4), start(0, 0, 0), end(0, 1, 0), apex(-1, 0.5, 0), middle(0, 0.5, 0);
    EXPECT_NEAR(dihedral_angle(start + lift, end + lift, apex + lift, middle, {0.1, 0.5, 0}), std::numbers::pi, 1e-12);
}

CloudAngles angles_of(std::vector<GroupAngle> groups) {
    CloudAngles angles;
    angles.groups = std::move(groups);
    return angles;
}

TEST(AngleCondition, TheSmallerOfTwoMeansIsReplaced) {
    const Choice choice = chosen_groups(angles_of({{0, 173.76 * degree, 1}, {1, 4.45 * degree, 1}}), 20 * degree);
    EXPECT_THAT(choice.replaced, ElementsAre(1));
    EXPECT_EQ(choice.ambiguity, "");
    // Both on one side of 90 degrees: the difference decides.
    EXPECT_THAT(chosen_groups(angles_of({{0, 60 * degree, 1}, {1, 85 * degree, 1}}), 20 * degree).replaced,
                ElementsAre(0));
}

TEST(AngleCondition, ADifferenceThatDoesNotExceedTheGapIsAmbiguous) {
    EXPECT_NE(chosen_groups(angles_of({{0, 1, 1}, {1, 1.25, 1}}), 0.25).ambiguity, "");
    EXPECT_EQ(chosen_groups(angles_of({{0, 1, 1}, {1, 1.25, 1}}), 0.2499).ambiguity, "");
}

TEST(AngleCondition, OfThreeGroupsThoseBelowARightAngle) {
    const Choice choice =
        chosen_groups(angles_of({{0, 175 * degree, 1}, {1, 5 * degree, 1}, {2, 8 * degree, 1}}), 20 * degree);
    EXPECT_THAT(choice.replaced, ElementsAre(1, 2));
    EXPECT_NE(chosen_groups(angles_of({{0, 175 * degree, 1}, {1, 5 * degree, 1}, {2, 85 * degree, 1}}), 20 * degree)
                  .ambiguity,
              "");
}

TEST(AngleCondition, FragmentsDoNotCountAsGroups) {
    const Choice choice = chosen_groups(
        angles_of({{0, 175 * degree, 1}, {1, 5 * degree, 1}, {2, 80 * degree, 0.1}, {3, 95 * degree, 0.1}}),
        20 * degree);
    EXPECT_THAT(choice.replaced, ElementsAre(1, 2));
    EXPECT_EQ(choice.ambiguity, "");
}

/// A cloud on the block's top, and the block with edges of at most 4.
/// The loop cuts corners of the grid, so its length and its place are known to a spacing only.
struct TopOfABlock : testing::Test {
    Context context;
    TriangleMesh mesh = resampled(block(), 4, {}, context).mesh;
    Model model{mesh, closed_opposites(mesh), FacetTree(mesh, 1)};
    CloudSurface cloud = cloud_surface(step_cloud({20, 10, 40, 30}, 20, 0, 4, 1)->positions, {}, context);
};

TEST_F(TopOfABlock, TheCloudHasOneLoopAlongItsBorder) {
    ASSERT_EQ(cloud.loops.size(), 1);
    EXPECT_FALSE(cloud.loops[0].is_hole);
    EXPECT_EQ(cloud.spacing, 1);
    EXPECT_NEAR(cloud.loops[0].length, 4 * 28, 0.2 * 4 * 28);
}

TEST(CloudSurface, TheOnlyLoopOfACloudAroundMostOfASphereIsNoHole) {
    Array<Vec3> most;
    for (const Vec3& p : geodesic_sphere(10, 30).positions)
        if (p.z() > -7) most.push_back(p);
    Context context;
    const CloudSurface cloud = cloud_surface(most, {}, context);
    ASSERT_EQ(cloud.loops.size(), 1);
    EXPECT_FALSE(cloud.loops[0].is_hole);
}

TEST_F(TopOfABlock, OverlapFacetsAreUnderTheBorder_AndDivideTheModelInTwo) {
    const LoopOverlap overlap = overlap_of(model, cloud, cloud.loops[0], 3, context);
    EXPECT_EQ(overlap.hanging, 0);
    for (const double offset : overlap.offsets) EXPECT_NEAR(offset, 0, 1e-12);
    Array<u8> is_overlap(mesh.triangles.size(), u8(0));
    for (const u32 facet : overlap.facets) {
        is_overlap[facet] = 1;
        for (const Vec3& corner : model.corners(facet)) EXPECT_EQ(corner.z(), 20);
    }
    const Groups groups = segmentation(model, is_overlap, context);
    EXPECT_EQ(groups.count, 2);
    EXPECT_EQ(groups.of_facet[0], 0) << "group 0 has the block's first vertex";
    const CloudAngles angles = mean_angles(model, groups, cloud, std::span(&overlap, 1), context);
    ASSERT_EQ(angles.groups.size(), 2);
    EXPECT_GT(angles.groups[0].mean, 140 * degree);
    EXPECT_LT(angles.groups[1].mean, 40 * degree);
    EXPECT_THAT(chosen_groups(angles, 0.3).replaced, ElementsAre(1));
}

TEST(EulerOfRest, IsThatOfTheFacetsThatStay) {
    // The dual graph of a sphere, cut at random: V - E + F of the rest, a vertex once per fan, by counting.
    const TriangleMesh mesh = geodesic_sphere(1, 6);
    const Model model(mesh, closed_opposites(mesh), FacetTree(mesh, 1));
    Context context;
    Random random(3);
    for (int round = 0; round < 20; ++round) {
        Array<u8> is_overlap(mesh.triangles.size());
        for (u8& flag : is_overlap) flag = random.uniform() < 0.4;
        const Groups groups = segmentation(model, is_overlap, context);
        std::vector<bool> replaced(groups.count);
        for (std::size_t g = 0; g < groups.count; ++g) replaced[g] = random.uniform() < 0.5;
        const auto stays = [&](u32 facet) {
            const std::int32_t group = groups.of_facet[facet];
            return group == Groups::overlap || !replaced[static_cast<std::size_t>(group)];
        };
        long facets = 0, half_edges = 0, border = 0, fans = 0;
        for (u32 h = 0; h < model.opposite.size(); ++h) {
            if (!stays(h / 3)) continue;
            facets += h % 3 == 0;
            ++half_edges;
            border += !stays(model.opposite[h] / 3);
        }
        for (u32 vertex = 0; vertex < mesh.positions.size(); ++vertex) {
            u32 at = 0;
            while (model.start(at) != vertex) ++at;
            long inside = 0, changes = 0;
            bool before = stays(model.opposite[at] / 3);  // the facet before the first one, clockwise
            model.for_each_around(at, [&](u32 h) {
                const bool now = stays(h / 3);
                inside += now;
                changes += now && !before;
                before = now;
            });
            fans += inside > 0 && changes == 0 ? 1 : changes;
        }
        EXPECT_EQ(euler_of_rest(model, groups, replaced, mesh.positions.size()),
                  fans - (half_edges + border) / 2 + facets);
    }
}

TEST_F(TopOfABlock, CandidatesAreASuperset) {
    const LoopOverlap projected = overlap_of(model, cloud, cloud.loops[0], 3, context);
    LoopOverlap candidates = projected;
    CandidateFacets(model, 1).add(cloud, cloud.loops[0], 3, candidates);
    EXPECT_GT(candidates.facets.size(), projected.facets.size());
    EXPECT_THAT(projected.facets, IsSubsetOf(candidates.facets));
}

TEST_F(TopOfABlock, FarFromTheModel_EveryPointHangs) {
    Array<Vec3> lifted(cloud.mesh.positions.begin(), cloud.mesh.positions.end());
    for (Vec3& position : lifted) position.z() += 5;
    cloud.mesh.positions = std::move(lifted);
    const LoopOverlap overlap = overlap_of(model, cloud, cloud.loops[0], 3, context);
    EXPECT_EQ(overlap.hanging, cloud.loops[0].half_edges.size());
    EXPECT_NEAR(overlap.farthest_distance, 5, 1e-9);
    EXPECT_TRUE(overlap.facets.empty());
}

TEST_F(TopOfABlock, ASparseCloudDividesADenseModel) {
    const TriangleMesh dense = resampled(block(), 0.6, {}, context).mesh;
    const Model dense_model(dense, closed_opposites(dense), FacetTree(dense, 1));
    const CloudSurface sparse = cloud_surface(step_cloud({20, 10, 40, 30}, 20, 0, 4, 4)->positions, {}, context);
    ASSERT_EQ(sparse.loops.size(), 1);
    const LoopOverlap overlap = overlap_of(dense_model, sparse, sparse.loops[0], 3, context);
    Array<u8> is_overlap(dense.triangles.size(), u8(0));
    for (const u32 facet : overlap.facets) is_overlap[facet] = 1;
    EXPECT_EQ(segmentation(dense_model, is_overlap, context).count, 2);
}

TEST_F(TopOfABlock, TrimDiscardsVerticesBesideAPoint) {
    const LoopOverlap overlap = overlap_of(model, cloud, cloud.loops[0], 3, context);
    const PointTree points(cloud.mesh.positions.span());
    const Array<u8> none(mesh.positions.size(), u8(0));
    Array<u8> untrimmed = none, trimmed = none;
    discard_under(model, overlap.facets, cloud, points, 0, none, untrimmed, context);
    discard_under(model, overlap.facets, cloud, points, 2, none, trimmed, context);
    NeighbourBuffer buffer;
    std::size_t more = 0;
    for (u32 vertex = 0; vertex < none.size(); ++vertex) {
        EXPECT_LE(untrimmed[vertex], trimmed[vertex]);
        if (untrimmed[vertex] == trimmed[vertex]) continue;
        ++more;
        // On a square grid, the six nearest neighbours are at most √2 away, also at its border at most 2.
        EXPECT_LT(points.nearest_to(mesh.positions[vertex], 1, buffer)[0].squared, 2 * 2 * 2 * 2);
    }
    EXPECT_GT(more, 0);
}

TEST_F(TopOfABlock, VerticesUnderTheCloudAreDiscarded_ThoseOutsideAreNot) {
    const LoopOverlap overlap = overlap_of(model, cloud, cloud.loops[0], 3, context);
    Array<u8> discarded(mesh.positions.size(), u8(0));
    const PointTree points(cloud.mesh.positions.span());
    discard_under(model, overlap.facets, cloud, points, 0.3, Array<u8>(discarded), discarded, context);
    std::set<u32> at_overlap;
    for (const u32 facet : overlap.facets)
        at_overlap.insert(mesh.triangles[facet].begin(), mesh.triangles[facet].end());
    std::size_t count = 0;
    for (u32 vertex = 0; vertex < discarded.size(); ++vertex) {
        const Vec3& p = mesh.positions[vertex];
        const bool is_inside = p.z() == 20 && p.x() > 18 && p.x() < 42 && p.y() > 8 && p.y() < 32;
        const bool is_outside = p.z() < 20 || p.x() < 15.7 || p.x() > 44.3 || p.y() < 5.7 || p.y() > 34.3;
        count += discarded[vertex];
        if (is_outside) {
            EXPECT_EQ(discarded[vertex], 0) << p.transpose();
        }
        if (is_inside && at_overlap.contains(vertex)) {
            EXPECT_EQ(discarded[vertex], 1) << p.transpose();
        }
    }
    EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace scanmill::test
