// SPDX-License-Identifier: GPL-3.0-or-later
/// Creases that are made whole.

#include "probe_planner/whole_lines.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace scanmill::test {
namespace {

using probing::WholeLines;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

/// Left normals name the segment by its first two points, right normals are their opposite.
Vec3 left_of(u32 from, u32 to) { return Vec3(1, from, to).normalized(); }

struct Line {
    Array<u32> vertices;
    FeatureType type = FeatureType::crease;
    bool closed = false;
};

FeatureGraph graph_of(const Array<Vec3>& positions, const std::vector<Line>& lines) {
    FeatureGraph graph;
    graph.positions = Array<Vec3>(positions);
    Array<u32> vertices;
    Array<Vec3> left, right;
    for (const Line& line : lines) {
        const u32 begin = static_cast<u32>(vertices.size()), count = static_cast<u32>(line.vertices.size());
        for (u32 i = 0; i < count; ++i) {
            const bool is_segment = line.closed || i + 1 < count;
            vertices.push_back(line.vertices[i]);
            left.push_back(is_segment ? left_of(line.vertices[i], line.vertices[(i + 1) % count]) : Vec3::Zero());
            right.push_back(-left.back());
        }
        graph.polylines.push_back({line.type, line.closed, begin, begin + count});
    }
    graph.vertices = std::move(vertices);
    graph.left_normals = std::move(left);
    graph.right_normals = std::move(right);
    return graph;
}

WholeLines whole_lines(const FeatureGraph& graph, double error) {
    Context context;
    return probing::whole_lines(graph, error, context);
}

Array<u32> vertices_of(const FeatureGraph& graph, std::size_t row) {
    const FeaturePolyline& line = graph.polylines[row];
    return Array<u32>(graph.vertices.begin() + line.begin, graph.vertices.begin() + line.end);
}

std::vector<Array<u32>> lines_of(const WholeLines& whole) {
    std::vector<Array<u32>> lines;
    for (std::size_t row = 0; row < whole.features.polylines.size(); ++row)
        lines.push_back(vertices_of(whole.features, row));
    return lines;
}

/// Every segment has its own normals, on the sides that its direction demands.
void expect_normals(const FeatureGraph& graph) {
    for (const FeaturePolyline& line : graph.polylines)
        for (u32 i = line.begin; i < line.end; ++i) {
            const bool is_last = i + 1 == line.end;
            const Vec3 &left = graph.left_normals[i], &right = graph.right_normals[i];
            if (is_last && !line.closed) {
                EXPECT_EQ(left, Vec3::Zero());
                EXPECT_EQ(right, Vec3::Zero());
                continue;
            }
            const u32 from = graph.vertices[i], to = graph.vertices[is_last ? line.begin : i + 1];
            EXPECT_TRUE(left == left_of(from, to) || right == left_of(to, from)) << from << " to " << to;
            EXPECT_EQ(left, -right);
        }
}

TEST(WholeLines, WithoutShortCreases_StayAsTheyAre) {
    const FeatureGraph graph =
        graph_of({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {10, 10, 0}}, {{{0, 1}}, {{1, 2}}, {{3, 1}}});
    const WholeLines whole = whole_lines(graph, 1);
    EXPECT_EQ(whole.left_out, 0u);
    EXPECT_THAT(lines_of(whole), ElementsAre(ElementsAre(0, 1), ElementsAre(1, 2), ElementsAre(3, 1)));
    EXPECT_THAT(whole.rows, ElementsAre(0, 1, 2));
    expect_normals(whole.features);
}

TEST(WholeLines, ABranch_IsLeftOutAndItsLineIsJoined) {
    // 0 - 1 - 2 along x in three creases of which the last runs backwards; branches of 1 and 1.5 at the points 1 and 2.
    const FeatureGraph graph = graph_of({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {30, 0, 0}, {10, 1, 0}, {20, 0, 1.5}},
                                        {{{1, 4}}, {{0, 1}}, {{1, 2}}, {{3, 2}}, {{2, 5}}});
    const WholeLines whole = whole_lines(graph, 1);
    EXPECT_EQ(whole.left_out, 2u);
    EXPECT_THAT(lines_of(whole), ElementsAre(ElementsAre(0, 1, 2, 3)));
    EXPECT_THAT(whole.rows, ElementsAre(1));
    expect_normals(whole.features);
    EXPECT_EQ(whole_lines(graph, 0.6).left_out, 1u) << "1.5 is no short branch at an error of 0.6";
    EXPECT_EQ(whole_lines(graph, 0.5).left_out, 0u) << "a branch of exactly 2 errors stays";
}

/// Two rails of `count` segments with a rung at every vertex, `width` apart, and a line at either end of the lower
/// rail.
FeatureGraph ladder(u32 count, double segment, double width) {
    Array<Vec3> positions;
    std::vector<Line> lines;
    for (u32 i = 0; i <= count; ++i) {
        positions.emplace_back(segment * i, 0, 0);
        positions.emplace_back(segment * i, width, 0);
    }
    positions.emplace_back(-9, 0, 0);
    positions.emplace_back(segment * count + 9, 0, 0);
    lines.push_back({{2 * count + 2, 0}});
    for (u32 i = 0; i < count; ++i) {
        lines.push_back({{2 * i, 2 * i + 2}});
        lines.push_back({{2 * i + 1, 2 * i + 3}});
        lines.push_back({{2 * i, 2 * i + 1}});
    }
    lines.push_back({{2 * count, 2 * count + 1}});
    lines.push_back({{2 * count, 2 * count + 3}});
    return graph_of(positions, lines);
}

TEST(WholeLines, ALadder_BecomesItsOneSide) {
    for (const double segment : {0.3, 0.7, 1.0, 3.0})
        for (const double width : {0.3, 0.8, 1.5}) {
            SCOPED_TRACE(testing::Message() << "rails of " << segment << ", rungs of " << width);
            const FeatureGraph graph = ladder(10, segment, width);
            const WholeLines whole = whole_lines(graph, 1);
            ASSERT_EQ(whole.features.polylines.size(), 1u);
            const Array<u32> line = vertices_of(whole.features, 0);
            EXPECT_THAT((std::array{line.front(), line.back()}), UnorderedElementsAre(22u, 23u));
            double length = 0;
            for (std::size_t i = 0; i + 1 < line.size(); ++i)
                length += (graph.positions[line[i + 1]] - graph.positions[line[i]]).norm();
            EXPECT_LE(length, 10 * segment + 18 + 2 * width + 1e-9) << "on one rail, apart from its ends";
            expect_normals(whole.features);
        }
}

TEST(WholeLines, IsolatedSlits_LoseOneSide) {
    // A rectangle of 20 x 0.8 in four creases, and two creases on one another.
    const FeatureGraph rectangle =
        graph_of({{0, 0, 0}, {20, 0, 0}, {20, 0.8, 0}, {0, 0.8, 0}}, {{{0, 1}}, {{1, 2}}, {{2, 3}}, {{3, 0}}});
    EXPECT_THAT(lines_of(whole_lines(rectangle, 1)), ElementsAre(UnorderedElementsAre(0, 1, 2, 3)));
    EXPECT_EQ(whole_lines(rectangle, 1).left_out, 1u);
    const FeatureGraph twice = graph_of({{0, 0, 0}, {9, 0, 0}, {20, 0, 0}}, {{{0, 1, 2}}, {{2, 1, 0}}});
    EXPECT_THAT(lines_of(whole_lines(twice, 1)), ElementsAre(ElementsAre(0, 1, 2)));
}

TEST(WholeLines, ALongBevel_BecomesItsShorterSide) {
    // Sides of 20 and 20.2 with rungs of 0.8 at their ends, and a line at either end of the longer side.
    const FeatureGraph graph =
        graph_of({{0, 0, 0}, {20, 0, 0}, {0, 0.8, 0}, {10, 2.221, 0}, {20, 0.8, 0}, {-9, 0.8, 0}, {29, 0.8, 0}},
                 {{{0, 1}}, {{2, 3, 4}}, {{0, 2}}, {{1, 4}}, {{5, 2}}, {{4, 6}}});
    const WholeLines whole = whole_lines(graph, 1.2);
    EXPECT_THAT(lines_of(whole), ElementsAre(ElementsAre(5, 2, 3, 4, 6)));
    EXPECT_EQ(whole.left_out, 1u);
    EXPECT_EQ(whole_lines(graph, 1).left_out, 0u) << "the middle is 2.2 from the other side";
}

TEST(WholeLines, ALoop_StaysUnlessItIsSmall) {
    const FeatureGraph graph = graph_of({{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {-9, 0, 0}}, {{{0, 1, 2, 0}}, {{3, 0}}});
    EXPECT_EQ(whole_lines(graph, 1).left_out, 0u);
    const FeatureGraph small =
        graph_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-9, 0, 0}, {9, 0, 0}}, {{{0, 1, 2, 0}}, {{3, 0}}, {{0, 4}}});
    EXPECT_THAT(lines_of(whole_lines(small, 1)), ElementsAre(ElementsAre(3, 0, 4)));
}

TEST(WholeLines, ARing_ThatATriangleInterrupts_IsClosed) {
    // A square of 10 whose corner 0 is a triangle 0, 4, 5.
    const FeatureGraph graph = graph_of({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, {0.5, 0, 0}, {0, 0.5, 0}},
                                        {{{4, 1, 2, 3, 5}}, {{0, 4}}, {{0, 5}}, {{4, 5}}});
    const WholeLines whole = whole_lines(graph, 1);
    ASSERT_EQ(whole.features.polylines.size(), 1u);
    EXPECT_TRUE(whole.features.polylines[0].closed);
    EXPECT_EQ(whole.left_out, 1u) << "the longer way between the points 4 and 5";
    EXPECT_THAT(vertices_of(whole.features, 0), UnorderedElementsAre(1, 2, 3, 4, 5));
    expect_normals(whole.features);
}

TEST(WholeLines, IsolatedShortCreases_AreLeftOut) {
    const FeatureGraph graph = graph_of({{0, 0, 0}, {10, 0, 0}, {5, 5, 0}, {6, 5, 0}}, {{{2, 3}}, {{0, 1}}});
    const WholeLines whole = whole_lines(graph, 1);
    EXPECT_THAT(lines_of(whole), ElementsAre(ElementsAre(0, 1)));
    EXPECT_THAT(whole.rows, ElementsAre(1));
}

TEST(WholeLines, LargeCycles_AndCreasesBetweenBoundaries_Stay) {
    // A square hole of 2 (whose halves are 2 apart) in four creases with long lines at two corners.
    const FeatureGraph square = graph_of({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {-9, 0, 0}, {9, 2, 0}},
                                         {{{0, 1}}, {{1, 2}}, {{2, 3}}, {{3, 0}}, {{4, 0}}, {{2, 5}}});
    EXPECT_EQ(whole_lines(square, 1).left_out, 0u);
    // A short crease from one boundary to another.
    const FeatureGraph bridge =
        graph_of({{0, 0, 0}, {0, 9, 0}, {-9, 0, 0}, {1, 0, 0}, {1, 9, 0}, {9, 0, 0}},
                 {{{0, 1, 2}, FeatureType::hole, true}, {{3, 4, 5}, FeatureType::hole, true}, {{0, 3}}});
    EXPECT_EQ(whole_lines(bridge, 1).left_out, 0u);
}

TEST(WholeLines, TheOrderOfTheLines_DecidesOnlyTies) {
    Array<Vec3> positions;
    for (u32 i = 0; i < 40; ++i) positions.emplace_back(i, 0.1 * ((7 * i) % 5), 0);
    for (u32 i = 0; i < 40; ++i) positions.emplace_back(i + 0.07 * ((3 * i) % 4), 0.9 + 0.01 * i, 0);
    std::vector<Line> lines;
    for (u32 i = 0; i + 1 < 40; ++i) {
        lines.push_back({{i, i + 1}});
        if (i % 3) lines.push_back({{40 + i, 41 + i}});
        if (i % 4) lines.push_back({{i, 40 + i}});
    }
    const auto kept_length = [&](const WholeLines& whole) {
        double length = 0;
        for (const Array<u32>& line : lines_of(whole))
            for (std::size_t i = 0; i + 1 < line.size(); ++i)
                length += (positions[line[i + 1]] - positions[line[i]]).norm();
        return length;
    };
    const WholeLines one = whole_lines(graph_of(positions, lines), 1);
    std::ranges::reverse(lines);
    const WholeLines other = whole_lines(graph_of(positions, lines), 1);
    EXPECT_EQ(one.left_out, other.left_out);
    EXPECT_NEAR(kept_length(one), kept_length(other), 1e-9);
    EXPECT_GT(kept_length(one), 35) << "the line goes all the way";
}

}  // namespace
}  // namespace scanmill::test
