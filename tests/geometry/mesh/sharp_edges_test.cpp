// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/sharp_edges.hpp"

#include <gmock/gmock.h>

#include <numbers>
#include <set>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::set<Edge> sharp_edges_of(const TriangleMesh& mesh, double degrees, unsigned threads = 1) {
    const Array<u32> opposite = half_edges::opposites(mesh);
    const FacetNormals normals = facet_normals(mesh, opposite, 1);
    const std::vector<bool> sharp =
        sharp_half_edges(mesh, opposite, normals.unit, degrees * std::numbers::pi / 180, threads);
    EXPECT_EQ(sharp.size(), 3 * mesh.triangles.size());
    std::set<Edge> edges;
    for (u32 half_edge = 0; half_edge < sharp.size(); ++half_edge) {
        if (opposite[half_edge] != half_edges::boundary) {
            EXPECT_EQ(sharp[half_edge], sharp[opposite[half_edge]]);
        }
        if (sharp[half_edge])
            edges.insert(make_edge(half_edges::start(mesh, half_edge), half_edges::end(mesh, half_edge)));
    }
    return edges;
}

TEST(SharpEdges, OfACube_AreItsEdgesWithoutTheDiagonals) {
    const TriangleMesh mesh = cube();
    const std::set<Edge> edges = sharp_edges_of(mesh, 89);
    EXPECT_EQ(edges.size(), 12u);
    for (const auto& [a, b] : edges) EXPECT_EQ((mesh.positions[a] - mesh.positions[b]).norm(), 1);
    EXPECT_THAT(sharp_edges_of(mesh, 91), IsEmpty());
    EXPECT_EQ(sharp_edges_of(mesh, -1).size(), 18u) << "every edge";
}

TEST(SharpEdges, OfAnIcosahedron_AreAllOrNone) {
    const double between_normals = 180 - std::acos(-std::sqrt(5.0) / 3) * 180 / std::numbers::pi;
    EXPECT_EQ(sharp_edges_of(icosahedron(), between_normals - 1e-6).size(), 30u);
    EXPECT_THAT(sharp_edges_of(icosahedron(), between_normals + 1e-6), IsEmpty());
}

TEST(SharpEdges, Declared_AreSharpWhateverTheirAngle) {
    TriangleMesh mesh = icosahedron();
    const auto& [a, b, c] = mesh.triangles[7];
    mesh.sharp_edges = {make_edge(a, b)};
    EXPECT_THAT(sharp_edges_of(mesh, 180), ElementsAre(make_edge(a, b)));
}

TEST(SharpEdges, OnTheBoundary_AreNone) {
    const TriangleMesh closed = cube();
    const auto& [a, b, c] = closed.triangles[0];
    TriangleMesh mesh = without_triangles(closed, {0});
    // The three edges of the missing triangle: two edges of the cube and a diagonal.
    EXPECT_EQ(sharp_edges_of(mesh, 40).size(), 10u);
    mesh.sharp_edges = {make_edge(a, b)};
    EXPECT_EQ(sharp_edges_of(mesh, 40).size(), 10u) << "declared ones are neither";
}

TEST(SharpEdges, AnyNumberOfThreads_FindsTheSame) {
    const TriangleMesh mesh = geodesic_sphere(1, 40);
    for (const double degrees : {1.0, 1.5, 2.0})
        EXPECT_EQ(sharp_edges_of(mesh, degrees), sharp_edges_of(mesh, degrees, 3)) << degrees;
}

TEST(SharpEdges, DeclaredInNoTriangle_AreRefused) {
    TriangleMesh mesh = cube();
    mesh.sharp_edges = {{0, 7}};
    const Error error = error_of([&] { sharp_edges_of(mesh, 40); });
    EXPECT_THAT(error.sentence(), HasSubstr("1 of the mesh's 1 sharp edge is an edge of no triangle"));
    EXPECT_THAT(error.hint(), HasSubstr("write the mesh again"));
}

}  // namespace
}  // namespace scanmill
