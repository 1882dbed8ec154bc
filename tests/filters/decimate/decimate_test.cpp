// SPDX-License-Identifier: GPL-3.0-or-later
/// decimate on meshes whose results are known.
#include <gmock/gmock.h>

#include "filters/decimate/cases.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"

namespace scanmill::test {
namespace {

using std::numbers::pi;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Le;

/// Four triangles over the square [-1, 1]², whose apex is `height` above its middle.
TriangleMesh pyramid(double height) {
    return soup({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, height}},
                {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
}

TEST(Decimate, ApexOverASquare_IsRemovedIfItsHeightIsAllowed) {
    const DecimateResult flat = decimated(pyramid(0.1), 0.11);
    EXPECT_EQ(flat.mesh.triangles.size(), 2u);
    EXPECT_EQ(flat.removed, 1u);
    EXPECT_LE(flat.certificate.lower, 0.1 + 1e-12);
    EXPECT_GE(flat.certificate.upper, 0.1 - 1e-12);
    // The apex was above: the input is outside the result.
    EXPECT_NEAR(largest_in(flat.mesh, "error-outside"), 0.1, 1e-7);
    EXPECT_NEAR(largest_in(flat.mesh, "error-inside"), 0, 1e-12);
    const DecimateResult same = decimated(pyramid(0.1), 0.09);
    EXPECT_EQ(same.mesh.triangles.size(), 4u);
    EXPECT_EQ(same.removed, 0u);
    EXPECT_EQ(same.certificate.upper, 0);
}

TEST(Decimate, ApexBelowASquare_IsAnErrorInside) {
    const DecimateResult flat = decimated(pyramid(-0.1), 0.11);
    EXPECT_EQ(flat.mesh.triangles.size(), 2u);
    EXPECT_NEAR(largest_in(flat.mesh, "error-inside"), 0.1, 1e-7);
    EXPECT_NEAR(largest_in(flat.mesh, "error-outside"), 0, 1e-12);
}

TEST(Decimate, OutsideAndInside_LimitTheirDirectionOnly) {
    for (const DecimateMode mode : {DecimateMode::direct, DecimateMode::accumulated}) {
        DecimateParams params = within(0.11);
        params.mode = mode;
        params.outside = Length(0.05);
        EXPECT_EQ(decimated(pyramid(0.1), params).mesh.triangles.size(), 4u);
        EXPECT_EQ(decimated(pyramid(-0.1), params).mesh.triangles.size(), 2u);
        params.outside = {};
        params.inside = Length(0.05);
        EXPECT_EQ(decimated(pyramid(0.1), params).mesh.triangles.size(), 2u);
        EXPECT_EQ(decimated(pyramid(-0.1), params).mesh.triangles.size(), 4u);
        // The larger one may be above max-error.
        params.max_error = 0.01;
        params.outside = Length(0.2);
        EXPECT_EQ(decimated(pyramid(0.1), params).mesh.triangles.size(), 2u);
    }
}

TEST(Decimate, OfEqualVertices_TheLowerNumberGoesFirst) {
    const TriangleMesh two = both(pyramid(0.1), shifted(pyramid(0.1), Vec3(10, 0, 0)));
    DecimateParams params = within(0.11);
    params.target_triangles = 6;
    const DecimateResult result = decimated(two, params);
    EXPECT_EQ(result.removed, 1u);
    EXPECT_THAT(input_rows(two, result.mesh), ElementsAre(0, 1, 2, 3, 5, 6, 7, 8, 9));
}

TEST(Decimate, OfTwoVertices_TheFlatterGoesFirst) {
    const TriangleMesh two = both(pyramid(0.1), shifted(pyramid(0.05), Vec3(10, 0, 0)));
    DecimateParams params = within(0.11);
    params.target_triangles = 6;
    EXPECT_THAT(input_rows(two, decimated(two, params).mesh), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
}

TEST(Decimate, FlatGrid_BecomesTwoTriangles) {
    for (const double max_error : {0.0, 1e-9, 0.01})
        for (const DecimateMode mode : {DecimateMode::direct, DecimateMode::accumulated}) {
            DecimateParams params = within(max_error);
            params.mode = mode;
            const TriangleMesh flat = grid(10, 7);
            const DecimateResult result = decimated(flat, params);
            EXPECT_EQ(result.mesh.triangles.size(), 2u) << max_error;
            EXPECT_THAT(classes_of(result.mesh), ElementsAre(2, 2, 2, 2)) << max_error;
            EXPECT_LE(result.certificate.upper, 1e-12);
            EXPECT_EQ(result.creases, 0u);
            EXPECT_EQ(result.corners, 4u);
            expect_laws(flat, result, max_error);
            for (std::size_t t = 0; t < 2; ++t)
                for (std::size_t corner = 0; corner < 3; ++corner)
                    EXPECT_EQ(corner_normal(result.mesh, t, corner), Vec3(0, 0, 1));
        }
}

TEST(Decimate, CubeOfGrids_BecomesTheCube) {
    for (const DecimateMode mode : {DecimateMode::direct, DecimateMode::accumulated})
        for (const double max_error : {0.0, 1e-3}) {
            const TriangleMesh fine = gridded_cube(10);
            ASSERT_EQ(fine.positions.size(), 602u);
            DecimateParams params = within(max_error);
            params.mode = mode;
            const DecimateResult result = decimated(fine, params);
            EXPECT_EQ(result.mesh.positions.size(), 8u);
            EXPECT_EQ(result.mesh.triangles.size(), 12u);
            EXPECT_EQ(result.mesh.sharp_edges.size(), 12u);
            EXPECT_EQ(result.creases, 12u);
            EXPECT_EQ(result.corners, 8u);
            EXPECT_EQ(result.removed, 594u);
            EXPECT_THAT(classes_of(result.mesh), Each(2));
            EXPECT_LE(result.certificate.upper, 1e-12);
            expect_laws(fine, result, max_error);
            for (std::size_t t = 0; t < 12; ++t) {
                const auto& [a, b, c] = result.mesh.triangles[t];
                const Vec3& origin = result.mesh.positions[a];
                const Vec3 normal =
                    (result.mesh.positions[b] - origin).cross(result.mesh.positions[c] - origin).normalized();
                for (std::size_t corner = 0; corner < 3; ++corner)
                    EXPECT_EQ(corner_normal(result.mesh, t, corner), normal) << t;
            }
        }
}

TEST(Decimate, Sphere_IsInscribedWithFewTriangles) {
    const TriangleMesh fine = geodesic_sphere(1, 32);
    for (const double max_error : {0.003, 0.01, 0.03}) {
        const DecimateResult result = decimated(fine, max_error);
        expect_laws(fine, result, max_error);
        // No triangle with corners on the sphere that is nearer than max-error to it everywhere is larger than an
        // equilateral one: at least 4.84 R / eps of them cover the sphere.
        const double least = 4.84 / max_error;
        EXPECT_GE(static_cast<double>(result.mesh.triangles.size()), 0.9 * least) << max_error;
        EXPECT_LE(static_cast<double>(result.mesh.triangles.size()), 2 * least) << max_error;
        double nearest = 1;
        for (const auto& [a, b, c] : result.mesh.triangles)
            nearest = std::min(nearest, nearest_on_triangle(Vec3::Zero(), result.mesh.positions[a],
                                                            result.mesh.positions[b], result.mesh.positions[c])
                                            .norm());
        EXPECT_GE(nearest, 1 - max_error - 0.001);
        // The input is outside the result everywhere.
        EXPECT_GT(largest_in(result.mesh, "error-outside"), 0.5 * max_error);
        EXPECT_LE(largest_in(result.mesh, "error-inside"), 1e-12);
        EXPECT_THAT(classes_of(result.mesh), Each(0));
        EXPECT_EQ(result.mesh.sharp_edges.size(), 0u);
    }
}

TEST(Decimate, CubesOfOtherGrids_BecomeTheCube) {
    for (const int cells : {3, 8, 12, 20}) {
        const DecimateResult result = decimated(gridded_cube(cells), within(1e-3));
        EXPECT_EQ(result.mesh.positions.size(), 8u) << cells;
        EXPECT_EQ(result.mesh.triangles.size(), 12u) << cells;
    }
}

TEST(Decimate, Cylinder_KeepsItsRimsAndItsWallHasFullHeight) {
    constexpr double radius = 2, height = 3, max_error = 0.02;
    const TriangleMesh fine = cylinder(radius, height, 96, 12, 6);
    for (const DecimateMode mode : {DecimateMode::direct, DecimateMode::accumulated}) {
        DecimateParams params = with_any_angle(max_error);
        params.mode = mode;
        const DecimateResult result = decimated(fine, params);
        const TriangleMesh& mesh = result.mesh;
        expect_laws(fine, result, max_error);
        EXPECT_EQ(result.creases, 2u);
        EXPECT_EQ(result.corners, 0u);
        // Errors that accumulate keep vertices of the wall.
        if (mode == DecimateMode::accumulated) continue;
        EXPECT_THAT(classes_of(mesh), Each(1));
        std::size_t rims[2] = {};
        for (const Vec3& p : mesh.positions) {
            EXPECT_TRUE(p.z() == 0 || p.z() == height);
            EXPECT_NEAR(p.head<2>().norm(), radius, 1e-12);
            ++rims[p.z() > 0];
        }
        EXPECT_EQ(mesh.sharp_edges.size(), rims[0] + rims[1]);
        for (const auto& [a, b] : mesh.sharp_edges) {
            EXPECT_EQ(mesh.positions[a].z(), mesh.positions[b].z());
            const double half_chord = (mesh.positions[a] - mesh.positions[b]).norm() / 2;
            EXPECT_LE(radius - std::sqrt(radius * radius - half_chord * half_chord), max_error);
        }
        // Chords of r (1 - cos(pi / m)) <= max-error.
        const double least = pi / std::acos(1 - max_error / radius);
        for (const std::size_t rim : rims) EXPECT_LE(static_cast<double>(rim), 2 * least);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            std::set<double> heights;
            for (const u32 vertex : mesh.triangles[t]) heights.insert(mesh.positions[vertex].z());
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const Vec3 p = mesh.positions[mesh.triangles[t][corner]], normal = corner_normal(mesh, t, corner);
                if (heights.size() == 1) {
                    EXPECT_LE((normal - Vec3(0, 0, *heights.begin() > 0 ? 1 : -1)).norm(), 1e-12);
                } else {
                    EXPECT_NEAR(normal.z(), 0, 1e-12);
                    EXPECT_GE(normal.dot(p / radius - Vec3(0, 0, p.z() / radius)), std::cos(pi / 96));
                }
            }
        }
    }
}

TEST(Decimate, ConeOfHalfAngle45_KeepsItsApexWithoutANormal) {
    const TriangleMesh fine = cone(45, 12, 0.1);
    const DecimateResult result = decimated(fine, 0.03);
    expect_laws(fine, result, 0.03);
    const auto apex = std::ranges::find(result.mesh.positions, Vec3(0, 0, 0));
    ASSERT_NE(apex, result.mesh.positions.end());
    const auto row = static_cast<u32>(apex - result.mesh.positions.begin());
    EXPECT_EQ(classes_of(result.mesh)[row], 2);
    EXPECT_LT(result.mesh.positions.size(), fine.positions.size() / 4);
    std::size_t corners_at_the_apex = 0;
    for (std::size_t t = 0; t < result.mesh.triangles.size(); ++t)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3 normal = corner_normal(result.mesh, t, corner);
            const bool is_apex = result.mesh.triangles[t][corner] == row;
            corners_at_the_apex += is_apex;
            EXPECT_NEAR(normal.z(), is_apex ? 0 : std::sqrt(0.5), 0.05);
            EXPECT_NEAR(normal.norm(), is_apex ? 0 : 1, 1e-12);
        }
    EXPECT_GE(corners_at_the_apex, 3u);
    EXPECT_EQ(count_of(result.mesh, VertexClass::corner), 1u);
}

TEST(Decimate, SpheresAndPlanes_HaveNoApex) {
    EXPECT_EQ(decimated(geodesic_sphere(1, 7), 0).corners, 0u);
    EXPECT_EQ(decimated(bumpy_grid(20, 20, 0.1, 3), 0).corners, 4u);
}

TEST(Decimate, LargerMaxError_GivesNoMoreTriangles) {
    for (const TriangleMesh& mesh : {bumpy_sphere(16, 0.01, 1), torus(2, 0.7, 60, 30), gridded_cube(8)})
        for (const DecimateMode mode : {DecimateMode::direct, DecimateMode::accumulated}) {
            double last = static_cast<double>(mesh.triangles.size());
            for (const double max_error : {0.0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1}) {
                DecimateParams params = within(max_error);
                params.mode = mode;
                const DecimateResult result = decimated(mesh, params);
                expect_laws(mesh, result, max_error);
                const double triangles = static_cast<double>(result.mesh.triangles.size());
                EXPECT_LE(triangles, 1.02 * last) << max_error;
                last = triangles;
            }
        }
}

TEST(Decimate, MaxErrorZero_RemovesNothingFromACurvedMesh) {
    const TriangleMesh round = geodesic_sphere(1, 6);
    const DecimateResult result = decimated(round, 0);
    EXPECT_EQ(result.removed, 0u);
    EXPECT_EQ(result.certificate.upper, 0);
}

TEST(Decimate, MaxErrorLargerThanTheObject_EndsAtASmallValidMeshAndWarns) {
    for (const TriangleMesh& mesh : {geodesic_sphere(1, 8), gridded_cube(6), torus(2, 0.7, 30, 20)}) {
        const DecimateResult result = decimated(mesh, 100);
        expect_laws(mesh, result, 100);
        EXPECT_LE(result.mesh.triangles.size(), mesh.triangles.size() / 10);
        EXPECT_THAT(warnings_of_decimate(mesh, within(100)),
                    ElementsAre(HasSubstr("max-error is 100 u and the mesh's diagonal")));
    }
    const TriangleMesh flat = grid(5, 5);
    EXPECT_LE(decimated(flat, 100).mesh.triangles.size(), 2u);
    EXPECT_THAT(warnings_of_decimate(flat, within(1)), IsEmpty());
}

TEST(Decimate, Components_StayEach) {
    const TriangleMesh two = both(geodesic_sphere(1, 12), shifted(gridded_cube(8), Vec3(5, 0, 0)));
    const DecimateResult result = decimated(two, with_any_angle(0.02));
    expect_laws(two, result, 0.02);
    EXPECT_EQ(topology(result.mesh).components, 2u);
    EXPECT_EQ(result.mesh.sharp_edges.size(), 12u);
}

TEST(Decimate, ComponentSmallerThanMaxError_IsLeftAsATetrahedronOrMore) {
    const TriangleMesh two = both(geodesic_sphere(1, 8), shifted(geodesic_sphere(1e-3, 4), Vec3(5, 0, 0)));
    const DecimateResult result = decimated(two, 0.05);
    expect_laws(two, result, 0.05);
    const TriangleMesh four = regular_tetrahedron(0.01);
    EXPECT_EQ(decimated(four, 0.5).mesh.triangles.size(), 4u);
    EXPECT_EQ(decimated(both(four, shifted(four, Vec3(9, 0, 0))), 0.5).mesh.triangles.size(), 8u);
}

TEST(Decimate, OpenMesh_KeepsItsBoundaryLines) {
    // A square with a square hole: eight corners.
    MeshBuilder builder;
    for (int x = 0; x < 12; ++x)
        for (int y = 0; y < 12; ++y)
            if (x < 4 || x >= 8 || y < 4 || y >= 8)
                builder.quad(Vec3(x, y, 0), Vec3(x + 1, y, 0), Vec3(x + 1, y + 1, 0), Vec3(x, y + 1, 0));
    const TriangleMesh frame = builder.mesh();
    const DecimateResult result = decimated(frame, 0.01);
    expect_laws(frame, result, 0.01);
    EXPECT_EQ(result.mesh.positions.size(), 8u);
    EXPECT_EQ(result.mesh.triangles.size(), 8u);
    EXPECT_LE(result.certificate.upper, 1e-12);
}

TEST(Decimate, RoundBoundary_StaysWithinMaxError) {
    // The bottom of a cylinder.
    const TriangleMesh can = cylinder(1, 1, 128, 1, 16);
    Array<Triangle> bottom;
    for (const Triangle& t : can.triangles)
        if (std::ranges::all_of(t, [&](u32 v) { return can.positions[v].z() == 0; })) bottom.push_back(t);
    TriangleMesh open = can;
    open.triangles = std::move(bottom);
    open = without_unused_vertices(open);
    const DecimateResult result = decimated(open, with_any_angle(0.01));
    expect_laws(open, result, 0.01);
    EXPECT_THAT(classes_of(result.mesh), Each(3));
    std::map<Edge, int> edges;
    for (const Triangle& t : result.mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) ++edges[make_edge(t[i], t[(i + 1) % 3])];
    std::vector<Edge> boundary;
    for (const auto& [edge, triangles] : edges)
        if (triangles == 1) boundary.push_back(edge);
    for (const Vec3& p : open.positions) {
        if (p.norm() < 1 - 1e-9) continue;
        EXPECT_LE(distance_to_edges(p, result.mesh, boundary), 0.01);
    }
    EXPECT_LE(static_cast<double>(result.mesh.positions.size()), 2 * pi / std::acos(1 - 0.01));
}

TEST(Decimate, DeclaredSharpEdges_StayALineWhateverTheirAngle) {
    TriangleMesh flat = grid(12, 12);
    Array<Edge> middle;
    for (u32 a = 0; a < flat.positions.size(); ++a)
        for (u32 b = a + 1; b < flat.positions.size(); ++b) {
            const Vec3 step = flat.positions[b] - flat.positions[a];
            if (flat.positions[a].y() == 5 && std::abs(step.x()) == 1 && step.y() == 0) middle.push_back({a, b});
        }
    std::ranges::sort(middle);
    ASSERT_EQ(middle.size(), 12u);
    flat.sharp_edges = std::move(middle);
    const DecimateResult result = decimated(flat, 0.01);
    expect_laws(flat, result, 0.01);
    EXPECT_EQ(result.mesh.positions.size(), 6u);
    EXPECT_EQ(result.mesh.triangles.size(), 4u);
    ASSERT_EQ(result.mesh.sharp_edges.size(), 1u);
    for (const u32 end : result.mesh.sharp_edges[0]) EXPECT_EQ(result.mesh.positions[end].y(), 5);
    EXPECT_EQ(result.creases, 1u);
    EXPECT_EQ(result.corners, 6u);
}

TEST(Decimate, ShortDeclaredEdgeInside_IsRoughnessAndWarns) {
    TriangleMesh flat = grid(12, 12);
    const auto at = [&](double x, double y) {
        return static_cast<u32>(std::ranges::find(flat.positions, Vec3(x, y, 0)) - flat.positions.begin());
    };
    flat.sharp_edges = {make_edge(at(5, 5), at(6, 5))};
    EXPECT_EQ(decimated(flat, 0).mesh.sharp_edges.size(), 1u);
    EXPECT_EQ(decimated(flat, 0.3).mesh.sharp_edges.size(), 0u);
    EXPECT_THAT(warnings_of_decimate(flat, within(0.3)),
                ElementsAre(HasSubstr("1 of the 1 sharp edges of the mesh is treated as smooth")));
}

TEST(Decimate, SharpAngle_DecidesAtItsLimit) {
    // Two grids that meet in one line of 8 edges.
    const auto folded = [](double degrees) {
        const double angle = degrees * pi / 180;
        return with_positions(grid(8, 8), [&](const Vec3& p) -> Vec3 {
            return p.x() <= 4 ? p : Vec3(4 + (p.x() - 4) * std::cos(angle), p.y(), (p.x() - 4) * std::sin(angle));
        });
    };
    EXPECT_EQ(decimated(folded(41), 1e-3).mesh.sharp_edges.size(), 1u);
    EXPECT_EQ(decimated(folded(40), 1e-3).mesh.sharp_edges.size(), 0u) << "equal is not above";
    DecimateParams params = within(1e-3);
    params.sharp_angle = Angle::degrees(45);
    EXPECT_EQ(decimated(folded(44), params).mesh.sharp_edges.size(), 0u);
    params.sharp_angle = Angle::degrees(20);
    EXPECT_EQ(decimated(folded(30), params).mesh.sharp_edges.size(), 1u);
}

TEST(Decimate, CornerAngle_KeepsTurnsOfALine) {
    // A prism over a regular polygon with 12 corners: its rims turn by 30 degrees.
    MeshBuilder builder;
    for (u32 i = 0; i < 12; ++i)
        for (u32 k = 0; k < 4; ++k) {
            const auto at = [&](u32 part, double z) {
                const Vec3 a = on_circle(1, i, 12), b = on_circle(1, i + 1, 12);
                return part == 4 ? Vec3(b + Vec3(0, 0, z)) : Vec3(a + part / 4.0 * (b - a) + Vec3(0, 0, z));
            };
            builder.quad(at(k, 0), at(k + 1, 0), at(k + 1, 1), at(k, 1));
            builder.triangle(at(k + 1, 0), at(k, 0), Vec3(0, 0, 0));
            builder.triangle(at(k, 1), at(k + 1, 1), Vec3(0, 0, 1));
        }
    const TriangleMesh prism = builder.mesh();
    DecimateParams params = within(1e-3);
    EXPECT_EQ(decimated(prism, params).corners, 0u);
    EXPECT_EQ(decimated(prism, params).creases, 2u);
    params.corner_angle = Angle::degrees(25);
    const DecimateResult result = decimated(prism, params);
    EXPECT_EQ(result.corners, 24u);
    EXPECT_EQ(result.creases, 24u);
    EXPECT_EQ(result.mesh.positions.size(), 24u);
}

TEST(Decimate, DegenerateTriangles_AreAllowed) {
    // A vertex in the middle of an edge of a neighbour makes a triangle without area.
    TriangleMesh flat = soup({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}, {3, 3, 0}},
                             {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}});
    flat = without_unused_vertices(flat);
    const DecimateResult result = decimated(flat, 1e-6);
    expect_laws(flat, result, 1e-6);
    EXPECT_LE(result.mesh.triangles.size(), 4u);
    EXPECT_LE(result.certificate.upper, 1e-12);
}

TEST(Decimate, TargetTriangles_EndsRemovalThere) {
    const TriangleMesh fine = geodesic_sphere(1, 16);
    for (const u64 target : {4000u, 1001u, 1000u, 600u}) {
        DecimateParams params = within(0.05);
        params.target_triangles = target;
        const DecimateResult result = decimated(fine, params);
        expect_laws(fine, result, 0.05);
        EXPECT_LE(result.mesh.triangles.size(), target);
        EXPECT_GE(result.mesh.triangles.size() + 1, target);
    }
}

TEST(Decimate, TargetTriangles_AboveTheInputOrBelowTheLimit) {
    const TriangleMesh fine = geodesic_sphere(1, 10);
    DecimateParams params = within(0.05);
    params.target_triangles = 5000;
    EXPECT_EQ(decimated(fine, params).removed, 0u);
    params.target_triangles = 1;
    const DecimateResult most = decimated(fine, params);
    EXPECT_EQ(most.mesh.triangles.size(), decimated(fine, 0.05).mesh.triangles.size());
    EXPECT_LE(most.certificate.upper, 0.05);
}

TEST(Decimate, TargetTriangles_RemovesTheFlattest) {
    // A rough half and a smooth half: half the smooth vertices go before any rough one.
    Random random(2);
    const TriangleMesh mesh = with_positions(grid(40, 20), [&](const Vec3& p) -> Vec3 {
        return p + Vec3(0, 0, p.x() > 20 ? random.uniform(-0.2, 0.2) : random.uniform(-0.01, 0.01));
    });
    DecimateParams params = within(1);
    params.target_triangles = 1600 - 300;
    const DecimateResult result = decimated(mesh, params);
    std::size_t rough = 0;
    for (const Vec3& p : result.mesh.positions) rough += p.x() > 21;
    EXPECT_GT(rough, 19u * 21u * 19 / 20);
}

TEST(Decimate, FinalFlips_RaiseAnglesAndCanBeSwitchedOff) {
    // A rhombus cut along its long diagonal: angles of 18 degrees, along the other one of 37.
    const TriangleMesh rhombus = soup({{-3, 0, 0}, {0, -1, 0}, {3, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
    const auto cut = [](const DecimateResult& result) {
        std::map<u32, int> corners;
        for (const Triangle& t : result.mesh.triangles)
            for (const u32 vertex : t) ++corners[vertex];
        return corners[0];
    };
    DecimateParams params = within(0.01);
    EXPECT_EQ(decimated(rhombus, params).flips, 1u);
    EXPECT_EQ(cut(decimated(rhombus, params)), 1);
    params.final_flips = false;
    EXPECT_EQ(decimated(rhombus, params).flips, 0u);
    EXPECT_EQ(cut(decimated(rhombus, params)), 2);
    // A flip that would leave the surface does not happen: the short diagonal lies 1 above.
    const TriangleMesh folded = soup({{-3, 0, 0}, {0, -1, 1}, {3, 0, 0}, {0, 1, 1}}, {{0, 1, 2}, {0, 2, 3}});
    params.final_flips = true;
    params.sharp_angle = Angle::degrees(75);
    EXPECT_EQ(decimated(folded, params).flips, 0u);
    const TriangleMesh round = bumpy_sphere(16, 0.002, 5);
    params = within(0.01);
    params.final_flips = false;
    expect_laws(round, decimated(round, params), 0.01);
}

TEST(Decimate, MinAngle_HoldsForNewTriangles) {
    for (const bool flips : {false, true}) {
        DecimateParams params = within(0.05);
        params.min_angle = Angle::degrees(20);
        params.final_flips = flips;
        const DecimateResult result = decimated(bumpy_sphere(12, 0.01, 4), params);
        for (const Triangle& t : result.mesh.triangles)
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3& p = result.mesh.positions[t[i]];
                const Vec3 u = result.mesh.positions[t[(i + 1) % 3]] - p, v = result.mesh.positions[t[(i + 2) % 3]] - p;
                EXPECT_GE(std::atan2(u.cross(v).norm(), u.dot(v)), 19.999 * pi / 180);
            }
    }
}

TEST(Decimate, MaxValence_HoldsAlsoOnTheBoundary) {
    for (const TriangleMesh& mesh :
         {bumpy_grid(20, 20, 0.01, 6), geodesic_sphere(1, 12), gridded_cube(9), grid(15, 15)}) {
        DecimateParams params = with_any_angle(0.1);
        params.max_valence = 8;
        const DecimateResult result = decimated(mesh, params);
        std::map<u32, std::set<u32>> neighbours;
        for (const Triangle& t : result.mesh.triangles)
            for (std::size_t i = 0; i < 3; ++i) {
                neighbours[t[i]].insert(t[(i + 1) % 3]);
                neighbours[t[(i + 1) % 3]].insert(t[i]);
            }
        for (const auto& [vertex, others] : neighbours) EXPECT_LE(others.size(), 8u) << vertex;
        EXPECT_GT(result.removed, 0u);
    }
}

TEST(Decimate, TwoSheetsNearEachOther_DoNotIntersect) {
    // Alone, each of them would become flat within the error, through the other.
    const auto wavy = [](int m, int n, double height) {
        return with_positions(grid(m, n), [&](const Vec3& q) -> Vec3 {
            const Vec3 p(q.x() * 16 / m, q.y() * 4 / n, 0);
            return p + Vec3(0, 0, height + 0.1 * std::sin(0.8 * p.x()) * std::sin(pi * p.y() / 4));
        });
    };
    const TriangleMesh sheets = both(wavy(16, 4, 0), wavy(23, 7, 0.03));
    Execution execution;
    for (const double max_error : {0.03, 0.06, 0.15}) {
        const DecimateResult result = decimated(sheets, with_any_angle(max_error));
        const TriangleTree tree(result.mesh.positions.span(), result.mesh.triangles.span(), 1);
        EXPECT_EQ(self_intersections(result.mesh.positions.span(), result.mesh.triangles.span(), tree, execution).count,
                  0u);
        EXPECT_GT(result.removed, 10u);
    }
}

TEST(Decimate, NormalDeviation_KeepsWhatTurnsMore) {
    const TriangleMesh round = geodesic_sphere(1, 10);
    DecimateParams params = within(0.5);
    params.normal_deviation = Angle::degrees(1);
    const std::size_t strict = decimated(round, params).mesh.triangles.size();
    params.normal_deviation = Angle::degrees(60);
    EXPECT_GT(strict, 2 * decimated(round, params).mesh.triangles.size());
}

TEST(Decimate, OneTriangle_Stays) {
    const TriangleMesh one = soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    EXPECT_EQ(decimated(one, 0.1).mesh.triangles.size(), 1u);
}

}  // namespace
}  // namespace scanmill::test
