// SPDX-License-Identifier: GPL-3.0-or-later
// The boundary of a set of cells: its defects and their repair, its components and cavities.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "alpha_solid/components.hpp"
#include "alpha_solid/widest_path_sweep.hpp"
#include "filters/alpha_solid/cases.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/tets/incremental_solid.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"
#include "scanmill/geometry/tets/vertex_stars.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::alpha {
namespace {

using namespace test;

SweepResult sweep_of_all(const TetMesh& tets) {
    Context context;
    return sweep_from_outside(sweep_cells(tets, context), tets.positions.size(), {.value = 0, .coverage = 1}, context);
}

TriangleMesh mesh_of(const TetMesh& tets, std::span<const u8> labels) {
    TriangleMesh mesh;
    mesh.positions = tets.positions;
    mesh.triangles = boundary_triangles(tets, labels, 1);
    return mesh;
}

TEST(BoundaryDefects, OfRandomCellSets_AgreeWithTheMeshTopology) {
    Random random(5);
    for (double density : {0.03, 0.2, 0.5, 0.8, 0.97}) {
        const TetMesh tets = tets_of(random_cube(400, 3));
        Array<u8> labels(tets.cells.size());
        for (u8& label : labels) label = random.uniform() < density ? solid : outside;
        const TriangleMesh mesh = mesh_of(tets, labels);
        const MeshTopology properties = topology(mesh);
        const BoundaryDefects defects = boundary_defects(mesh.triangles.span(), tets.positions.size(), 2);
        EXPECT_EQ(properties.boundary_edges, 0u);
        EXPECT_EQ(defects.edges, properties.nonmanifold_edges);
        EXPECT_EQ(defects.vertices.size(), properties.nonmanifold_vertices);
        EXPECT_GT(defects.edges, 0u);
        // The same verdict from the cells round each vertex.
        IncrementalSolid incremental(tets, labels, {});
        EXPECT_EQ(incremental.verdict(), IncrementalSolid::Verdict::manifold);
        for (u32 vertex = 0; vertex < tets.positions.size(); ++vertex) {
            incremental.suspect_only(std::array{vertex});
            const bool bad = std::ranges::binary_search(defects.vertices, vertex);
            EXPECT_EQ(incremental.verdict(),
                      bad ? IncrementalSolid::Verdict::not_manifold : IncrementalSolid::Verdict::manifold);
        }
    }
}

TEST(VertexStars, PartsOfRandomCellSets_AreFaceConnected_AndNamedByTheirLowestCell) {
    Random random(6);
    const TetMesh tets = tets_of(random_cube(200, 3));
    Array<u8> labels(tets.cells.size());
    for (u8& label : labels) label = random.uniform() < 0.5;
    VertexStars stars(tets);
    for (u32 vertex = 0; vertex < tets.positions.size(); ++vertex) {
        DisjointSets sets(tets.cells.size() + 1);  // the last: the outside of the hull
        const u32 beyond = static_cast<u32>(tets.cells.size());
        std::array<std::set<u32>, 2> parts;
        std::vector<u32> cells;
        for (u32 cell = 0; cell < beyond; ++cell) {
            const auto corner = std::ranges::find(tets.cells[cell], vertex) - tets.cells[cell].begin();
            if (corner < 4) cells.push_back(cell);
            for (int i = 0; corner < 4 && i < 4; ++i) {
                const u32 across = tets.neighbours[cell][i];
                if (i == corner) continue;
                if (across == VertexStars::none) parts[0].insert(beyond);
                if (across == VertexStars::none ? labels[cell] == 0 : labels[across] == labels[cell])
                    sets.unite(cell, std::min(across, beyond));
            }
        }
        const auto part = [&](u32 cell) { return sets.find(cell) == sets.find(beyond) ? beyond : sets.find(cell); };
        for (const u32 cell : cells) parts[labels[cell]].insert(part(cell));
        std::size_t surplus = 0;
        for (const std::set<u32>& of : parts) surplus += of.empty() ? 0 : of.size() - 1;
        EXPECT_EQ(stars.surplus_parts(vertex, labels), surplus) << vertex;
        ASSERT_EQ(stars.cells().size(), cells.size());
        for (u32 i = 0; i < cells.size(); ++i)
            EXPECT_EQ(std::min(stars.part(i), beyond), part(stars.cells()[i])) << vertex;
    }
}

/// Two tetrahedra that share only `shared` of their vertices.
TriangleMesh two_tetrahedra(int shared) {
    std::array<Triangle, 4> facets{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    Array<Triangle> triangles;
    for (const Triangle& t : facets) triangles.push_back(t);
    for (const Triangle& t : facets) {
        Triangle other;
        for (int i = 0; i < 3; ++i) other[i] = t[i] < static_cast<u32>(shared) ? t[i] : t[i] + 4;
        triangles.push_back(other);
    }
    TriangleMesh mesh;
    mesh.triangles = std::move(triangles);
    return mesh;
}

TEST(BoundaryDefects, TetrahedraThatTouchInAVertex_AreEdgeManifoldButNotManifold) {
    const BoundaryDefects defects = boundary_defects(two_tetrahedra(1).triangles.span(), 8, 1);
    EXPECT_EQ(defects.vertices, (Array<u32>{0}));
    EXPECT_EQ(defects.edges, 0u);
}

TEST(BoundaryDefects, TetrahedraThatTouchInAnEdge_HaveOneSurplusEdge) {
    const BoundaryDefects defects = boundary_defects(two_tetrahedra(2).triangles.span(), 8, 1);
    EXPECT_EQ(defects.vertices, (Array<u32>{0, 1}));
    EXPECT_EQ(defects.edges, 1u);
}

TEST(BoundaryDefects, SeparateTetrahedra_HaveNone) {
    const TriangleMesh mesh = two_tetrahedra(0);
    EXPECT_TRUE(boundary_defects(mesh.triangles.span(), 8, 1).vertices.empty());
    DisjointSets vertices(8);
    EXPECT_EQ(join_vertices(mesh.triangles.span(), vertices), 2u);
}

TEST(BoundaryDefects, VertexOfManyTriangles_IsTestedLikeAnyOther) {
    // A double fan of 100 triangles between two poles, once whole and once pinched where two rim vertices are one.
    for (bool pinched : {false, true}) {
        Array<Triangle> triangles;
        const auto rim = [&](u32 i) { return 2 + (pinched && i % 100 == 50 ? 0 : i % 100); };
        for (u32 i = 0; i < 100; ++i) {
            triangles.push_back({0, rim(i), rim(i + 1)});
            triangles.push_back({1, rim(i + 1), rim(i)});
        }
        const BoundaryDefects defects = boundary_defects(triangles, 102, 1);
        EXPECT_EQ(defects.vertices, pinched ? (Array<u32>{0, 1, 2}) : Array<u32>{});
        EXPECT_EQ(defects.edges, pinched ? 2u : 0u);
    }
}

TEST(IncrementalSolid, CellByCell_HasTheVerdictOfTheWholeBoundary) {
    const TetMesh tets = tets_of(random_cube(120, 8));
    const SweepResult sweep = sweep_of_all(tets);
    Array<u8> labels(tets.cells.size());
    std::ranges::fill(labels, outside);
    IncrementalSolid incremental(tets, labels, {});
    int manifold = 0;
    for (std::size_t i = sweep.cells.size(); i-- > 0;) {
        incremental.add(std::span(sweep.cells).subspan(i, 1));
        const TriangleMesh mesh = mesh_of(tets, incremental.labels());
        const bool expected = topology(mesh).nonmanifold_vertices == 0;
        ASSERT_EQ(incremental.verdict() == IncrementalSolid::Verdict::manifold, expected) << i;
        manifold += expected;
        EXPECT_EQ(incremental.covered(), covered_points(tets, incremental.labels()));
    }
    EXPECT_GT(manifold, 10);
}

TEST(IncrementalSolid, RepairOfRandomCellSets_IsManifoldAndOnlyAdds) {
    Random random(6);
    for (double density : {0.05, 0.3, 0.6, 0.9}) {
        const TetMesh tets = tets_of(random_cube(300, 4));
        Array<u8> labels(tets.cells.size());
        Array<double> price(tets.cells.size());
        for (u8& label : labels) label = random.uniform() < density ? solid : outside;
        for (double& entry : price) entry = random.uniform();
        const BoundaryDefects defects = boundary_defects(boundary_triangles(tets, labels, 1), 300, 1);
        ASSERT_FALSE(defects.vertices.empty());
        IncrementalSolid incremental(tets, labels, defects.vertices);
        incremental.repair(price, Execution());
        EXPECT_EQ(topology(mesh_of(tets, incremental.labels())).nonmanifold_vertices, 0u);
        for (std::size_t c = 0; c < labels.size(); ++c) EXPECT_LE(labels[c] == solid, incremental.labels()[c] == solid);
        // Filling the cavities that the repair has sealed keeps the boundary a manifold and the outside connected.
        Array<u8> filled = incremental.labels();
        fill_cavities(tets, filled);
        const TriangleMesh mesh = mesh_of(tets, filled);
        const MeshTopology properties = topology(mesh);
        EXPECT_TRUE(properties.closed);
        fill_cavities(tets, filled);
        EXPECT_EQ(mesh_of(tets, filled).triangles.size(), mesh.triangles.size());
    }
}

/// Solid: the cells within one of two clouds, which `is_first(vertex)` distinguishes.
template <class IsFirst>
Array<u8> solid_in_each(const TetMesh& tets, const IsFirst& is_first) {
    Array<u8> labels(tets.cells.size());
    for (u32 c = 0; c < labels.size(); ++c)
        labels[c] = std::ranges::all_of(tets.cells[c], is_first) || std::ranges::none_of(tets.cells[c], is_first)
                        ? solid
                        : outside;
    return labels;
}

TEST(Components, LargestComponent_IsTheOneWithTheMostPoints) {
    const TetMesh tets = tets_of(joined(fibonacci_sphere(100), moved(lattice_cube(3), 0.2, Vec3(9, 0, 0))));
    Array<u8> labels = solid_in_each(tets, [](u32 vertex) { return vertex < 100; });  // against 64
    EXPECT_EQ(covered_points(tets, labels), 164u);
    keep_largest_component(tets, labels);
    EXPECT_EQ(covered_points(tets, labels), 100u);
    for (u32 c = 0; c < labels.size(); ++c)
        EXPECT_LE(labels[c] == solid, *std::ranges::max_element(tets.cells[c]) < 100);
    EXPECT_GT(std::ranges::count(labels, u8(left_out)), 0);
}

TEST(Components, OfEqualComponents_TheLowestIsKeptInAnyOrder) {
    const PointCloud low = random_cube(60, 5), high = moved(random_cube(60, 5), 1, Vec3(9, 0, 0));
    for (const bool low_first : {true, false}) {
        const TetMesh tets = tets_of(low_first ? joined(low, high) : joined(high, low));
        const auto is_low = [&](u32 vertex) { return tets.positions[vertex].x() < 5; };
        Array<u8> labels = solid_in_each(tets, is_low);
        ASSERT_EQ(covered_points(tets, labels), 120u);
        keep_largest_component(tets, labels);
        EXPECT_EQ(covered_points(tets, labels), 60u);
        for (u32 c = 0; c < labels.size(); ++c)
            EXPECT_EQ(labels[c] == solid, std::ranges::all_of(tets.cells[c], is_low));
    }
}

TEST(Components, CavityThatTouchesNoHullFacet_IsFilledAndABayIsNot) {
    const TetMesh tets = tets_of(random_cube(300, 21));
    const auto at_hull = [&](u32 c) {
        return std::ranges::find(tets.neighbours[c], TetMesh::outside_hull) != tets.neighbours[c].end();
    };
    // Opens one cell without hull facets, and another with one together with a neighbour behind it.
    u32 cavity = 0;
    while (at_hull(cavity)) ++cavity;
    const auto touches_cavity = [&](u32 c) {
        return c == cavity || std::ranges::find(tets.neighbours[c], cavity) != tets.neighbours[c].end();
    };
    u32 bay = 0, behind = 0;
    for (; bay < tets.cells.size(); ++bay) {
        if (!at_hull(bay) || touches_cavity(bay)) continue;
        const auto found = std::ranges::find_if(tets.neighbours[bay], [&](u32 across) {
            return across != TetMesh::outside_hull && !at_hull(across) && !touches_cavity(across);
        });
        if (found == tets.neighbours[bay].end()) continue;
        behind = *found;
        break;
    }
    ASSERT_LT(bay, tets.cells.size());
    Array<u8> labels(tets.cells.size());
    std::ranges::fill(labels, solid);
    labels[cavity] = labels[bay] = outside;
    labels[behind] = left_out;
    fill_cavities(tets, labels);
    EXPECT_EQ(labels[cavity], solid);
    EXPECT_EQ(labels[bay], outside);
    EXPECT_EQ(labels[behind], left_out);
    EXPECT_EQ(std::ranges::count(labels, u8(solid)), static_cast<long>(labels.size()) - 2);
}

}  // namespace
}  // namespace scanmill::alpha
