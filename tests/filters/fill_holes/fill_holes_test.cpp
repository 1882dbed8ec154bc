// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "filters/fill_holes/cases.hpp"

namespace scanmill::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A cube without its two triangles on top.
TriangleMesh open_cube(double edge = 1) {
    const TriangleMesh whole = cube(edge);
    return without(whole, [&](u32 t) {
        return std::ranges::all_of(whole.triangles[t], [&](u32 v) { return whole.positions[v].z() == edge; });
    });
}

TEST(FillHoles, OfACubeWithoutATriangle_PutsItBack) {
    const TriangleMesh mesh = without_triangles(cube(), {5});
    const Filled result = filled(mesh);
    const Triangle lost = cube().triangles[5];
    ASSERT_EQ(result.mesh.triangles.size(), 12u);
    Triangle added = result.mesh.triangles[11];
    std::ranges::rotate(added, std::ranges::find(added, lost[0]));
    EXPECT_EQ(added, lost);
    EXPECT_EQ(result.filled, 1u);
    EXPECT_EQ(result.area, 0.5);
    EXPECT_DOUBLE_EQ(result.longest, 2 + std::numbers::sqrt2);
    EXPECT_DOUBLE_EQ(signed_volume(result.mesh), 1);
    EXPECT_NEAR(result.metrics.find("share")->value, 0.5 / 6, 1e-15);
    EXPECT_EQ(result.metrics.find("area")->unit, Unit::area);
    EXPECT_EQ(result.metrics.find("added-triangles")->value, 1);
    EXPECT_EQ(result.metrics.find("added-points")->value, 0);
    expect_laws(mesh, result);
}

TEST(FillHoles, OfACubeWithoutAFace_IsTheCube) {
    const TriangleMesh mesh = open_cube();
    const Filled result = filled(mesh);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_NEAR(signed_volume(result.mesh), 1, 1e-12);
    EXPECT_NEAR(result.area, 1, 1e-12);
    EXPECT_EQ(result.longest, 4);
    expect_laws(mesh, result);
}

TEST(FillHoles, ASurfaceThatFacesInwards_FacesOutwardsOnceItIsClosed) {
    TriangleMesh mesh = open_cube();
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
    mesh.triangles = std::move(triangles);
    const Filled result = filled(mesh);
    EXPECT_NEAR(signed_volume(result.mesh), 1, 1e-12);
    EXPECT_THAT(result.warnings, Contains(HasSubstr("12 triangles were turned")));
}

TEST(FillHoles, ACavityFacesInwards_ABodyInItOutwards) {
    const TriangleMesh spheres[] = {geodesic_sphere(3, 4), geodesic_sphere(2, 4), geodesic_sphere(1, 4)};
    const double volume = signed_volume(spheres[0]) - signed_volume(spheres[1]) + signed_volume(spheres[2]);
    const auto triangles = static_cast<u32>(spheres[0].triangles.size());
    for (unsigned turned_inwards = 0; turned_inwards < 8; ++turned_inwards) {
        const auto part = [&](unsigned i) {
            return (turned_inwards >> i & 1u) != 0 ? inside_out(spheres[i]) : spheres[i];
        };
        const TriangleMesh nested = both(both(part(0), part(1)), part(2));
        const Filled result = filled(without(nested, [&](u32 t) { return t % triangles == 7; }));
        EXPECT_EQ(result.filled, 3u) << turned_inwards;
        EXPECT_TRUE(topology(result.mesh).closed) << turned_inwards;
        EXPECT_NEAR(signed_volume(result.mesh), volume, 1e-9) << turned_inwards;
    }
}

TEST(FillHoles, ASoupOfAKleinBottle_IsClosedAsAWhole_AndDoubtful) {
    const Filled result = filled(separate(klein_bottle(24, 12)));
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_GT(signed_volume(result.mesh), 0);
    EXPECT_EQ(self_intersections_of(result.mesh), 0u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("closed as a whole")));
}

TEST(FillHoles, OfAClosedMesh_AddsOnlyTheMarks) {
    const TriangleMesh mesh = cube();
    const Filled result = filled(mesh);
    EXPECT_EQ(result.filled + result.failed + result.beyond_limits, 0u);
    EXPECT_THAT(result.doubts, IsEmpty());
    EXPECT_EQ(result.mesh.positions.data(), mesh.positions.data()) << "no copy";
    expect_laws(mesh, result);
}

TEST(FillHoles, LoopsAtALimit_AreFilled) {
    FillHolesParams params;
    params.max_edges = 4;
    params.max_length = Length(4);
    EXPECT_EQ(filled(open_cube(), params).filled, 1u);
    params.max_edges = 3;
    const Filled many_edges = filled(open_cube(), params);
    EXPECT_EQ(many_edges.filled, 0u);
    EXPECT_EQ(many_edges.beyond_limits, 1u);
    EXPECT_EQ(many_edges.metrics.find("left")->value, 1);
    EXPECT_THAT(many_edges.doubts, IsEmpty()) << "as was asked for";
    params.max_edges = 4;
    params.max_length = Length(std::nextafter(4, 0));
    EXPECT_EQ(filled(open_cube(), params).beyond_limits, 1u);
}

TEST(FillHoles, FairFillings_ContinueASphere) {
    const TriangleMesh mesh = below(geodesic_sphere(1, 16), 0.85);
    const auto farthest = [&](const TriangleMesh& result) {
        double deviation = 0;
        for (std::size_t v = mesh.positions.size(); v < result.positions.size(); ++v)
            deviation = std::max(deviation, std::abs(result.positions[v].norm() - 1));
        return deviation;
    };
    const Filled fair = filled(mesh);
    FillHolesParams params;
    params.fair = false;
    const Filled plain = filled(mesh, params);
    ASSERT_GT(fair.mesh.positions.size(), mesh.positions.size() + 10);
    // The plane through the rim is 0.15 to 0.2 below the pole.
    EXPECT_GT(farthest(plain.mesh), 0.1);
    EXPECT_LT(farthest(fair.mesh), 0.02);
    expect_laws(mesh, fair);
    expect_laws(mesh, plain);
    EXPECT_TRUE(topology(fair.mesh).closed);
}

TEST(FillHoles, HolesThatTouchInAVertex_AreTwoHoles) {
    // Two triangles around the first vertex of an icosahedron that have no edge in common.
    const TriangleMesh whole = icosahedron();
    std::vector<u32> at_first;
    for (u32 t = 0; t < whole.triangles.size(); ++t)
        if (std::ranges::count(whole.triangles[t], 0u) > 0) at_first.push_back(t);
    const auto share_an_edge = [&](u32 one, u32 other) {
        return std::ranges::count_if(whole.triangles[one],
                                     [&](u32 v) { return std::ranges::count(whole.triangles[other], v) > 0; }) == 2;
    };
    const u32 second =
        *std::ranges::find_if(at_first, [&](u32 t) { return t != at_first[0] && !share_an_edge(t, at_first[0]); });
    const TriangleMesh mesh = without_triangles(whole, {at_first[0], second});
    EXPECT_EQ(topology(mesh).nonmanifold_vertices, 1u);
    const Filled result = filled(mesh);
    EXPECT_EQ(result.filled, 2u);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_NEAR(signed_volume(result.mesh), signed_volume(whole), 1e-12);
    expect_laws(mesh, result);
}

TEST(FillHoles, HolesThatTouchInTwoVertices_AreTwoHoles) {
    // Two triangles at an edge stay, those around the ends of the edge go: the two meet the rest in two corners only.
    const TriangleMesh whole = geodesic_sphere(1, 8);
    const u32 kept = 300;
    const u32 i = whole.triangles[kept][0], j = whole.triangles[kept][1];
    const auto has = [&](u32 t, u32 v) { return std::ranges::count(whole.triangles[t], v) > 0; };
    const TriangleMesh mesh =
        without(whole, [&](u32 t) { return (has(t, i) || has(t, j)) && !(has(t, i) && has(t, j)); });
    EXPECT_EQ(topology(mesh).nonmanifold_vertices, 2u);
    EXPECT_EQ(topology(mesh).components, 2u);
    const Filled result = filled(mesh);
    EXPECT_EQ(result.failed, 0u);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.filled, 2u);
    EXPECT_EQ(topology(result.mesh).genus, 0);
    EXPECT_EQ(intersecting_fillings(mesh, result.mesh), 0u);
}

TEST(FillHoles, SurfacesThatTouchInAVertexOfTheirRims_AreClosedApart) {
    // Two cubes without a face that have one corner in common, where both are open.
    const TriangleMesh one = open_cube();
    TriangleMesh two = both(one, with_positions(one, [](const Vec3& p) -> Vec3 { return p + Vec3(1, 1, 0); }));
    const auto row_of = [&](const Vec3& p, bool last) {
        u32 found = 0;
        for (u32 v = 0; v < two.positions.size(); ++v)
            if (two.positions[v] == p && (last || found == 0)) found = v;
        return found;
    };
    const u32 kept = row_of({1, 1, 1}, false), replaced = row_of({1, 1, 1}, true);
    ASSERT_NE(kept, replaced);
    Array<Triangle> triangles(two.triangles.begin(), two.triangles.end());
    for (Triangle& triangle : triangles)
        for (u32& vertex : triangle)
            if (vertex == replaced) vertex = kept;
    two.triangles = std::move(triangles);
    const TriangleMesh mesh = without_unused_vertices(two);
    const Filled result = filled(mesh);
    const MeshTopology after = topology(result.mesh);
    EXPECT_EQ(result.failed, 0u);
    EXPECT_EQ(after.boundary_edges, 0u);
    EXPECT_EQ(after.components, 2u);
    EXPECT_EQ(after.nonmanifold_edges + after.misoriented_edges, 0u);
    EXPECT_EQ(intersecting_fillings(mesh, result.mesh), 0u);
}

TEST(FillHoles, AHoleAsLargeAsTheObject_IsDoubtful) {
    const TriangleMesh mesh = below(geodesic_sphere(1, 12), 0);
    const Filled result = filled(mesh, every_loop());
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("1 loop is longer than the diagonal of the mesh")));
    EXPECT_THAT(result.doubts, Contains(HasSubstr("of the surface is new, more than 5 %")));
    expect_laws(mesh, result);
    FillHolesParams params = every_loop();
    params.max_length = Length(3);
    EXPECT_EQ(filled(mesh, params).filled, 0u);
}

TEST(FillHoles, SmallHoles_AreNotDoubtful) {
    const TriangleMesh mesh = without_triangles(geodesic_sphere(1, 8), {3, 400, 900});
    const Filled result = filled(mesh);
    EXPECT_EQ(result.filled, 3u);
    EXPECT_THAT(result.doubts, IsEmpty());
    EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(FillHoles, TheOutlineOfAFlatSheet_StaysOpenWithADoubt) {
    const TriangleMesh mesh = rectangle(2, 1);
    const Filled result = filled(mesh, every_loop());
    EXPECT_EQ(result.filled, 0u);
    EXPECT_EQ(result.failed, 1u);
    EXPECT_THAT(result.doubts, ElementsAre("1 loop stays open: no triangulation without intersections was found"));
    expect_laws(mesh, result);
}

TEST(FillHoles, Specks_StayOpenWithADoubt) {
    const TriangleMesh one = soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    const TriangleMesh mesh = both(one, with_positions(one, [](const Vec3& p) -> Vec3 { return p + Vec3(5, 0, 1); }));
    const Filled result = filled(mesh, every_loop());
    EXPECT_EQ(result.failed, 2u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("2 loops stay open")));
}

TEST(FillHoles, ARimThatCrossesItself_GetsNoFillingThatIntersects) {
    // The rim of a hole in a sphere, with two of its vertices exchanged and one pushed through the opposite rim.
    TriangleMesh mesh = below(geodesic_sphere(1, 10), 0.7);
    std::vector<u32> rim;
    for (u32 v = 0; v < mesh.positions.size(); ++v)
        if (mesh.positions[v].z() > 0.6) rim.push_back(v);
    ASSERT_GT(rim.size(), 6u);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    std::swap(positions[rim[0]], positions[rim[rim.size() / 2]]);
    positions[rim[1]] = -1.5 * positions[rim[1]];
    mesh.positions = std::move(positions);
    const Filled result = filled(mesh);
    EXPECT_EQ(result.together, 1u);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(self_intersections_of(result.mesh), 0u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("closed as a whole")));
    FillHolesParams alone;
    alone.together = false;
    EXPECT_EQ(intersecting_fillings(mesh, filled(mesh, alone).mesh), 0u);
}

/// A tub whose rim rises and falls: a lid bends down along one diagonal, or up along the other. A speck at the height
/// pierces one of them, so only the other is a filling.
TriangleMesh obstructed_tub(double height) {
    const TriangleMesh tub = soup(
        {{0, 0, 0}, {2, 0, 1}, {2, 2, 0}, {0, 2, 1}, {0, 0, -3}, {2, 0, -3}, {2, 2, -3}, {0, 2, -3}},
        {{4, 7, 6}, {4, 6, 5}, {4, 5, 1}, {4, 1, 0}, {5, 6, 2}, {5, 2, 1}, {6, 7, 3}, {6, 3, 2}, {7, 4, 0}, {7, 0, 3}});
    const TriangleMesh speck =
        soup({{1, 1, height - 0.05}, {1.02, 1, height + 0.05}, {1, 1.02, height + 0.05}}, {{0, 1, 2}});
    return both(tub, speck);
}

TEST(FillHoles, AnObstacleInTheHole_IsAvoided) {
    for (const double height : {0.0, 1.0}) {
        const TriangleMesh mesh = obstructed_tub(height);
        FillHolesParams params;
        params.together = false;
        const Filled result = filled(mesh, params);
        EXPECT_EQ(result.filled, 1u) << height;
        EXPECT_EQ(result.failed, 1u) << "the speck's own outline";
        expect_laws(mesh, result);
    }
}

TEST(FillHoles, OfFillingsThatMeet_OneGivesWay) {
    // Two spheres without the caps that face each other: caps would meet, a flat lid of one of them does not.
    const TriangleMesh lower = below(geodesic_sphere(1, 12), 0.8);
    const TriangleMesh upper = shifted(turned(lower, std::numbers::pi, {1, 0, 0}), {0, 0, 1.9});
    const TriangleMesh fewer =
        shifted(turned(below(geodesic_sphere(1, 9), 0.8), std::numbers::pi, {1, 0, 0}), {0, 0, 1.9});
    // Lowest and highest of the new vertices near the axis.
    const auto heights = [](const TriangleMesh& mesh, const Filled& result) {
        std::pair<double, double> ends{1e9, -1e9};
        for (std::size_t v = mesh.positions.size(); v < result.mesh.positions.size(); ++v) {
            const Vec3& p = result.mesh.positions[v];
            if (p.head<2>().norm() < 0.25) ends = {std::min(ends.first, p.z()), std::max(ends.second, p.z())};
        }
        return ends;
    };
    const TriangleMesh equal = both(lower, upper), unequal = both(lower, fewer);
    const Filled later = filled(equal), larger = filled(unequal);
    for (const Filled* result : {&later, &larger}) {
        EXPECT_EQ(result->filled, 2u);
        EXPECT_EQ(result->plain, 1u);
        EXPECT_TRUE(topology(result->mesh).closed);
    }
    // There the cap of the lower sphere is about 1 high, that of the upper one 0.9; lids are at 0.8 and 1.1.
    EXPECT_GT(heights(equal, later).first, 0.93) << "of equally many edges the later one is flat";
    EXPECT_GT(heights(equal, later).second, 1.03);
    EXPECT_LT(heights(unequal, larger).first, 0.87) << "the one with more edges is flat";
    EXPECT_LT(heights(unequal, larger).second, 0.97);
}

TEST(FillHoles, TwoHolesOfAThinPlate_DoNotFillThroughEachOther) {
    // A sphere with two opposite caps removed: fair fillings of a tube may meet, plainer ones do not.
    const TriangleMesh whole = geodesic_sphere(1, 12);
    const TriangleMesh mesh = without(whole, [&](u32 t) {
        return std::ranges::any_of(whole.triangles[t], [&](u32 v) { return std::abs(whole.positions[v].z()) > 0.15; });
    });
    const Filled result = filled(mesh, every_loop());
    EXPECT_EQ(result.filled, 2u);
    EXPECT_TRUE(topology(result.mesh).closed);
    expect_laws(mesh, result);
}

TEST(FillHoles, NewRows_HaveTheValuesOfTheBoundaryBesideThem) {
    TriangleMesh mesh = below(geodesic_sphere(1, 8), 0.8);
    Array<u32> views(mesh.positions.size()), patches(mesh.triangles.size());
    Array<float> normals;
    for (u32 v = 0; v < views.size(); ++v) {
        views[v] = v;
        for (const double x : mesh.positions[v]) normals.push_back(static_cast<float>(x));
    }
    for (u32 t = 0; t < patches.size(); ++t) patches[t] = t;
    mesh.vertex_columns.add(Column("view", 1, Buffer<u32>(std::move(views))));
    mesh.vertex_columns.add(Column("normal", 3, Buffer<float>(std::move(normals))));
    mesh.face_columns.add(Column("patch", 1, Buffer<u32>(std::move(patches))));
    mesh.face_columns.add(Column("corner-normals", 9, Buffer<float>(Array<float>(9 * mesh.triangles.size(), 0.f))));
    const Filled result = filled(mesh);
    ASSERT_GT(result.mesh.positions.size(), mesh.positions.size());
    std::set<u32> rim;
    const MeshTopology open = topology(mesh);
    std::map<Edge, int> count;
    for (const auto& [a, b, c] : mesh.triangles)
        ++count[make_edge(a, b)], ++count[make_edge(b, c)], ++count[make_edge(c, a)];
    for (const auto& [edge, triangles] : count)
        if (triangles == 1) rim.insert({edge[0], edge[1]});
    EXPECT_EQ(rim.size(), open.boundary_edges);
    const std::span<const u32> view = result.mesh.vertex_columns.find("view")->values<u32>();
    const Column& normal = *result.mesh.vertex_columns.find("normal");
    for (std::size_t v = mesh.positions.size(); v < view.size(); ++v) {
        EXPECT_TRUE(rim.contains(view[v]));
        const Vec3 direction(normal.number(v, 0), normal.number(v, 1), normal.number(v, 2));
        EXPECT_NEAR(direction.norm(), 1, 1e-6);
        EXPECT_GT(direction.dot(result.mesh.positions[v].normalized()), 0.98) << "outwards, as on the sphere";
    }
    const std::span<const u32> patch = result.mesh.face_columns.find("patch")->values<u32>();
    const Column& corners = *result.mesh.face_columns.find("corner-normals");
    for (std::size_t t = mesh.triangles.size(); t < patch.size(); ++t) {
        ASSERT_LT(patch[t], mesh.triangles.size());
        EXPECT_TRUE(std::ranges::any_of(mesh.triangles[patch[t]], [&](u32 v) { return rim.contains(v); }));
        EXPECT_EQ(corners.number(t, 2), corners.number(t, 8));
        EXPECT_GT(corners.number(t, 2), 0.5);
    }
    const std::span<const u8> marks = result.mesh.vertex_columns.find("filled")->values<u8>();
    for (std::size_t v = 0; v < marks.size(); ++v) EXPECT_EQ(marks[v], v >= mesh.positions.size());
}

TEST(FillHoles, MarksOfAnEarlierRun_Stay) {
    const TriangleMesh mesh = without_triangles(geodesic_sphere(1, 4), {3, 100});
    FillHolesParams none;
    none.max_length = Length(1e-3);
    TriangleMesh first = filled(without_triangles(geodesic_sphere(1, 4), {3})).mesh;
    const std::size_t rows = first.triangles.size();
    const TriangleMesh again = filled(first, none).mesh;
    EXPECT_EQ(again.face_columns.find("filled")->values<u8>()[rows - 1], 1);
    TriangleMesh other = mesh;
    other.face_columns.add(Column("filled", 1, Buffer<float>(Array<float>(mesh.triangles.size(), 0.5f))));
    const Filled replaced = filled(other);
    EXPECT_THAT(replaced.warnings, ElementsAre(HasSubstr("the face column 'filled' of the input is replaced")));
    EXPECT_EQ(replaced.mesh.face_columns.find("filled")->type(), ScalarType::uint8);
}

TEST(FillHoles, Seams_AreReported) {
    const TriangleMesh one = open_cube();
    const TriangleMesh lid = with_positions(rectangle(1, 1), [](const Vec3& p) -> Vec3 { return p + Vec3(0, 0, 1); });
    const Filled result = filled(both(one, lid));
    EXPECT_THAT(result.warnings, Contains(HasSubstr("8 boundary edges are at the position of another")));
    EXPECT_EQ(result.together, 2u);
    EXPECT_TRUE(topology(result.mesh).closed);
    FillHolesParams alone;
    alone.together = false;
    EXPECT_EQ(filled(both(one, lid), alone).failed, 2u);
}

/// A surface of n × m points, closed in the first direction, that faces as the first direction, then the second;
/// `at(i, j)` gives the points, which are moved a little, as the points of a scan are not on circles.
template <class At>
TriangleMesh band(u32 n, u32 m, At&& at) {
    Random random(n + m);
    Array<Vec3> positions;
    Array<Triangle> triangles;
    const auto shake = [&] { return 0.02 * (random.uniform() - 0.5); };
    for (u32 j = 0; j < m; ++j)
        for (u32 i = 0; i < n; ++i) positions.push_back(at(i, j) + Vec3(shake(), shake(), shake()));
    for (u32 j = 0; j + 1 < m; ++j)
        for (u32 i = 0; i < n; ++i) {
            const u32 a = j * n + i, b = j * n + (i + 1) % n;
            triangles.push_back({a, b, b + n});
            triangles.push_back({a, b + n, a + n});
        }
    return soup(std::move(positions), std::move(triangles));
}

/// From z = 0.
TriangleMesh wall(double radius, double height) {
    return band(48, 16, [&](u32 i, u32 j) -> Vec3 {
        const double angle = (i + 0.5 * (j % 2)) * std::numbers::pi / 24;
        return {radius * std::cos(angle), radius * std::sin(angle), height * j / 15};
    });
}

/// A ring, flat and round, that faces down.
TriangleMesh ring(double inner, double outer, double height) {
    return band(48, 12, [&](u32 i, u32 j) -> Vec3 {
        const double angle = (i + 0.5 * (j % 2)) * std::numbers::pi / 24, radius = inner + (outer - inner) * j / 11;
        return {radius * std::cos(angle), -radius * std::sin(angle), height};
    });
}

/// A can whose lid is missing around a post that stands on it.
TriangleMesh can_with_post() {
    const TriangleMesh can = both(wall(2, 4), ring(0.05, 1.9, 0));
    const TriangleMesh post = both(wall(1, 3), shifted(inside_out(ring(0.05, 0.9, 0)), {0, 0, 3}));
    return both(can, shifted(post, {0, 0, 4}));
}

TEST(FillHoles, ARingBetweenTwoLoops_IsClosedTogether) {
    const TriangleMesh mesh = can_with_post();
    const Filled result = filled(mesh);
    EXPECT_GT(result.together, 0u);
    EXPECT_EQ(result.failed, 0u);
    const MeshTopology after = topology(result.mesh);
    EXPECT_TRUE(after.closed);
    EXPECT_EQ(after.components, 1u);
    EXPECT_EQ(after.genus, 0);
    EXPECT_NEAR(signed_volume(result.mesh), std::numbers::pi * (4 * 4 + 3), 5);
    EXPECT_EQ(self_intersections_of(result.mesh), 0u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("closed as a whole")));
}

TEST(FillHoles, LoopsBeyondALimit_KeepTheOthersFromBeingClosedTogether) {
    FillHolesParams params;
    params.max_length = Length(10.0);
    const Filled result = filled(can_with_post(), params);
    EXPECT_GT(result.beyond_limits, 0u);
    EXPECT_EQ(result.together, 0u);
}

TEST(FillHoles, AMeshInsideOut_FacesOutwardsOnceItIsClosedTogether) {
    const Filled reversed = filled(inside_out(can_with_post()));
    EXPECT_GT(reversed.together, 0u);
    EXPECT_NEAR(signed_volume(reversed.mesh), std::numbers::pi * (4 * 4 + 3), 5);
}

TEST(FillHoles, ClosedTogether_KeepsColumnsAndMarks) {
    TriangleMesh mesh = can_with_post();
    Array<u32> numbers(mesh.triangles.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    mesh.face_columns.add(Column("number", 1, Buffer<u32>(std::move(numbers))));
    mesh.sharp_edges = Array<Edge>{make_edge(mesh.triangles[0][0], mesh.triangles[0][1])};
    const Filled result = filled(mesh);
    ASSERT_GT(result.together, 0u);
    const auto number = result.mesh.face_columns.find("number")->values<u32>();
    const auto marks = result.mesh.face_columns.find("filled")->values<u8>();
    const std::size_t kept = mesh.triangles.size() - result.replaced;
    for (std::size_t t = 0; t < kept; ++t) {
        ASSERT_EQ(result.mesh.triangles[t], mesh.triangles[number[t]]) << t;
        ASSERT_EQ(marks[t], 0) << t;
    }
    EXPECT_GT(std::ranges::count(marks, 1), 0);
    EXPECT_TRUE(std::ranges::equal(result.mesh.positions.span().first(mesh.positions.size()), mesh.positions.span()));
    EXPECT_NO_THROW(require_consistent(result.mesh));
}

TEST(FillHoles, LooseTrianglesInAClosedObject_AreLeftOut) {
    // Closing together only removes triangles here.
    const TriangleMesh sphere = geodesic_sphere(1, 6);
    TriangleMesh mesh = both(sphere, soup({{0, 0, 0}, {0.1, 0, 0.02}, {0, 0.1, 0}}, {{0, 1, 2}}));
    Array<u32> numbers(mesh.triangles.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    mesh.face_columns.add(Column("number", 1, Buffer<u32>(std::move(numbers))));
    const Filled result = filled(mesh);
    EXPECT_EQ(result.together, 1u);
    EXPECT_EQ(result.replaced, 1u);
    EXPECT_NO_THROW(require_consistent(result.mesh));
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_TRUE(std::ranges::equal(result.mesh.triangles, sphere.triangles));
}

TEST(FillHoles, ManyLoopsThatCannotBeRefined_AreAvoidedApart) {
    // Tubs with a lid that only one diagonal allows, as in AnObstacleInTheHole_IsAvoided, far from each other.
    TriangleMesh mesh = obstructed_tub(0);
    for (int i = 1; i < 6; ++i) mesh = both(mesh, shifted(obstructed_tub(i % 2), {9.0 * i, 0, 0}));
    FillHolesParams params;
    params.together = false;
    const Filled one = filled(mesh, params), four = filled(mesh, params, 4);
    EXPECT_EQ(one.filled, 6u);
    EXPECT_EQ(one.failed, 6u) << "the outlines of the specks";
    expect_laws(mesh, one);
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, four.mesh.triangles));
}

TEST(FillHoles, AMeshOfSpecksAlone_StaysOpenWithADoubt) {
    TriangleMesh specks;
    for (int i = 0; i < 20; ++i) {
        const Vec3 at(i % 3, i % 5, i % 7);
        const TriangleMesh speck = soup({at, at + Vec3(0.1, 0, 0.01 * i), at + Vec3(0, 0.1, 0.02)}, {{0, 1, 2}});
        specks = i == 0 ? speck : both(specks, speck);
    }
    const Filled result = filled(specks);
    EXPECT_EQ(result.failed, 20u);
    EXPECT_THAT(result.doubts, ElementsAre("20 loops stay open: no triangulation without intersections was found"));
}

TEST(FillHoles, RandomHoles_KeepTheLaws) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        Random random(seed);
        const TriangleMesh whole = geodesic_sphere(1, 12);
        const double share = 0.02 * static_cast<double>(seed * seed);
        const TriangleMesh mesh = without(whole, [&](u32) { return random.uniform() < share; });
        const Filled result = filled(mesh);
        EXPECT_GT(result.filled, 20u) << seed;
        const MeshTopology before = topology(mesh), after = topology(result.mesh);
        EXPECT_EQ(after.nonmanifold_edges + after.misoriented_edges, 0u) << seed;
        EXPECT_EQ(intersecting_fillings(mesh, result.mesh), 0u) << seed;
        EXPECT_LE(after.boundary_edges, before.boundary_edges) << seed;
        EXPECT_EQ(after.closed, result.failed == 0) << seed;
        EXPECT_EQ(result.doubts.empty(),
                  result.failed + result.together == 0 && result.metrics.find("share")->value <= 0.05)
            << seed;
    }
}

TEST(FillHoles, Threads_DoNotChangeTheResult) {
    Random random(7);
    const TriangleMesh whole = geodesic_sphere(1, 16);
    const TriangleMesh mesh = without(whole, [&](u32) { return random.uniform() < 0.1; });
    const Filled one = filled(mesh), four = filled(mesh, {}, 4);
    EXPECT_EQ(one.filled, four.filled);
    EXPECT_TRUE(std::ranges::equal(one.mesh.positions, four.mesh.positions));
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, four.mesh.triangles));
    EXPECT_TRUE(one.mesh.vertex_columns == four.mesh.vertex_columns);
    EXPECT_TRUE(one.mesh.face_columns == four.mesh.face_columns);
}

TEST(FillHoles, Progress_Ascends) {
    const TriangleMesh lower = below(geodesic_sphere(1, 12), 0.8);
    const TriangleMesh mesh = both(lower, shifted(turned(lower, std::numbers::pi, {1, 0, 0}), {0, 0, 1.9}));
    std::vector<double> seen;
    ContextOptions options;
    options.on_progress = [&](double fraction) { seen.push_back(fraction); };
    Context context(options);
    EXPECT_GT(fill_holes(mesh, {}, context).plain, 0u) << "more than one round";
    EXPECT_TRUE(std::ranges::is_sorted(seen));
    EXPECT_EQ(seen.back(), 1);
}

TEST(FillHoles, Cancelled_Ends) {
    const TriangleMesh mesh = below(geodesic_sphere(1, 12), 0.5);
    int asked = 0;
    for (const int after : {0, 1, 2, 20}) {
        ContextOptions options;
        options.is_cancelled = [&, left = after]() mutable { return ++asked, left-- <= 0; };
        Context context(options);
        EXPECT_THROW(fill_holes(mesh, {}, context), Cancelled) << after;
    }
    EXPECT_GT(asked, 20);
}

}  // namespace
}  // namespace scanmill::test
