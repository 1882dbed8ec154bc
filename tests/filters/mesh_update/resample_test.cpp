// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/resample.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "scanmill/base/random.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/topology.hpp"
#include "support/mesh_operations.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::updating {
namespace {

using namespace test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

using Counts = std::function<bool(const std::array<Vec3, 3>&)>;

Resampled resampled_within(const TriangleMesh& mesh, double longest, const Counts& counts = {},
                           std::size_t most = most_added) {
    Context context;
    return resampled(mesh, longest, counts, context, most);
}

/// [0, 60] × [0, 40] × [0, 20]; bit i of `diagonals` chooses the diagonal of face i.
TriangleMesh box(unsigned diagonals = 0) {
    Array<Vec3> positions;
    for (const double z : {0.0, 20.0})
        for (const double y : {0.0, 40.0})
            for (const double x : {0.0, 60.0}) positions.emplace_back(x, y, z);
    const u32 faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    Array<Triangle> triangles;
    for (u32 i = 0; i < 6; ++i) {
        const auto& f = faces[i];
        if (diagonals >> i & 1) {
            triangles.push_back({f[0], f[1], f[2]});
            triangles.push_back({f[0], f[2], f[3]});
        } else {
            triangles.push_back({f[1], f[2], f[3]});
            triangles.push_back({f[1], f[3], f[0]});
        }
    }
    return soup(positions, triangles);
}

TriangleMesh with_sharp_edges(TriangleMesh mesh, Array<Edge> edges) {
    std::ranges::sort(edges);
    mesh.sharp_edges = edges;
    return mesh;
}

std::set<Edge> edges_of(const TriangleMesh& mesh) {
    std::set<Edge> edges;
    for (const auto& [a, b, c] : mesh.triangles) edges.insert({make_edge(a, b), make_edge(b, c), make_edge(c, a)});
    return edges;
}

double length_of(const TriangleMesh& mesh, const Edge& edge) {
    return (mesh.positions[edge[0]] - mesh.positions[edge[1]]).norm();
}

std::array<Vec3, 3> corners_of(const TriangleMesh& mesh, const Triangle& t) {
    return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

double angle_at(const Vec3& apex, const Vec3& a, const Vec3& b) {
    return std::atan2((a - apex).cross(b - apex).norm(), (a - apex).dot(b - apex)) / degree;
}

double least_angle(const std::array<Vec3, 3>& t) {
    return std::min({angle_at(t[0], t[1], t[2]), angle_at(t[1], t[2], t[0]), angle_at(t[2], t[0], t[1])});
}

double least_angle(const TriangleMesh& mesh) {
    double least = 180;
    for (const Triangle& triangle : mesh.triangles) least = std::min(least, least_angle(corners_of(mesh, triangle)));
    return least;
}

/// Two triangles with a common edge.
struct Quad {
    std::array<u32, 2> rows;
    std::array<u32, 2> apexes;  ///< in the order of the rows
};

/// Sorted by edge.
std::vector<std::pair<Edge, Quad>> quads(const TriangleMesh& mesh) {
    std::vector<std::tuple<Edge, u32, u32>> sides;
    for (u32 row = 0; row < mesh.triangles.size(); ++row) {
        const auto [a, b, c] = mesh.triangles[row];
        sides.insert(sides.end(), {{make_edge(a, b), row, c}, {make_edge(b, c), row, a}, {make_edge(c, a), row, b}});
    }
    std::ranges::sort(sides);
    std::vector<std::pair<Edge, Quad>> result;
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        const auto& [edge, row, apex] = sides[i];
        const auto& [next, next_row, next_apex] = sides[i + 1];
        if (edge == next) result.push_back({edge, Quad{{row, next_row}, {apex, next_apex}}});
    }
    return result;
}

const Quad* quad_at(const std::vector<std::pair<Edge, Quad>>& all, const Edge& edge) {
    const auto found = std::ranges::lower_bound(all, edge, {}, &std::pair<Edge, Quad>::first);
    return found != all.end() && found->first == edge ? &found->second : nullptr;
}

/// The triangles' normals agree to 0.1 thousandth of a degree.
bool is_flat(const TriangleMesh& mesh, const Quad& quad) {
    std::array<Vec3, 2> normals;
    for (u32 i = 0; i < 2; ++i) {
        const auto [a, b, c] = corners_of(mesh, mesh.triangles[quad.rows[i]]);
        normals[i] = (b - a).cross(c - a).normalized();
    }
    return angle_at(Vec3::Zero(), normals[0], normals[1]) < 1e-4;
}

bool is_flippable(const TriangleMesh& mesh, const Quad& quad, const Counts& counts) {
    for (const u32 row : quad.rows)
        if (counts && !counts(corners_of(mesh, mesh.triangles[row]))) return false;
    return is_flat(mesh, quad);
}

/// Flips the first edge that has to be flipped.
bool flip_one(TriangleMesh& mesh, const Counts& counts) {
    for (const auto& [edge, quad] : quads(mesh)) {
        const Vec3 &a = mesh.positions[edge[0]], &b = mesh.positions[edge[1]];
        const Vec3 &c = mesh.positions[quad.apexes[0]], &d = mesh.positions[quad.apexes[1]];
        if ((a - c).dot(b - c) >= 0 && (a - d).dot(b - d) >= 0) continue;  // both angles are at most 90°
        if (angle_at(c, a, b) + angle_at(d, a, b) < 180 + 1e-4) continue;
        const double least = std::min(least_angle({a, b, c}), least_angle({a, b, d}));
        if (least > std::asin(thin_sine) / degree || !is_flippable(mesh, quad, counts)) continue;
        Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
        for (u32 i = 0; i < 2; ++i)  // each triangle loses one end of the edge
            for (u32& vertex : triangles[quad.rows[i]])
                if (vertex == edge[i]) {
                    vertex = quad.apexes[1 - i];
                    break;
                }
        mesh.triangles = triangles;
        return true;
    }
    return false;
}

/// The side to split before this edge, by the rule of the header, or the edge.
Edge split_before(const TriangleMesh& mesh, const Edge& edge, double longest, const Counts& counts) {
    const std::vector<std::pair<Edge, Quad>> all = quads(mesh);
    const Quad* const around = quad_at(all, edge);
    if (around == nullptr || !is_flippable(mesh, *around, counts)) return edge;
    Edge best = edge;
    double most = longest;
    for (const u32 apex : around->apexes)
        for (u32 i = 0; i < 2; ++i) {
            const Edge side = make_edge(edge[i], apex), third = make_edge(edge[1 - i], apex);
            const Quad* const quad = quad_at(all, side);
            if (quad != nullptr && is_flippable(mesh, *quad, counts)) continue;
            if (length_of(mesh, third) >= longest / 2) continue;
            const double length = length_of(mesh, side);
            if (length > most || (length == most && length > longest && side < best)) {
                most = length;
                best = side;
            }
        }
    return best;
}

/// The rules in another form: a search among all edges before every split and every flip.
TriangleMesh searched(const TriangleMesh& mesh, double longest, const Counts& counts) {
    TriangleMesh result = mesh;
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    while (true) {
        result.positions = positions;
        result.triangles = triangles;
        Edge next{};
        double most = longest * longest;
        for (const Triangle& t : triangles) {
            if (counts && !counts(corners_of(result, t))) continue;
            for (u32 i = 0; i < 3; ++i) {
                const Edge edge = make_edge(t[i], t[(i + 1) % 3]);
                const double length = (positions[edge[0]] - positions[edge[1]]).squaredNorm();
                if (length > most || (length == most && length > longest * longest && edge < next)) {
                    most = length;
                    next = edge;
                }
            }
        }
        if (next == Edge{}) return result;
        const auto [lower, higher] = split_before(result, next, longest, counts);
        const u32 midpoint = static_cast<u32>(positions.size());
        positions.push_back((positions[lower] + positions[higher]) / 2);
        for (const bool ascending : {true, false})
            for (std::size_t row = 0; row < triangles.size(); ++row)
                for (u32 i = 0; i < 3; ++i) {
                    const u32 j = (i + 1) % 3;
                    if (triangles[row][i] != (ascending ? lower : higher)) continue;
                    if (triangles[row][j] != (ascending ? higher : lower)) continue;
                    Triangle half = triangles[row];
                    triangles[row][ascending ? j : i] = midpoint;
                    half[ascending ? i : j] = midpoint;
                    triangles.push_back(half);
                    break;
                }
        result.positions = positions;
        result.triangles = triangles;
        while (flip_one(result, counts)) {
        }
        triangles.assign(result.triangles.begin(), result.triangles.end());
    }
}

/// The triangles in another order, each from its lowest vertex.
std::set<Triangle> set_of_triangles(const TriangleMesh& mesh) {
    std::set<Triangle> result;
    for (Triangle t : mesh.triangles) {
        std::ranges::rotate(t, std::ranges::min_element(t));
        result.insert(t);
    }
    return result;
}

void expect_same_surface(const TriangleMesh& mesh, const TriangleMesh& other) {
    EXPECT_TRUE(std::ranges::equal(mesh.positions, other.positions));
    EXPECT_EQ(set_of_triangles(mesh), set_of_triangles(other));
}

void expect_laws(const TriangleMesh& mesh, const Resampled& result, double longest) {
    const TriangleMesh& after = result.mesh;
    ASSERT_EQ(after.positions.size(), mesh.positions.size() + result.added);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) ASSERT_EQ(after.positions[i], mesh.positions[i]);
    for (const Edge& edge : edges_of(after)) ASSERT_LE(length_of(after, edge), longest * (1 + 1e-15));
    EXPECT_NEAR(area(after), area(mesh), 1e-12 * area(mesh));
    const double volume = test::signed_volume(mesh);
    EXPECT_NEAR(test::signed_volume(after), volume, 1e-12 * std::max(std::abs(volume), area(mesh)));
    const MeshTopology one = topology(mesh), other = topology(after);
    EXPECT_EQ(other.euler, one.euler);
    EXPECT_EQ(other.closed, one.closed);
    EXPECT_EQ(other.boundary_loops, one.boundary_loops);
    EXPECT_EQ(other.nonmanifold_edges + other.nonmanifold_vertices + other.misoriented_edges, 0u);
    EXPECT_GE(least_angle(after), least_angle(mesh) / 2 * (1 - 1e-9));
}

TEST(Resample, Box_HasTheCountsOfThePage_WhicheverDiagonalsItsFacesHave) {
    for (unsigned diagonals = 0; diagonals < 64; ++diagonals) {
        const TriangleMesh mesh = box(diagonals);
        const Resampled result = resampled_within(mesh, 4);
        EXPECT_EQ(result.added, 1786u);
        EXPECT_EQ(result.mesh.positions.size(), 1794u);
        EXPECT_EQ(result.mesh.triangles.size(), 3584u);
        double shortest = infinity, longest = 0;
        for (const Edge& edge : edges_of(result.mesh)) {
            shortest = std::min(shortest, length_of(result.mesh, edge));
            longest = std::max(longest, length_of(result.mesh, edge));
        }
        EXPECT_EQ(shortest, 1.25);
        EXPECT_NEAR(longest, 3.953, 5e-4);
        EXPECT_NEAR(least_angle(mesh), 18.43, 5e-3);
        EXPECT_NEAR(least_angle(result.mesh), least_angle(mesh), 1e-9);
        expect_laws(mesh, result, 4);
    }
}

TEST(Resample, Box_OtherSpacings) {
    for (const auto& [longest, added] : {std::pair{8.0, 442u}, std::pair{2.0, 7162u}}) {
        const Resampled result = resampled_within(box(), longest);
        EXPECT_EQ(result.added, added);
        EXPECT_EQ(result.mesh.triangles.size(), 2 * result.mesh.positions.size() - 4);
        expect_laws(box(), result, longest);
    }
}

/// Two triangles with the common edge from 0 to 1, four units long; the other edges have the length √5.
TriangleMesh kite() { return soup({{0, 0, 0}, {4, 0, 0}, {2, 1, 0}, {2, -1, 0}}, {{0, 1, 2}, {1, 0, 3}}); }

TEST(Resample, Kite_TheHalvesAtTheLowerVertexKeepTheirRows) {
    const Resampled result = resampled_within(kite(), 2.5);
    EXPECT_EQ(result.added, 1u);
    EXPECT_EQ(result.mesh.positions[4], Vec3(2, 0, 0));
    EXPECT_THAT(result.mesh.triangles.span(),
                ElementsAre(Triangle{0, 4, 2}, Triangle{4, 0, 3}, Triangle{4, 1, 2}, Triangle{1, 4, 3}));
}

TEST(Resample, TheTriangleInAscendingDirectionIsTheFirstToBeAppended_WhateverItsRow) {
    TriangleMesh mesh = kite();
    mesh.triangles = {{1, 0, 3}, {0, 1, 2}};
    EXPECT_THAT(resampled_within(mesh, 2.5).mesh.triangles.span(),
                ElementsAre(Triangle{4, 0, 3}, Triangle{0, 4, 2}, Triangle{4, 1, 2}, Triangle{1, 4, 3}));
}

TEST(Resample, AnEdgeOfTheLimitLength_IsNotSplit) {
    EXPECT_EQ(resampled_within(kite(), 4).added, 0u);
    EXPECT_EQ(resampled_within(kite(), std::nextafter(4, 0)).added, 1u);
}

TEST(Resample, EqualEdges_AreSplitInTheOrderOfTheirVertices) {
    // All edges of this tetrahedron have the squared length 2.
    const TriangleMesh mesh =
        soup({{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}, {{2, 3, 1}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}});
    const Resampled result = resampled_within(mesh, 1.4);
    ASSERT_EQ(result.added, 6u);
    u32 row = 4;
    for (u32 a = 0; a < 4; ++a)
        for (u32 b = a + 1; b < 4; ++b)
            EXPECT_EQ(result.mesh.positions[row++], (mesh.positions[a] + mesh.positions[b]) / 2);
}

/// A geodesic sphere, stretched and shaken, so that few edges have equal lengths.
TriangleMesh potato(u32 frequency) {
    Random random(7);
    return with_positions(geodesic_sphere(1, frequency), [&](const Vec3& p) -> Vec3 {
        return Vec3(3 * p.x(), p.y(), p.z()) + 0.1 * Vec3(random.uniform(), random.uniform(), random.uniform());
    });
}

TEST(Resample, EqualsASearchAmongAllEdges) {
    const Counts in_front = [](const std::array<Vec3, 3>& t) { return (t[0] + t[1] + t[2]).x() > 1; };
    const Counts none_large = [](const std::array<Vec3, 3>& t) {
        return (t[1] - t[0]).cross(t[2] - t[0]).norm() < 0.2;
    };
    for (const Counts& counts : {Counts{}, in_front, none_large})
        for (const TriangleMesh& mesh :
             {potato(2), cube(), torus(2, 0.5, 5, 4), without_triangles(potato(2), {3, 4, 20}), l_block(),
              both(cube(), rectangle(2, 1, 3))})
            for (const double longest : {1.0, 0.4}) {
                const Resampled result = resampled_within(mesh, longest, counts);
                expect_same_surface(result.mesh, searched(mesh, longest, counts));
                if (!counts) expect_laws(mesh, result, longest);
            }
}

/// Points at random heights on both sides of [0, width] × [0, 1], and the triangles between them, from the left side.
TriangleMesh ladder(u32 count, double width) {
    Random random(5);
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 i = 0; i < count; ++i) {
        positions.emplace_back(0, (i + random.uniform()) / count, 0);
        positions.emplace_back(width, (i + random.uniform()) / count, 0);
    }
    for (u32 i = 2; i + 2 < 2 * count; i += 2) {
        triangles.push_back({0, i + 1, i + 3});
        triangles.push_back({i - 2, 2 * count - 1, i});
    }
    triangles.push_back({0, 1, 3});
    triangles.push_back({2 * count - 4, 2 * count - 1, 2 * count - 2});
    return soup(positions, triangles);
}

TEST(Resample, FlatRegions_HaveNoEdgeLeftThatHasToBeFlipped) {
    for (const TriangleMesh& mesh : {ladder(8, 1.7), ladder(20, 0.6), turned(ladder(12, 1.1), 0.7, {1, 2, 3}),
                                     turned(scaled(ladder(6, 0.05), 3), 0.3, {3, 2, 1})}) {
        TriangleMesh flipped = mesh;
        EXPECT_TRUE(flip_one(flipped, {}));
        for (const double longest : {0.43, 0.22}) {
            const Resampled result = resampled_within(mesh, longest);
            EXPECT_GT(result.added, 0u);
            TriangleMesh after = result.mesh;
            EXPECT_FALSE(flip_one(after, {}));
            for (const Edge& edge : edges_of(after)) EXPECT_LE(length_of(after, edge), longest * (1 + 1e-15));
            EXPECT_NEAR(area(after), area(mesh), 1e-12 * area(mesh));
            EXPECT_EQ(topology(after).boundary_loops, 1u);
            EXPECT_EQ(topology(after).euler, 1);
        }
    }
}

/// A thin rhombus around the edge from 0 to 1, whose corner 3 is at this height, and a long triangle elsewhere.
TriangleMesh thin_rhombus(double height = 0) {
    return soup({{0, 0, 0}, {8, 0, 0}, {4, 1, 0}, {4, -1, height}, {0, 50, 0}, {20, 50, 0}, {0, 60, 0}},
                {{0, 1, 2}, {1, 0, 3}, {4, 5, 6}});
}

TEST(Resample, ThinRhombusAndLongStrip_EqualASearchAmongAllEdges) {
    const Counts lower = [](const std::array<Vec3, 3>& t) { return (t[0] + t[1] + t[2]).y() < 6; };
    for (const Counts& counts : {Counts{}, lower})
        for (const TriangleMesh& mesh : {thin_rhombus(), thin_rhombus(0.5), rectangle(9, 0.5), rectangle(0.7, 11)})
            for (const double longest : {6.0, 2.2}) {
                const Resampled result = resampled_within(mesh, longest, counts);
                expect_same_surface(result.mesh, searched(mesh, longest, counts));
            }
}

/// A fan from one corner of a square of this size to points on both sides that do not touch it.
TriangleMesh fan(double size, u32 count) {
    Array<Vec3> positions{{0, 0, 0}};
    Array<Triangle> triangles;
    for (u32 i = 0; i <= count; ++i) positions.emplace_back(size, size * i / count, 0);
    for (u32 i = 1; i <= count; ++i) positions.emplace_back(size - size * i / count, size, 0);
    for (u32 i = 1; i <= 2 * count; ++i) triangles.push_back({0, i, i + 1});
    return soup(positions, triangles);
}

/// For each added vertex farther than `margin` from the old ones, the distance to its nearest neighbour.
std::vector<double> nearest_distances(const TriangleMesh& after, std::size_t old, double margin) {
    std::vector<double> result;
    for (std::size_t i = old; i < after.positions.size(); ++i) {
        double to_old = infinity, nearest = infinity;
        for (std::size_t j = 0; j < after.positions.size(); ++j) {
            if (j == i) continue;
            const double distance = (after.positions[i] - after.positions[j]).norm();
            nearest = std::min(nearest, distance);
            if (j < old) to_old = std::min(to_old, distance);
        }
        if (to_old > margin) result.push_back(nearest);
    }
    return result;
}

TEST(Resample, FanOfThinTriangles_GetsEvenlySpreadVertices) {
    for (const TriangleMesh& mesh : {fan(10, 100), turned(fan(10, 100), 0.7, {1, 2, 3})}) {
        // The least angle is that between the diagonal and its neighbour: below 0.3°.
        ASSERT_LT(least_angle(mesh), 0.3);
        const Resampled result = resampled_within(mesh, 1);
        EXPECT_NEAR(area(result.mesh), 100, 1e-10);
        EXPECT_EQ(topology(result.mesh).boundary_loops, 1u);
        // A triangle with a side of 0.1 on the square's border, and no side above 1.
        EXPECT_GT(least_angle(result.mesh), 3);
        // The midpoint of the longest side is at least tan(asin(thin_sine)) / 2 of it from the third vertex.
        std::vector<double> distances = nearest_distances(result.mesh, mesh.positions.size(), 1);
        ASSERT_GT(distances.size(), 50u);
        EXPECT_GT(std::ranges::min(distances), thin_sine / 2);
        std::ranges::sort(distances);
        EXPECT_GT(distances[distances.size() / 2], 0.4);
        // Equilateral triangles with sides of one half have 4.6 vertices per unit of area.
        EXPECT_LT(result.added, 460u);
    }
}

TEST(Resample, FanWithRoundedCoordinates_IsFlatToSinglePrecision) {
    const TriangleMesh exact = turned(fan(10, 100), 0.7, {1, 2, 3});
    const TriangleMesh rounded = with_positions(exact, [](const Vec3& p) -> Vec3 {
        const volatile float x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
                             z = static_cast<float>(p.z());
        return {x, y, z};
    });
    const double added = static_cast<double>(resampled_within(exact, 1).added);
    const Resampled result = resampled_within(rounded, 1);
    EXPECT_NEAR(static_cast<double>(result.added), added, 0.05 * added);
    EXPECT_NEAR(area(result.mesh), 100, 100e-6);
    for (std::size_t i = 0; i < rounded.positions.size(); ++i)
        EXPECT_EQ(result.mesh.positions[i], rounded.positions[i]);
}

TEST(Resample, ThinRhombus_IsFlipped_ButNotAcrossACrease) {
    const auto has_flipped = [](const TriangleMesh& mesh) {
        const std::set<Edge> edges = edges_of(resampled_within(mesh, 10).mesh);
        EXPECT_NE(edges.contains({0, 1}), edges.contains({2, 3}));
        return edges.contains({2, 3});
    };
    EXPECT_TRUE(has_flipped(thin_rhombus()));
    // The edges are half of the height apart; 1e-9 of 8 is allowed.
    EXPECT_TRUE(has_flipped(thin_rhombus(1.5e-8)));
    EXPECT_FALSE(has_flipped(thin_rhombus(1.7e-8)));
    EXPECT_FALSE(has_flipped(thin_rhombus(0.5)));
    EXPECT_FALSE(has_flipped(with_sharp_edges(thin_rhombus(), {{0, 1}})));
    TriangleMesh with_edge = thin_rhombus();
    with_edge.edges = {{1, 0}};
    EXPECT_FALSE(has_flipped(with_edge));
}

TEST(Resample, WithoutLongEdges_NothingIsFlipped) {
    const TriangleMesh mesh = thin_rhombus();
    const Resampled result = resampled_within(mesh, 60);
    EXPECT_EQ(result.added, 0u);
    EXPECT_EQ(result.mesh.triangles.data(), mesh.triangles.data());
}

TEST(Resample, Region_IsFlippedWhereItCounts) {
    // The rhombus has no long edge, and no split is near.
    const Counts all = [](const auto&) { return true; };
    EXPECT_TRUE(edges_of(resampled_within(thin_rhombus(), 10, all).mesh).contains({0, 1}));
    // The edges of the upper triangle are split, and nothing is flipped into the lower one.
    const Counts above = [](const std::array<Vec3, 3>& t) { return (t[0] + t[1] + t[2]).y() > 0; };
    const TriangleMesh after = resampled_within(thin_rhombus(), 3, above).mesh;
    double below = 0;
    for (const Triangle& t : after.triangles) {
        const auto corners = corners_of(after, t);
        if (!above(corners)) below += (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
        const auto [lowest, highest] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
        EXPECT_TRUE(lowest >= 0 || highest <= 0);
    }
    EXPECT_NEAR(below, 4, 1e-12);
}

TEST(Resample, DeclaredEdgesOfAFlatFace_StayWithAllTheirParts) {
    const TriangleMesh mesh = with_sharp_edges(fan(10, 20), {{0, 11}, {0, 25}, {0, 31}});
    const TriangleMesh after = resampled_within(mesh, 1).mesh;
    const std::set<Edge> edges = edges_of(after);
    double length = 0, expected = 0;
    for (const Edge& edge : after.sharp_edges) {
        EXPECT_TRUE(edges.contains(edge));
        EXPECT_LE(length_of(after, edge), 1);
        length += length_of(after, edge);
    }
    for (const Edge& edge : mesh.sharp_edges) expected += length_of(mesh, edge);
    EXPECT_NEAR(length, expected, 1e-12 * expected);
}

TEST(Resample, StripsBetweenCreases_GetVerticesOnTheCreasesOnly) {
    // A prism with 40 sides, 16 high: strips 0.157 wide.
    constexpr u32 sides = 40;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 i = 0; i < sides; ++i)
        for (const double z : {0.0, 16.0})
            positions.emplace_back(std::cos(2 * std::numbers::pi * i / sides),
                                   std::sin(2 * std::numbers::pi * i / sides), z);
    for (u32 i = 0; i < sides; ++i) {
        const u32 next = (i + 1) % sides;
        triangles.push_back({2 * i, 2 * next, 2 * next + 1});
        triangles.push_back({2 * i, 2 * next + 1, 2 * i + 1});
    }
    const TriangleMesh mesh = soup(positions, triangles);
    const Resampled result = resampled_within(mesh, 1.1);
    // 16 in halves until they are at most 1.1.
    EXPECT_EQ(result.added, sides * 15);
    for (const Vec3& p : result.mesh.positions) EXPECT_NEAR(std::hypot(p.x(), p.y()), 1, 1e-12);
    EXPECT_NEAR(area(result.mesh), area(mesh), 1e-12 * area(mesh));
}

TEST(Resample, OpenMesh_KeepsItsBoundary) {
    const TriangleMesh mesh = rectangle(6, 4);
    const Resampled result = resampled_within(mesh, 1);
    expect_laws(mesh, result, 1);
    EXPECT_EQ(topology(result.mesh).boundary_loops, 1u);
}

TEST(Resample, DenseMesh_IsReturnedUnchanged_SharingItsMemory) {
    const TriangleMesh mesh = geodesic_sphere(1, 4);
    for (const Counts& counts : {Counts{}, Counts([](const auto&) { return false; })}) {
        const Resampled result = resampled_within(mesh, counts ? 0.01 : 1, counts);
        EXPECT_EQ(result.added, 0u);
        EXPECT_EQ(result.mesh.positions.data(), mesh.positions.data());
        EXPECT_EQ(result.mesh.triangles.data(), mesh.triangles.data());
    }
}

TEST(Resample, Region_LeavesTrianglesOutsideAsTheyAre) {
    const TriangleMesh mesh = box();
    const Counts near_corner = [](const std::array<Vec3, 3>& t) {
        BoundingBox box;
        for (const Vec3& corner : t) box.add(corner);
        return (box.low.array() < Vec3(5, 5, 5).array()).all();
    };
    const Resampled result = resampled_within(mesh, 1, near_corner);
    for (const Triangle& t : result.mesh.triangles) {
        if (!near_corner(corners_of(result.mesh, t))) continue;
        for (u32 i = 0; i < 3; ++i) EXPECT_LE(length_of(result.mesh, make_edge(t[i], t[(i + 1) % 3])), 1);
    }
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_NEAR(test::signed_volume(result.mesh), 48000, 48000e-12);
    // Of an area of 8800, only 75 near the corner is dense: far fewer points than everywhere.
    EXPECT_LT(result.added, resampled_within(mesh, 1).added / 20);
    EXPECT_GT(result.added, 75u / 2);
}

TEST(Resample, Region_HalvesAreJudgedAnew) {
    // Only triangles of this size count: the halves do not, although they have long edges.
    const Counts large = [](const std::array<Vec3, 3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]).norm() > 3; };
    EXPECT_EQ(resampled_within(kite(), 0.1, large).added, 1u);
    // The reverse: nothing is small enough at the beginning.
    const Counts small = [](const std::array<Vec3, 3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]).norm() < 3; };
    EXPECT_EQ(resampled_within(kite(), 0.1, small).added, 0u);
}

TEST(Resample, SharpEdges_AreDividedWithTheirEdges) {
    const TriangleMesh mesh = with_sharp_edges(
        box(), {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}});
    const TriangleMesh after = resampled_within(mesh, 4).mesh;
    EXPECT_EQ(after.sharp_edges.size(), 4u * (16 + 16 + 8)) << "60, 40 and 20 in halves until they are at most 4";
    EXPECT_TRUE(std::ranges::is_sorted(after.sharp_edges));
    const std::set<Edge> edges = edges_of(after), sharp(after.sharp_edges.begin(), after.sharp_edges.end());
    EXPECT_EQ(sharp.size(), after.sharp_edges.size());
    double length = 0;
    for (const Edge& edge : sharp) {
        EXPECT_TRUE(edges.contains(edge));
        length += length_of(after, edge);
        const Vec3 middle = (after.positions[edge[0]] + after.positions[edge[1]]) / 2;
        const int extremes = (middle.x() == 0 || middle.x() == 60) + (middle.y() == 0 || middle.y() == 40) +
                             (middle.z() == 0 || middle.z() == 20);
        EXPECT_EQ(extremes, 2);
    }
    EXPECT_NEAR(length, 4 * (60 + 40 + 20), 1e-9);
}

TEST(Resample, SharpEdge_OnTheBoundary_AndOneThatIsNotSplit) {
    const TriangleMesh after = resampled_within(with_sharp_edges(rectangle(4, 1), {{0, 1}, {1, 2}}), 2.3).mesh;
    // The sides of length 1 are shorter than half of the limit: 0 to 1 is split at 4 and 2 to 3 at 5, before the
// diagonal.
    ASSERT_EQ(after.positions.size(), 6u);
    EXPECT_EQ(after.positions[4], Vec3(2, 0, 0));
    EXPECT_EQ(after.positions[5], Vec3(2, 1, 0));
    EXPECT_THAT(after.sharp_edges.span(), ElementsAre(Edge{0, 4}, Edge{1, 2}, Edge{1, 4}));
}

TEST(Resample, VertexColumns_AreInterpolated_OrThoseOfTheLowerRow) {
    TriangleMesh mesh = kite();
    mesh.vertex_columns.add(Column("height", 1, Buffer<double>{1, 2, 7, 7}).with_length_exponent(1));
    mesh.vertex_columns.add(Column("pair", 2, Buffer<float>{1, 10, 3, 20, 0, 0, 0, 0}));
    mesh.vertex_columns.add(Column("normal", 3, Buffer<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1}));
    mesh.vertex_columns.add(Column("colour", 3, Buffer<u8>{10, 20, 30, 50, 60, 70, 0, 0, 0, 0, 0, 0}));
    mesh.vertex_columns.add(Column("list", Buffer<u64>{0, 2, 2, 2, 2}, Buffer<double>{5, 6}));
    const ColumnTable columns = resampled_within(mesh, 2.5).mesh.vertex_columns;
    ASSERT_EQ(columns.size(), 5u);
    EXPECT_THAT(columns.find("height")->values<double>(), ElementsAre(1, 2, 7, 7, 1.5));
    EXPECT_EQ(columns.find("height")->length_exponent(), 1);
    EXPECT_THAT(columns.find("pair")->values<float>().subspan(8), ElementsAre(2, 15));
    const float half = static_cast<float>(std::numbers::sqrt2 / 2);
    EXPECT_THAT(columns.find("normal")->values<float>().subspan(12), ElementsAre(half, half, 0));
    EXPECT_THAT(columns.find("colour")->values<u8>().subspan(12), ElementsAre(10, 20, 30));
    EXPECT_THAT(columns.find("list")->offsets().span(), ElementsAre(0, 2, 2, 2, 2, 4));
    EXPECT_THAT(columns.find("list")->values<double>(), ElementsAre(5, 6, 5, 6));
}

TEST(Resample, OppositeNormals_GiveTheOneOfTheLowerRow) {
    TriangleMesh mesh = kite();
    mesh.vertex_columns.add(Column("normal", 3, Buffer<double>{0, 1, 0, 0, -1, 0, 1, 0, 0, 1, 0, 0}));
    const ColumnTable columns = resampled_within(mesh, 2.5).mesh.vertex_columns;
    EXPECT_THAT(columns.find("normal")->values<double>().subspan(12), ElementsAre(0, 1, 0));
}

TEST(Resample, VertexColumns_FollowSeveralSplitsOfOneEdge) {
    TriangleMesh mesh = box();
    Array<double> x;
    Array<u32> rows;
    for (u32 i = 0; i < 8; ++i) {
        x.push_back(mesh.positions[i].x());
        rows.push_back(i);
    }
    mesh.vertex_columns.add(Column("x", 1, Buffer<double>(x)));
    mesh.vertex_columns.add(Column("row", 1, Buffer<u32>(rows)));
    const TriangleMesh after = resampled_within(mesh, 4).mesh;
    for (u32 i = 0; i < after.positions.size(); ++i) {
        EXPECT_EQ(after.vertex_columns.find("x")->number(i), after.positions[i].x()) << "linear, and halves are exact";
        EXPECT_LT(after.vertex_columns.find("row")->number(i), 8);
    }
}

TEST(Resample, FaceColumns_AreThoseOfTheWholeTriangle) {
    TriangleMesh mesh = box();
    Array<u32> faces;
    for (u32 i = 0; i < 12; ++i) faces.push_back(i / 2);
    mesh.face_columns.add(Column("face", 1, Buffer<u32>(faces)));
    const TriangleMesh after = resampled_within(mesh, 4).mesh;
    std::map<double, double> areas;
    for (u32 row = 0; row < after.triangles.size(); ++row) {
        const auto [a, b, c] = corners_of(after, after.triangles[row]);
        areas[after.face_columns.find("face")->number(row)] += (b - a).cross(c - a).norm() / 2;
    }
    const std::map<double, double> expected{{0, 2400}, {1, 2400}, {2, 1200}, {3, 1200}, {4, 800}, {5, 800}};
    ASSERT_EQ(areas.size(), expected.size());
    for (const auto& [face, size] : expected) EXPECT_NEAR(areas[face], size, 1e-9);
}

TEST(Resample, EdgeColumns_AreGivenToBothHalves) {
    TriangleMesh mesh = kite();
    mesh.edges = {{1, 2}, {0, 1}, {0, 3}};
    mesh.edge_columns.add(Column("width", 1, Buffer<double>{5, 6, 7}));
    const TriangleMesh after = resampled_within(mesh, 2.5).mesh;
    EXPECT_THAT(after.edges.span(), ElementsAre(Edge{1, 2}, Edge{0, 4}, Edge{1, 4}, Edge{0, 3}));
    EXPECT_THAT(after.edge_columns.find("width")->values<double>(), ElementsAre(5, 6, 6, 7));
}

TEST(Resample, KeepsTheFrame) {
    TriangleMesh mesh = kite();
    mesh.frame.unit = LengthUnit::millimetre;
    mesh.frame.origin = {1e6, 2, 3};
    EXPECT_EQ(resampled_within(mesh, 2.5).mesh.frame, mesh.frame);
}

TEST(Resample, DegenerateTriangles_StayAsTheyAre) {
    TriangleMesh mesh = both(kite(), soup({{0, 0, 9}, {9, 0, 9}, {0, 9, 9}}, {{0, 1, 2}, {0, 2, 1}, {0, 0, 1}}));
    const TriangleMesh after = resampled_within(mesh, 2.5).mesh;
    EXPECT_EQ(after.triangles.size(), mesh.triangles.size() + 2);
    for (u32 row = 2; row < 5; ++row) EXPECT_EQ(after.triangles[row], mesh.triangles[row]);
    EXPECT_NO_THROW(half_edges::opposites(after));
}

TEST(Resample, MovedMesh_IsSplitAlike) {
    const TriangleMesh mesh = potato(2);
    const std::size_t added = resampled_within(mesh, 0.3).added;
    EXPECT_EQ(resampled_within(shifted(mesh, {-1, 2, 3}), 0.3).added, added);
    EXPECT_EQ(resampled_within(scaled(mesh, 3), 0.9).added, added);
    EXPECT_EQ(resampled_within(turned(mesh, 0.7, {1, 2, 3}), 0.3).added, added);
}

TEST(ResampleRefuses, MorePointsThanPossible_BeforeItBegins) {
    const Error error = error_of([] { resampled_within(box(), 0.01); });
    // 8800 over the area of an equilateral triangle is a number of triangles; half of it is added at least.
    const double least = (8800 / (std::numbers::sqrt3 / 4 * 0.01 * 0.01) - 12) / 2;
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr(fmt::format("at least {:.0f} points", std::floor(least))),
                                        HasSubstr("0.01 u"), HasSubstr("50000000")));
    EXPECT_THAT(error.hint(), AllOf(HasSubstr("density"), HasSubstr("local")));
    // A triangle without area: two sides of 10^9 units in steps of one.
    const TriangleMesh needle = soup({{0, 0, 0}, {1e9, 0, 0}, {1e9, 0, 0}}, {{0, 1, 2}});
    EXPECT_THAT(sentence_of([&] { resampled_within(needle, 1); }), HasSubstr("at least 1999999998 points"));
}

TEST(Resample, LongEdgesThatFlipsRemove_DoNotCountAsPoints) {
    // 200 edges in a square with the diagonal 14: one by one, they would need more than 2,000 points.
    EXPECT_LT(resampled_within(fan(10, 100), 1, {}, 460).added, 460u);
}

TEST(ResampleRefuses, MorePointsThanPossible_WhenTheLimitIsReached) {
    EXPECT_EQ(resampled_within(box(), 4, {}, 1786).added, 1786u);
    EXPECT_THAT(sentence_of([] { resampled_within(box(), 4, {}, 1785); }),
                AllOf(HasSubstr("more than 1785 points"), HasSubstr("4 u")));
    const Error error = error_of([] {
        resampled_within(
            box(), 4, [](const auto&) { return true; }, 100);
    });
    EXPECT_THAT(error.sentence(), HasSubstr("more than 100 points"));
    EXPECT_THAT(error.hint(), AllOf(HasSubstr("density"), testing::Not(HasSubstr("local"))));
}

TEST(ResampleRefuses, ALimitThatIsNotPositive) {
    for (const double longest : {0.0, -1.0, nan}) {
        const Error error = error_of([&] { resampled_within(kite(), longest); });
        EXPECT_THAT(error.sentence(), HasSubstr("must be above 0"));
        EXPECT_FALSE(error.hint().empty());
    }
}

TEST(ResampleRefuses, AnEdgeInThreeTriangles) {
    const Error error = error_of([] {
        resampled_within(
            soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}), 0.5);
    });
    EXPECT_THAT(error.sentence(), HasSubstr("in 3 triangles"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(Resample, Cancelled_StopsAtEveryCheck) {
    int checks = 0, last = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++checks, false; };
    double progress = resampling_begin;
    options.on_progress = [&](double fraction) {
        EXPECT_GE(fraction, progress);
        progress = fraction;
    };
    {
        Context context(options);
        EXPECT_GT(resampled(box(), 0.5, {}, context).added, 100'000u);
        EXPECT_GT(progress, resampling_begin);
        EXPECT_LE(progress, resampling_end);
    }
    const int all = checks;
    EXPECT_GT(all, 5);
    options.is_cancelled = [&] { return ++checks >= last; };
    for (last = 1; last <= all; ++last) {
        checks = 0;
        progress = 0;
        Context context(options);
        EXPECT_THROW(resampled(box(), 0.5, {}, context), Cancelled);
        EXPECT_EQ(checks, last);
    }
}

}  // namespace
}  // namespace scanmill::updating
