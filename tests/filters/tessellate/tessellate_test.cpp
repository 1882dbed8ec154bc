// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/tessellate.hpp"

#include "filters/tessellate/cases.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

/// A sphere with normals turned by about 15 degrees: its surface crosses many edges.
TriangleMesh wavy_sphere() {
    const TriangleMesh mesh = geodesic_sphere(1, 4);
    Random random(4);
    std::vector<Vec3> normals;
    for (const Vec3& p : mesh.positions) {
        const Vec3 side = p.cross(Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        normals.push_back((p + 0.27 * side.normalized()).normalized());
    }
    return with_normals(mesh, normals);
}

/// |F| / |grad F| at the vertices, and the largest difference of their normals from the gradient.
std::pair<double, double> errors_of(const TriangleMesh& mesh, const PatchComplex& patches) {
    const PatchSurface surface(patches);
    const Column* normals = mesh.vertex_columns.find("normal");
    double off = 0, turned = 0;
    for (u32 v = 0; v < mesh.positions.size(); ++v) {
        const auto value = surface.value(mesh.positions[v]);
        const auto gradient = surface.gradient(mesh.positions[v]);
        EXPECT_TRUE(value && gradient);
        if (!value || !gradient) continue;
        off = std::max(off, std::abs(*value) / gradient->norm());
        const Vec3 n(normals->number(v, 0), normals->number(v, 1), normals->number(v, 2));
        turned = std::max(turned, (n - gradient->normalized()).norm());
    }
    return {off, turned};
}

/// Closed, with the topology of `mesh`, vertices on the surface, normals those of the gradient.
void expect_sound(const TriangleMesh& result, const TriangleMesh& mesh, const PatchComplex& patches) {
    expect_closed(result, mesh);
    const auto [off, turned] = errors_of(result, patches);
    EXPECT_LT(off, 1e-12);
    EXPECT_LT(turned, 1e-9);
}

TEST(Tessellate, AnySubdivision_IsClosedAndOnTheSurface) {
    for (const Split split : {Split::always, Split::where_needed})
        for (const TriangleMesh& mesh : {exact_sphere(1), exact_torus(12, 6), wavy_sphere()}) {
            const PatchComplex patches = patched(mesh, Curvature::distance, split).result.patches;
            for (const u32 subdivision : {1u, 2u, 3u, 4u, 5u, 8u})
                expect_sound(tessellated(patches, subdivision), mesh, patches);
        }
}

TEST(Tessellate, TrianglesByHand) {
    // Per triangle of an icosahedron and side 3 n² triangles, per edge a fan of 4 columns of n quadrilaterals whose
    // ends are triangles.
    const PatchComplex patches = patched(exact_sphere(1)).result.patches;
    for (const u32 n : {1u, 2u, 5u}) {
        const std::size_t strip = n == 1 ? 0 : 8 * (n - 1);
        EXPECT_EQ(tessellated(patches, n).triangles.size(), 20 * 3 * n * n + 30 * strip) << n;
    }
}

TEST(Tessellate, Patch_IsTheTriangleBelowAndSide_IsOutsideOfAConvexMesh) {
    const TriangleMesh mesh = exact_sphere(2);
    const TriangleMesh result = tessellated(patched(mesh).result.patches, 4);
    const Column *patch = result.face_columns.find("patch"), *side = result.face_columns.find("side");
    ASSERT_TRUE(patch && side);
    std::set<u32> found;
    for (u32 t = 0; t < result.triangles.size(); ++t) {
        const auto row = static_cast<u32>(patch->number(t));
        found.insert(row);
        EXPECT_EQ(side->number(t), 1);
        Vec3 centre = Vec3::Zero(), below = Vec3::Zero();
        for (std::size_t i = 0; i < 3; ++i) {
            centre += result.positions[result.triangles[t][i]] / 3;
            below += mesh.positions[mesh.triangles[row][i]] / 3;
        }
        EXPECT_GT(centre.normalized().dot(below.normalized()), 0.9);
    }
    EXPECT_EQ(found.size(), mesh.triangles.size());
}

/// The largest distance from random points of up to 300 triangles to the surface.
double worst_distance_to(const PatchComplex& patches, const TriangleMesh& mesh) {
    const PatchSurface surface(patches);
    Random random(1);
    double worst = 0;
    const std::size_t stride = mesh.triangles.size() / 300 + 1;
    for (std::size_t row = 0; row < mesh.triangles.size(); row += stride)
        for (int i = 0; i < 100; ++i) {
            const Triangle& t = mesh.triangles[row];
            double a = random.uniform(0, 1), b = random.uniform(0, 1);
            if (a + b > 1) a = 1 - a, b = 1 - b;
            const auto foot =
                surface.foot(a * mesh.positions[t[0]] + b * mesh.positions[t[1]] + (1 - a - b) * mesh.positions[t[2]]);
            EXPECT_TRUE(foot);
            if (foot) worst = std::max(worst, std::abs(foot->distance));
        }
    return worst;
}

TEST(Tessellate, MaxError_IsKeptWithNotTooManyTriangles) {
    for (const Split split : {Split::always, Split::where_needed})
        for (const bool is_torus : {false, true}) {
            const TriangleMesh mesh = is_torus ? exact_torus(12, 6) : exact_sphere(1);
            const PatchComplex patches = patched(mesh, Curvature::distance, split).result.patches;
            const double pi = std::numbers::pi, surface_area = is_torus ? 4 * pi * pi * 0.4 : 4 * pi;
            for (const double error : {1e-2, 2e-3}) {
                const TriangleMesh result = tessellated(patches, 256, Length(error));
                expect_sound(result, mesh, patches);
                EXPECT_LT(worst_distance_to(patches, result), 1.5 * error);
                // On a unit sphere equilateral triangles with circumscribed circles of radius sqrt(2 e) would do; a
                // power of two of segments needs up to four times as many, a triangle's base point twice.
                const double least = surface_area / (1.5 * std::sqrt(3.0) * error);
                EXPECT_LT(static_cast<double>(result.triangles.size()), (is_torus ? 30 : 15) * least) << error;
            }
        }
}

TEST(Tessellate, AQuarterOfTheError_DoublesTheSegments) {
    const PatchComplex patches = patched(exact_sphere(1), Curvature::mean).result.patches;
    const auto count = [&](double error) {
        return static_cast<double>(tessellated(patches, 1024, Length(error)).triangles.size());
    };
    const double ratio = count(1e-2 / 64) / count(1e-2);
    EXPECT_GT(ratio, 16);
    EXPECT_LT(ratio, 256);
}

TEST(Tessellate, AnyMixtureOfSegments_FitsTogether) {
    for (const Split split : {Split::always, Split::where_needed})
        for (const TriangleMesh& mesh : {wavy_sphere(), exact_torus(12, 6), regular_tetrahedron()}) {
            const APatchResult result = patched(mesh, Curvature::distance, split).result;
            for (std::uint64_t seed = 0; seed < 4; ++seed) {
                TessellateParams params;
                std::map<Edge, unsigned> segments;
                params.segments = [&](Edge edge) { return segments.at(edge); };
                Random random(seed);
                for (const Triangle& t : mesh.triangles)
                    for (std::size_t i = 0; i < 3; ++i)
                        segments.try_emplace(make_edge(t[i], t[(i + 1) % 3]), 1u << random.index(4));
                expect_sound(tessellated(result.patches, params), mesh, result.patches);
                params.max_error = Length(1e-3);
                expect_sound(tessellated(result.patches, params), mesh, result.patches);
            }
        }
}

TEST(Tessellate, WhereTheSurfaceCrossesAnEdge_ThereIsAVertex) {
    const TriangleMesh mesh = wavy_sphere();
    const PatchComplex patches = patched(mesh).result.patches;
    const PatchSurface surface(patches);
    std::size_t crossings = 0;
    for (const u32 subdivision : {1u, 2u, 3u, 7u}) {
        const TriangleMesh result = tessellated(patches, subdivision);
        for (const Triangle& t : mesh.triangles)
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3 &a = mesh.positions[t[i]], &b = mesh.positions[t[(i + 1) % 3]];
                const auto value = [&](double s) { return *surface.value((1 - s) * a + s * b); };
                double low = 1e-3, high = 1 - 1e-3;
                if ((value(low) < 0) == (value(high) < 0)) continue;
                const bool is_below = value(low) < 0;
                for (int step = 0; step < 60; ++step)
                    ((value((low + high) / 2) < 0) == is_below ? low : high) = (low + high) / 2;
                const Vec3 crossing = (1 - low) * a + low * b;
                double nearest = 1;
                for (const Vec3& p : result.positions) nearest = std::min(nearest, (p - crossing).norm());
                EXPECT_LT(nearest, 1e-12);
                ++crossings;
            }
    }
    EXPECT_GT(crossings, 100u);
    // So many triangles suffice as for a smooth surface.
    const TriangleMesh fine = tessellated(patches, 256, Length(1e-3));
    expect_sound(fine, mesh, patches);
    EXPECT_LT(worst_distance_to(patches, fine), 1.5e-3);
    EXPECT_LT(fine.triangles.size(), 200'000u);
}

TEST(Tessellate, OfEqualShares_TheEdgesSampleComesFirst) {
    // On a flat triangle with two segments per edge the row inside has one. Both next samples are at the end: the
    // edge's comes first, so its middle is in two triangles, not in three.
    const TriangleMesh mesh = soup({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}});
    const TriangleMesh result = tessellated(patched(mesh).result.patches, 2);
    for (const Vec3& middle : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) {
        std::size_t triangles = 0;
        for (const Triangle& t : result.triangles)
            triangles += static_cast<std::size_t>(
                std::ranges::count_if(t, [&](u32 v) { return (result.positions[v] - middle).norm() < 1e-12; }));
        EXPECT_EQ(triangles, 2u);
    }
}

TEST(Tessellate, DifferentLevelsSideBySide_LeaveNoCracks) {
    // Long and short triangles in one mesh: edges get from 1 to many segments.
    const TriangleMesh mesh =
        with_positions(geodesic_sphere(1, 3), [](const Vec3& p) { return Vec3(p.x(), p.y(), 5 * p.z()); });
    const APatchResult result = patched(mesh).result;
    for (const double error : {0.1, 0.02, 0.004})
        expect_sound(tessellated(result.patches, 512, Length(error)), result.mesh, result.patches);
}

TEST(Tessellate, ATooSmallSubdivision_IsRefusedWithTheDistanceLeftAndWhatWouldDo) {
    const PatchComplex patches = patched(exact_sphere(1), Curvature::mean).result.patches;
    const Error error = error_of([&] { tessellated(patches, 4, Length(1e-4)); });
    EXPECT_THAT(error.sentence(), HasSubstr("with 4 segments per edge"));
    EXPECT_THAT(error.sentence(), HasSubstr("max-error is 0.0001"));
    ASSERT_THAT(error.hint(), HasSubstr("subdivision "));
    const auto enough = static_cast<u32>(std::stoul(error.hint().substr(std::string("subdivision ").size())));
    EXPECT_NO_THROW(tessellated(patches, enough, Length(1e-4)));
}

TEST(Tessellate, AMaxErrorThatNoSubdivisionMeets_IsRefused_AndIsNotALeap) {
    const PatchComplex patches = patched(exact_sphere(1), Curvature::mean).result.patches;
    Execution execution;
    double left = 0;
    const Error error = error_of([&] { tessellate(patches, {16, Length(1e-9)}, execution, &left); });
    EXPECT_THAT(error.sentence(), HasSubstr("with 16 segments per edge"));
    EXPECT_EQ(error.hint(), "use a larger max-error, or `decimate` with a smaller one");
    EXPECT_EQ(left, 0);
}

TEST(Tessellate, WhereTheSurfaceLeaps_ADistanceIsLeftAndTheRestIsWithinMaxError) {
    PatchComplex patches = patched(exact_sphere(1), Curvature::mean).result.patches;
    double left = 1;
    Execution execution;
    tessellate(patches, {64, Length(1e-3)}, execution, &left);
    EXPECT_EQ(left, 0);
    // The function beside one edge no longer agrees with that of the triangle on their common face.
    std::size_t row = 0;
    while (patches.kinds[row] != PatchKind::edge || patches.sides[row] != 1) ++row;
    constexpr std::size_t between_edge_and_apex = 14;  // exponents 0, 1, 1, 1
    Array<PatchWeights> weights(patches.weights.begin(), patches.weights.end());
    weights[row][between_edge_and_apex] *= 1.2;
    patches.weights = std::move(weights);
    EXPECT_THAT(error_of([&] { tessellated(patches, 64, Length(1e-3)); }).hint(),
                HasSubstr("a larger max-error needs fewer segments"));
    const TriangleMesh mesh = tessellate(patches, {64, Length(1e-3)}, execution, &left);
    EXPECT_GT(left, 1e-3);
    EXPECT_LT(left, 0.1);
    const MeshTopology found = topology(mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.euler, 2);
    // As fine as without the leap elsewhere.
    EXPECT_LT(
        mesh.triangles.size(),
        20 * tessellated(patched(exact_sphere(1), Curvature::mean).result.patches, 64, Length(1e-3)).triangles.size());
}

TEST(Tessellate, AnOpenMesh_HasItsBoundary) {
    const TriangleMesh mesh = without_triangles(geodesic_sphere(1, 2), {0, 1});
    for (const Split split : {Split::always, Split::where_needed}) {
        const PatchComplex patches = patched(mesh, Curvature::distance, split).result.patches;
        for (const TriangleMesh& result : {tessellated(patches, 3), tessellated(patches, 64, Length(1e-3))}) {
            const MeshTopology found = topology(result);
            EXPECT_EQ(found.euler, topology(mesh).euler);
            EXPECT_EQ(found.boundary_loops, 1u);
            EXPECT_EQ(found.nonmanifold_vertices + found.nonmanifold_edges + found.misoriented_edges, 0u);
            expect_no_equal_corners(result);
        }
    }
}

TEST(Tessellate, AFlatMesh_StaysFlat) {
    const PatchComplex patches =
        patched(soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}})).result.patches;
    const TriangleMesh result = tessellated(patches, 4);
    for (const Vec3& p : result.positions) EXPECT_NEAR(p.z(), 0, 1e-15);
    EXPECT_NEAR(area(result), 1, 1e-12);
    expect_no_equal_corners(result);
}

/// An octahedron whose upper vertex, 4, is split: an edge without length leads to vertex 6.
TriangleMesh split_octahedron() {
    TriangleMesh mesh;
    mesh.positions = {Vec3(1, 0, 0), Vec3(0, 1, 0),  Vec3(-1, 0, 0), Vec3(0, -1, 0),
                      Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 0, 1)};
    mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 6}, {3, 0, 6}, {0, 4, 6},
                      {4, 2, 6}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
    mesh.face_columns.add(Column("patch", 1, Buffer<u32>(Array<u32>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9})));
    mesh.vertex_columns.add(Column("row", 1, Buffer<u32>(Array<u32>{0, 1, 2, 3, 4, 5, 6})));
    mesh.sharp_edges = {{0, 4}, {0, 6}, {4, 6}};
    return mesh;
}

TEST(Tessellate, EqualCorners_AreJoinedAndTheMeshStaysClosed) {
    const TriangleMesh split = split_octahedron();
    ASSERT_TRUE(topology(split).closed);
    const TriangleMesh joined = without_equal_corners(split);
    EXPECT_TRUE(topology(joined).closed);
    EXPECT_EQ(topology(joined).euler, 2);
    EXPECT_EQ(joined.positions.size(), 6u);
    EXPECT_EQ(joined.vertex_columns.find("row")->rows(), 6u);
    expect_no_equal_corners(joined);
    std::vector<double> patches;
    for (u32 row = 0; row < joined.triangles.size(); ++row)
        patches.push_back(joined.face_columns.find("patch")->number(row));
    EXPECT_THAT(patches, testing::ElementsAre(0, 1, 2, 3, 6, 7, 8, 9));
    ASSERT_EQ(joined.sharp_edges.size(), 1u);
    EXPECT_EQ(joined.sharp_edges[0], (Edge{0, 4}));
    const TriangleMesh again = without_equal_corners(joined);
    EXPECT_TRUE(std::ranges::equal(again.triangles, joined.triangles));
}

TEST(Tessellate, EqualPositionsWithoutAnEdgeBetweenThem_StayApart) {
    const TriangleMesh apart =
        soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 1}, {0, 1, 1}}, {{0, 1, 2}, {3, 4, 5}});
    EXPECT_EQ(without_equal_corners(apart).positions.size(), 6u);
}

TEST(Tessellate, ATorus_DoesNotIntersectItself) {
    const TriangleMesh result = tessellated(patched(exact_torus(12, 6)).result.patches, 4);
    const TriangleTree tree(result.positions.span(), result.triangles.span(), 1);
    Execution execution;
    EXPECT_EQ(self_intersections(result.positions.span(), result.triangles.span(), tree, execution).count, 0u);
}

TEST(Tessellate, AnyNumberOfThreads_GivesTheSameBits) {
    const PatchComplex patches = patched(exact_torus(24, 12)).result.patches;
    for (const TessellateParams& params : {TessellateParams{3, {}}, TessellateParams{64, Length(1e-3)}}) {
        const TriangleMesh one = tessellated(patches, params), four = tessellated(patches, params, 4);
        EXPECT_TRUE(std::ranges::equal(one.positions, four.positions));
        EXPECT_TRUE(std::ranges::equal(one.triangles, four.triangles));
        EXPECT_TRUE(one.vertex_columns == four.vertex_columns && one.face_columns == four.face_columns);
    }
}

TEST(TessellateRefuses, PatchesThatAreNotComplete) {
    const Error empty = error_of([&] { tessellated(PatchComplex{}, 1); });
    EXPECT_THAT(empty.sentence(), HasSubstr("no tetrahedra"));
    EXPECT_FALSE(empty.hint().empty());
    const PatchComplex whole = patched(exact_sphere(1)).result.patches;
    for (std::size_t missing = 0; missing < whole.tets.size(); missing += 17) {
        Array<u32> rows;
        for (u32 row = 0; row < whole.tets.size(); ++row)
            if (row != missing) rows.push_back(row);
        PatchComplex part = whole;
        part.tets = gather(whole.tets, rows);
        part.weights = gather(whole.weights, rows);
        part.kinds = gather(whole.kinds, rows);
        part.sides = gather(whole.sides, rows);
        part.triangles = gather(whole.triangles, rows);
        part.edges = gather(whole.edges, rows);
        const Error error = error_of([&] { tessellated(part, 1); });
        EXPECT_THAT(error.sentence(), HasSubstr("not complete")) << missing;
        EXPECT_FALSE(error.hint().empty());
    }
}

TEST(TessellateRefuses, ParametersOutOfRange) {
    const PatchComplex patches = patched(exact_sphere(1)).result.patches;
    const Error segments = error_of([&] { tessellated(patches, 0); });
    EXPECT_THAT(segments.sentence(), HasSubstr("subdivision must be from 1"));
    EXPECT_FALSE(segments.hint().empty());
    const Error exact = error_of([&] { tessellated(patches, 4, Length(0)); });
    EXPECT_THAT(exact.sentence(), HasSubstr("max-error must be above 0"));
    EXPECT_FALSE(exact.hint().empty());
}

}  // namespace
}  // namespace scanmill
