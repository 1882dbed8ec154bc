// SPDX-License-Identifier: GPL-3.0-or-later
// What holds of every mesh, and in a plane: CGAL's Delaunay triangulation.

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <gmock/gmock.h>

#include "filters/edge_flip/cases.hpp"

namespace scanmill {
namespace {

using namespace test;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<u32, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<Vertex, CGAL::Constrained_triangulation_face_base_2<Kernel>>>;

template <class Triangulation>
std::set<Edge> edges_by_cgal(const TriangleMesh& mesh) {
    Triangulation triangulation;
    std::vector<typename Triangulation::Vertex_handle> handles;
    for (const Vec3& p : mesh.positions) {
        handles.push_back(triangulation.insert({p.x(), p.y()}));
        handles.back()->info() = static_cast<u32>(handles.size() - 1);
    }
    if constexpr (std::same_as<Triangulation, Constrained>)
        for (const auto& [a, b] : mesh.sharp_edges) triangulation.insert_constraint(handles[a], handles[b]);
    std::set<Edge> edges;
    for (const auto& [face, i] : triangulation.finite_edges())
        edges.insert(
            make_edge(face->vertex(Triangulation::ccw(i))->info(), face->vertex(Triangulation::cw(i))->info()));
    return edges;
}

TEST(EdgeFlipInAPlane, OfAnyTriangulation_IsTheDelaunayTriangulation) {
    for (const std::size_t count : {4u, 5u, 10u, 50u, 200u, 1000u})
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            const TriangleMesh mesh = swept(random_plane(count, seed));
            ASSERT_EQ(topology(mesh).euler, 1);
            const EdgeFlipResult result = flipped(mesh);
            ASSERT_EQ(edges_of(result.mesh), edges_by_cgal<Delaunay>(mesh)) << count << " points, seed " << seed;
            EXPECT_EQ(result.left.total(), 0u);
        }
}

TEST(EdgeFlipInAPlane, WithSharpEdges_IsTheConstrainedDelaunayTriangulation) {
    for (const std::size_t count : {10u, 50u, 200u, 1000u})
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            TriangleMesh mesh = swept(random_plane(count, seed));
            Random random(seed);
            Array<Edge> sharp;
            for (const Edge& edge : edges_of(mesh))
                if (random.uniform() < 0.1) sharp.push_back(edge);
            mesh.sharp_edges = std::move(sharp);
            const EdgeFlipResult result = flipped(mesh);
            const std::set<Edge> edges = edges_of(result.mesh);
            ASSERT_EQ(edges, edges_by_cgal<Constrained>(mesh)) << count << " points, seed " << seed;
            for (const Edge& edge : mesh.sharp_edges) EXPECT_EQ(edges.count(edge), 1u);
        }
}

TEST(EdgeFlipInAPlane, DelaunayHasTheLargestAngles_AndShorterTheShortestEdges) {
    const TriangleMesh mesh = swept(random_plane(500, 3));
    EXPECT_GT(sorted_angles(flipped(mesh).mesh), sorted_angles(flipped(mesh, Criterion::shorter).mesh));
    EXPECT_LT(total_length(flipped(mesh, Criterion::shorter).mesh), total_length(flipped(mesh).mesh));
}

struct Case {
    const char* name;
    TriangleMesh mesh;
};
std::vector<Case> cases() {
    TriangleMesh sharp = noisy_grid(12, 9, 0.3, 7);
    Array<Edge> edges;
    for (const Edge& edge : edges_of(sharp))
        if (edge[0] % 13 == 6) edges.push_back(edge);
    sharp.sharp_edges = std::move(edges);
    return {{"sphere", shaken(geodesic_sphere(1, 6), 0.06, 1)},
            {"rough sphere", shaken(geodesic_sphere(1, 8), 0.12, 2)},
            {"torus", shaken(torus(2, 1, 24, 7), 0.15, 3)},
            {"open torus", without_triangles(shaken(torus(2, 1, 20, 12), 0.12, 4), {3, 4, 5, 90, 91})},
            {"grid", noisy_grid(15, 12, 0.25, 5)},
            {"rough grid", noisy_grid(15, 12, 0.45, 6)},
            {"grid with sharp edges", sharp},
            {"plane", swept(random_plane(150, 8))}};
}
std::vector<EdgeFlipParams> parameters() {
    std::vector<EdgeFlipParams> all;
    for (const Criterion criterion : all_criteria) {
        EdgeFlipParams params;
        params.criterion = criterion;
        params.noise = Length(0);  // the rules with the triangles' own normals, however rough the mesh is
        all.push_back(params);
        params.keep_angle = Angle::degrees(5);
        params.deviation = Ratio::percent(30);
        params.max_edge = Length(0.5);
        all.push_back(params);
    }
    return all;
}

TEST(EdgeFlipOfAnyMesh, EveryFlipIsAllowed_NoneIsLeftOut_AndBlockedEdgesAreCounted) {
    std::size_t flips = 0;
    BlockedEdges blocked;
    for (const auto& [name, mesh] : cases())
        for (const EdgeFlipParams& params : parameters()) {
            SCOPED_TRACE(testing::Message() << name << ", criterion " << static_cast<int>(params.criterion));
            const EdgeFlipResult result = flipped(mesh, params);
            TriangleMesh now = mesh;
            for (const auto& [a, b, c, d] : result.flips) {
                Rules rules(now, params);
                const u32 h = half_edge_between(rules.half_edges, a, b);
                ASSERT_NE(h, EditableMesh::none);
                ASSERT_EQ(rules.half_edges.apex(h), c);
                ASSERT_EQ(rules.half_edges.apex(rules.half_edges.opposite(h)), d);
                ASSERT_EQ(rules.forbids(h), Rule::none);
                rules.half_edges.flip(h);
                now.triangles = rules.half_edges.compact_triangles();
            }
            const auto without_rotation = [](const TriangleMesh& of) {
                std::set<Triangle> triangles;
                for (Triangle t : of.triangles) {
                    std::ranges::rotate(t, std::ranges::min_element(t));
                    triangles.insert(t);
                }
                return triangles;
            };
            EXPECT_EQ(without_rotation(now), without_rotation(result.mesh));
            const Census left = census(result.mesh, params);
            EXPECT_EQ(left.flippable, 0u);
            EXPECT_EQ(left.blocked, result.left);
            expect_laws(mesh, result, params);
            flips += result.flips.size();
            blocked.sharp += result.left.sharp;
            blocked.connected += result.left.connected;
            blocked.folding += result.left.folding;
            blocked.deviating += result.left.deviating;
            blocked.too_long += result.left.too_long;
        }
    // All rules took part.
    EXPECT_GT(flips, 2000u);
    EXPECT_GT(blocked.sharp, 5u);
    EXPECT_GT(blocked.connected, 0u);
    EXPECT_GT(blocked.folding, 20u);
    EXPECT_GT(blocked.deviating, 20u);
    EXPECT_GT(blocked.too_long, 20u);
}

TEST(EdgeFlipOfAnyMesh, SortedAnglesGrowWithEveryFlip_AndWithShorterTheLengthFalls) {
    for (const auto& [name, mesh] : cases())
        for (const Criterion criterion : {Criterion::delaunay, Criterion::shorter}) {
            const EdgeFlipResult result = flipped(mesh, criterion);
            ASSERT_FALSE(result.flips.empty()) << name;
            EditableMesh replay(mesh);
            TriangleMesh now = mesh;
            std::vector<double> angles = sorted_angles(now);
            double length = total_length(now);
            EXPECT_NEAR(result.min_angle_before, angles.front(), 1e-14) << name;
            for (const auto& [a, b, c, d] : result.flips) {
                replay.flip(half_edge_between(replay, a, b));
                now.triangles = replay.compact_triangles();
                if (criterion == Criterion::delaunay) {
                    std::vector<double> then = sorted_angles(now);
                    const auto [was, is] =
                        std::ranges::mismatch(angles, then, [](double x, double y) { return std::abs(x - y) < 1e-12; });
                    ASSERT_NE(was, angles.end()) << name;
                    ASSERT_GT(*is, *was) << name;
                    angles = std::move(then);
                } else {
                    const double then = total_length(now);
                    ASSERT_LT(then, length) << name;
                    length = then;
                }
            }
            EXPECT_NEAR(result.min_angle_after, sorted_angles(now).front(), 1e-14) << name;
        }
}

TEST(EdgeFlipOfAClosedMesh, ChangesTheVolumeByTheTetrahedraOfItsFlips) {
    for (const TriangleMesh& mesh : {shaken(geodesic_sphere(1, 6), 0.06, 1), shaken(torus(2, 1, 24, 7), 0.15, 3)})
        for (const Criterion criterion : all_criteria) {
            const EdgeFlipResult result = flipped(mesh, criterion);
            double volume = signed_volume(mesh);
            for (const auto& [a, b, c, d] : result.flips) {
                const Vec3& origin = mesh.positions[a];
                volume +=
                    (mesh.positions[b] - origin).dot((mesh.positions[c] - origin).cross(mesh.positions[d] - origin)) /
                    6;
            }
            EXPECT_NEAR(signed_volume(result.mesh), volume, 1e-12);
        }
}

TEST(EdgeFlipOfASphere, UndoesRandomFlips) {
    const TriangleMesh sphere = geodesic_sphere(1, 10);  // 1002 vertices
    ASSERT_EQ(flipped(sphere).flips.size(), 0u);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        // A fifth of the edges, where the flip is allowed but for the criterion.
        EditableMesh mesh(sphere);
        TriangleMesh now = sphere;
        Random random(seed);
        for (std::size_t flips = 0; flips < 600;) {
            const u32 h = static_cast<u32>(random.index(3 * mesh.rows()));
            const Rule rule = Rules(now, {}).forbids(h);
            const Vec3 &a = now.positions[mesh.start(h)], &b = now.positions[mesh.end(h)],
                       &c = now.positions[mesh.apex(h)], &d = now.positions[mesh.apex(mesh.opposite(h))];
            const double shorter = std::min((a - b).norm(), (c - d).norm());
            if (rule == Rule::not_convex || !mesh.can_flip(h) || segment_distance(a, b, c, d) > 0.1 * shorter) continue;
            mesh.flip(h);
            now.triangles = mesh.compact_triangles();
            ++flips;
        }
        ASSERT_LT(sorted_angles(now).front(), 15 * degree);
        const EdgeFlipResult result = flipped(now);
        EXPECT_GE(result.min_angle_after, sorted_angles(sphere).front() - 0.5 * degree) << "seed " << seed;
        EXPECT_EQ(topology(result.mesh).euler, 2);
        expect_laws(now, result, {});
    }
}

TEST(EdgeFlip, IsTheSame_TurnedMovedAndScaled) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(3, -1, 2).normalized()).toRotationMatrix();
    for (const auto& [name, mesh] : cases()) {
        const EdgeFlipResult result = flipped(mesh);
        for (const double scale : {1.0 / 3000, 7.0}) {
            TriangleMesh moved = mesh;
            Array<Vec3> positions;
            for (const Vec3& position : mesh.positions)
                positions.push_back(scale * (turn * position + Vec3(9, 20, -4)));
            moved.positions = std::move(positions);
            EXPECT_TRUE(std::ranges::equal(flipped(moved).flips, result.flips)) << name << ", " << scale;
        }
    }
}

}  // namespace
}  // namespace scanmill
