// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/pose_graph.hpp"

#include <gtest/gtest.h>

#include "scanmill/geometry/registration/relaxation.hpp"

namespace scanmill {
namespace {

RigidMotion shift(double x) {
    RigidMotion motion;
    motion.translation = Vec3(x, 0, 0);
    return motion;
}

const std::vector<ViewExtent> four_views(4, ViewExtent{Vec3::Zero(), 1});

TEST(Triples, AnEdgeThatContradictsTwoOthers_IsDropped) {
    // Views at 0, -1, -2, -3; the edge 0-3 is wrong by 5.
    const std::vector<GraphEdge> edges{{0, 1, shift(1), 1}, {0, 2, shift(2), 1}, {0, 3, shift(8), 1},
                                       {1, 2, shift(1), 1}, {1, 3, shift(2), 1}, {2, 3, shift(1), 1}};
    const CheckedEdges checked = checked_by_triples(edges, four_views, 0.5);
    EXPECT_EQ(checked.triples, 4u);
    EXPECT_EQ(checked.inconsistent, 2u);
    EXPECT_EQ(checked.dropped, 1u);
    EXPECT_EQ(checked.is_kept, std::vector<bool>({true, true, false, true, true, true}));
}

TEST(Triples, ADoubtfulEdge_NeedsAConsistentTriple) {
    std::vector<GraphEdge> edges{
        {0, 1, shift(1), 1, true}, {0, 2, shift(2), 1}, {1, 2, shift(1), 1}, {2, 3, shift(1), 1, true}};
    const CheckedEdges checked = checked_by_triples(edges, four_views, 0.5);
    EXPECT_EQ(checked.unconfirmed, 1u);
    EXPECT_EQ(checked.is_kept, std::vector<bool>({true, true, true, false}));
}

TEST(LargestTree, UsesTheEdgesWithTheLargestScores) {
    const std::vector<GraphEdge> edges{{0, 1, shift(1), 0.5}, {1, 2, shift(1), 0.6}, {0, 2, shift(9), 0.4}};
    const SpanningTree tree = largest_tree(edges, 4);
    EXPECT_EQ(tree.edges, std::vector<std::size_t>({1, 0}));
    EXPECT_EQ(tree.poses[0]->translation, Vec3::Zero());
    EXPECT_EQ(tree.poses[1]->translation, Vec3(-1, 0, 0));
    EXPECT_EQ(tree.poses[2]->translation, Vec3(-2, 0, 0));
    EXPECT_FALSE(tree.poses[3]);
}

TEST(LargestTree, OfGroupsWithEquallyManyViews_TakesTheLargerSum) {
    const std::vector<GraphEdge> edges{{0, 1, shift(1), 0.5}, {2, 3, shift(1), 0.6}};
    const SpanningTree tree = largest_tree(edges, 4);
    EXPECT_FALSE(tree.poses[0]);
    EXPECT_TRUE(tree.poses[2]);
}

TEST(Relaxation, TwoViewsOfACorner_MeetAgain) {
    std::vector<Vec3> corner;
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j) {
            const double a = 0.05 + 0.1 * i, b = 0.05 + 0.1 * j;
            corner.emplace_back(a, b, 0), corner.emplace_back(a, 0, b), corner.emplace_back(0, a, b);
        }
    const RigidMotion away = small_motion(Vec3(0.01, -0.02, 0.015), Vec3::Zero(), Vec3(0.03, 0.02, -0.03));
    std::vector<Vec3> moved;
    for (const Vec3& p : corner) moved.push_back(away.apply(p));
    const Vec3 to_scanner = Vec3(1, 1, 1).normalized();
    const ViewSurface first(corner, {&to_scanner, 1}, 8, 1000), second(moved, {&to_scanner, 1}, 8, 1000);
    EXPECT_NEAR(first.spacing(), 0.1, 1e-12);
    const ViewSurface* const views[] = {&first, &second};
    const ViewPair pairs[] = {{0, 1}};
    const RelaxationStage stages[] = {{0.2, 20}, {0.1, 20}};
    for (const unsigned threads : {1u, 2u}) {
        ExecutionOptions options;
        options.threads = threads;
        const Execution execution(options);
        const Relaxed result = relaxed(views, {RigidMotion(), RigidMotion()}, pairs, stages, 1e-9, execution);
        EXPECT_EQ(result.poses[0].translation, Vec3::Zero());
        EXPECT_LT(displacement(result.poses[1], away.inverse(), Vec3(1, 1, 1), 1), 1e-6);
        EXPECT_GT(result.residuals[0].points, 1500u);
        EXPECT_LT(result.residuals[0].squares, 1e-9);
        const Agreement fit = agreement(first, second, result.poses[1].inverse(), 0.2, 0.01);
        EXPECT_EQ(fit.close, fit.points);
    }
}

}  // namespace
}  // namespace scanmill
