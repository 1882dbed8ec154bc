// SPDX-License-Identifier: GPL-3.0-or-later
// Sharp edges: straight ones exactly, curved creases, cone apexes, and creases where the mesh has folds.
#include "a_patch/refinement.hpp"
#include "filters/a_patch/sharp_cases.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::IsEmpty;

/// Largest difference of F where tetrahedra with two functions meet, sampled. Thirds beside a curved edge meet others
/// with one function, where the second one counts only away from the surface.
double value_jump(const PatchComplex& patches) {
    std::map<std::array<u32, 3>, std::vector<std::pair<u32, std::size_t>>> tets_of;
    for (u32 tet = 0; tet < patches.tets.size(); ++tet)
        for (std::size_t without = 0; without < 4; ++without) {
            if (patches.partners[tet] == PatchComplex::no_partner || patches.partners[tet] < tet) continue;
            std::array<u32, 3> face;
            for (std::size_t i = 0, n = 0; i < 4; ++i)
                if (i != without) face[n++] = patches.tets[tet][i];
            std::ranges::sort(face);
            tets_of[face].push_back({tet, without});
        }
    Random random(11);
    double jump = 0;
    for (const auto& [face, tets] : tets_of) {
        EXPECT_LE(tets.size(), 2u);
        if (tets.size() != 2) continue;
        for (int sample = 0; sample < 5; ++sample) {
            double a = random.uniform(0, 1), b = random.uniform(0, 1);
            if (a + b > 1) a = 1 - a, b = 1 - b;
            const std::array<double, 3> share{a, b, 1 - a - b};
            std::array<double, 2> value;
            for (std::size_t of = 0; of < 2; ++of) {
                Barycentric at = Barycentric::Zero();
                const auto& corners = patches.tets[tets[of].first];
                for (std::size_t i = 0; i < 3; ++i)
                    at[std::ranges::find(corners, face[i]) - corners.begin()] = share[i];
                value[of] = combined_value(patches, tets[of].first, at);
            }
            jump = std::max(jump, std::abs(value[0] - value[1]));
        }
    }
    return jump;
}

TEST(APatchSharp, ACube_IsExact) {
    for (const double angle : {0.0, 1.0}) {
        const TriangleMesh mesh = sharp_cube(angle);
        ASSERT_EQ(mesh.sharp_edges.size(), 12u);
        const PatchRun run = patched(mesh);
        expect_sound(run);
        EXPECT_THAT(run.warnings, IsEmpty());
        EXPECT_EQ(run.result.repairs.bisected + run.result.repairs.creased, 0u);
        const TriangleMesh back = turned(mesh, -angle, Vec3(1, 2, 3));
        const auto distance = [&](const Vec3& p) {
            const Vec3 q = Eigen::AngleAxisd(-angle, Vec3(1, 2, 3).normalized()) * p;
            return std::max((Vec3::Constant(0.5) - q).cwiseAbs().maxCoeff() - 0.5,
                            0.5 - (Vec3::Constant(0.5) - q).cwiseAbs().maxCoeff());
        };
        EXPECT_LT(worst_distance(run.result.patches, distance), angle == 0 ? 3e-16 : 2e-15);
        EXPECT_LT(value_jump(run.result.patches), 1e-15);
        EXPECT_LT(run.result.crease_max, 2e-15);
    }
}

TEST(APatchSharp, Cones_AreAccurateUpToTheirApex) {
    const double most[] = {8.6e-5, 1.3e-6, 2e-8};
    for (int i = 0; i < 3; ++i) {
        const PatchRun run = patched(cone(8u << i));
        expect_sound(run);
        const double worst = worst_distance(run.result.patches, [](const Vec3& p) {
            return std::min(std::abs(std::hypot(p.x(), p.y()) + p.z() - 1) / std::sqrt(2.0), std::abs(p.z()));
        });
        EXPECT_LT(worst, most[i]);
    }
}

TEST(APatchSharp, CylindersWithSharpRims_ConvergeWithTheFourthPower) {
    const double most[] = {3.2e-3, 2e-4, 1.25e-5};
    for (int i = 0; i < 3; ++i) {
        const PatchRun run = patched(cylinder(8u << i));
        expect_sound(run);
        EXPECT_EQ(run.result.repairs.bisected + run.result.repairs.creased, 0u);
        const double worst = worst_distance(run.result.patches, cylinder_distance);
        EXPECT_LT(worst, most[i]);
        EXPECT_NEAR(run.result.crease_max, 1 - std::cos(std::numbers::pi / (8u << i)), most[i]);  // sagitta
    }
}

TEST(APatchSharp, HolesAndBossesInPlates_HaveRoundRims) {
    const u32 sides[] = {8, 12, 16, 24, 32};
    const double most[] = {3.2e-3, 6.2e-4, 2.1e-4, 5.5e-5, 4e-5};
    for (int i = 0; i < 5; ++i) {
        const PatchRun hole = patched(plate_with_hole(sides[i])), boss = patched(plate_with_boss(sides[i]));
        expect_sound(hole);
        expect_sound(boss);
        const double of_hole = worst_distance(hole.result.patches, hole_distance),
                     of_boss = worst_distance(boss.result.patches, boss_distance);
        EXPECT_LT(of_hole, 3 * most[i]);  // the outer radius is 3
        EXPECT_LT(of_boss, 3 * most[i]);
        for (const PatchRun* run : {&hole, &boss}) {
            EXPECT_EQ(run->result.repairs.bisected + run->result.repairs.creased, 0u);
            EXPECT_LT(value_jump(run->result.patches), 1.3e-14);
        }
    }
}

TEST(APatchSharp, WhereNeeded_DividesTrianglesAtSharpEdges) {
    APatchParams params;
    params.split = Split::where_needed;
    const PatchRun run = patched(cylinder(16), params);
    expect_sound(run);
    EXPECT_EQ(run.result.divided, run.result.mesh.triangles.size());
    EXPECT_LT(worst_distance(run.result.patches, cylinder_distance), 2e-4);
}

TEST(APatchSharp, NormalsOfTheMesh_AreThoseOfTheSectors) {
    APatchParams params;
    params.normals = PatchNormals::mesh;
    const PatchRun run = patched(sharp_cube(), params);
    expect_sound(run);
    EXPECT_LT(worst_distance(run.result.patches,
                             [](const Vec3& p) { return (p - Vec3::Constant(0.5)).cwiseAbs().maxCoeff() - 0.5; }),
              3e-16);
}

TEST(APatchSharp, NormalsOfPoints_DoNotMixTheSidesOfAnEdge) {
    // Points on the faces of the cube; without sectors the normals at its corners would be the diagonals.
    PointCloud scan;
    Random random(2);
    Array<Vec3> points;
    for (int i = 0; i < 3000; ++i) {
        Vec3 p(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
        p[i % 3] = i / 3 % 2;
        points.push_back(p);
    }
    scan.positions = std::move(points);
    APatchParams params;
    params.normals = PatchNormals::points;
    params.fit = false;
    const PatchRun run = patched(sharp_cube(), params, &scan);
    EXPECT_LT(worst_distance(run.result.patches,
                             [](const Vec3& p) { return (p - Vec3::Constant(0.5)).cwiseAbs().maxCoeff() - 0.5; }),
              1e-9);
}

/// Two cones, base to base, so low that no direction suits both sides of the rim.
TriangleMesh lens(double height) {
    Rings rings{{}, 12};
    const auto rim = rings.ring(1, 0);
    const u32 top = rings.out.vertex(Vec3(0, 0, height)), bottom = rings.out.vertex(Vec3(0, 0, -height));
    for (u32 k = 0; k < 12; ++k) {
        rings.out.triangles.push_back({rim[k], rim[(k + 1) % 12], top});
        rings.out.triangles.push_back({rim[(k + 1) % 12], rim[k], bottom});
    }
    return soup({rings.out.positions.begin(), rings.out.positions.end()},
                {rings.out.triangles.begin(), rings.out.triangles.end()});
}

TEST(APatchSharp, AFoldWithoutADirection_BecomesSharp) {
    const PatchRun run = patched(lens(0.05));
    EXPECT_EQ(run.result.repairs.creased, 12u);
    // The rim, of which some edges are bisected.
    EXPECT_GE(run.result.mesh.sharp_edges.size(), 12u);
    for (const Edge& edge : run.result.mesh.sharp_edges)
        for (const u32 v : edge) EXPECT_LT(std::abs(run.result.mesh.positions[v].norm() - 1), 0.1);
    EXPECT_THAT(run.warnings, testing::Contains(HasSubstr("12 edges become sharp, because the mesh is folded there")));
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    EXPECT_GT(for_each_ray(run.result.patches, 5, [](u32, const Vec3&) {}), 100u);
    EXPECT_EQ(patched(lens(0.5)).result.repairs.creased, 0u) << "the axis suits no vertex of the rim, the outside does";
}

TEST(APatchSharp, OfEquallyLongEdges_TheOneWithTheLowerVerticesIsBisected) {
    for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{1, 2, 0}, Triangle{2, 0, 1}}) {
        a_patches::PatchMesh mesh;
        mesh.mesh = soup({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {t});
        const Vec3 normal = Vec3::Ones().normalized();
        mesh.normals = {{normal, normal, normal}};
        EXPECT_EQ(a_patches::bisect(mesh, std::vector<u32>{0}), 1u);
        ASSERT_EQ(mesh.mesh.positions.size(), 4u);
        EXPECT_LT((mesh.mesh.positions[3] - Vec3(0.5, 0.5, 0)).norm(), 1e-15);
    }
}

TEST(APatchSharp, TwoSharpEdgesThatMeetAtARightAngle_AreCreasesInThePlaneOfTheirFace) {
    // A cube whose top and bottom are sharp, and whose sides form one smooth wall: two sharp edges at each corner.
    TriangleMesh mesh = sharp_cube();
    const auto is_level = [&](const Edge& e) { return mesh.positions[e[0]].z() == mesh.positions[e[1]].z(); };
    Array<Edge> level;
    std::ranges::copy_if(mesh.sharp_edges, std::back_inserter(level), is_level);
    ASSERT_EQ(level.size(), 8u);
    mesh.sharp_edges = std::move(level);
    mesh.face_columns = {};
    const PatchRun run = patched(mesh);
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    EXPECT_EQ(run.result.repairs.smoothed, 0u);
    EXPECT_GE(run.result.mesh.sharp_edges.size(), 8u);
    Execution execution;
    const TriangleMesh fine = tessellate(run.result.patches, {8, {}}, execution);
    EXPECT_TRUE(topology(fine).closed);
    EXPECT_EQ(topology(fine).euler, 2);
    ASSERT_GT(fine.sharp_edges.size(), 8u);
    for (const Edge& edge : fine.sharp_edges)
        for (const u32 v : edge) {
            const double z = fine.positions[v].z();
            EXPECT_LT(std::min(std::abs(z), std::abs(z - 1)), 1e-12);
        }
}

TEST(APatchSharp, SharpEdgesOfASmoothSurface_BecomeSmoothAndCostNoAccuracy) {
    // Single edges, forks and ends on a sphere, where both sides have one normal.
    TriangleMesh mesh = exact_sphere(2);
    Random random(3);
    std::vector<Edge> edges;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            if (t[i] < t[(i + 1) % 3] && random.uniform() < 0.15) edges.push_back(make_edge(t[i], t[(i + 1) % 3]));
    ASSERT_GT(edges.size(), 10u);
    std::ranges::sort(edges);
    mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
    const PointCloud points = random_sphere(5000, 5);
    for (const PointCloud* cloud : {static_cast<const PointCloud*>(nullptr), &points}) {
        const PatchRun run = patched(mesh, {}, cloud);
        EXPECT_EQ(run.result.inverted, 0u);
        EXPECT_EQ(run.result.sign_violations, 0u);
        EXPECT_EQ(run.result.loosened, 0u);
        EXPECT_EQ(run.result.repairs.smoothed, edges.size());
        EXPECT_TRUE(run.result.mesh.sharp_edges.empty());
        EXPECT_THAT(run.warnings, testing::Contains(HasSubstr("sharp edges become smooth")));
        Execution execution;
        const TriangleMesh fine = tessellate(run.result.patches, {8, {}}, execution);
        EXPECT_TRUE(topology(fine).closed);
        EXPECT_EQ(topology(fine).euler, 2);
        // The bound of the sphere without sharp edges.
        for (const Vec3& p : fine.positions) EXPECT_LT(std::abs(sphere_distance(p)), 0.0024);
    }
}

TEST(APatchSharp, ContradictoryNormalsAtAVertex_GetTheirMeanWithAWarning) {
    TriangleMesh mesh = exact_sphere(2);
    const auto given = mesh.face_columns.find("corner-normals")->values<double>();
    Array<double> normals(given.begin(), given.end());
    const u32 v = mesh.triangles[0][0];
    const Vec3 along = mesh.positions[v].unitOrthogonal();
    double sign = 0.3;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i)
            if (mesh.triangles[f][i] == v) {
                const Vec3 turned = (mesh.positions[v].normalized() + sign * along).normalized();
                std::copy_n(turned.data(), 3, normals.data() + 9 * f + 3 * i);
                sign = -sign;
            }
    mesh.face_columns = {};
    mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(normals))));
    const PatchRun run = patched(mesh);
    EXPECT_THAT(
        run.warnings,
        testing::Contains(HasSubstr("at 1 vertex the corner normals differ although no sharp edge separates them")));
    expect_sound(run);
}

TEST(APatchSharp, TrianglesFoldedOntoEachOther_ShareASharpEdge) {
    const PatchRun run = patched(soup({{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 1.1, 1e-3}}, {{0, 1, 2}, {1, 0, 3}}));
    ASSERT_EQ(run.result.mesh.sharp_edges.size(), 1u);
    EXPECT_EQ(run.result.mesh.sharp_edges[0], make_edge(0, 1));
    EXPECT_EQ(run.result.inverted, 0u);
}

TEST(APatchSharp, AnEdgeWhoseSidesAgree_StaysWithinALine_AndIsSmoothAtItsEnd) {
    // The twelve edges of the cube, and a diagonal of one of its faces, whose sides have one normal.
    a_patches::PatchMesh mesh;
    mesh.mesh = sharp_cube();
    const std::vector<Vec3> of_triangles = a_patches::triangle_normals(mesh.mesh);
    for (const Vec3& n : of_triangles) mesh.normals.push_back({n, n, n});
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    std::vector<Edge> edges(mesh.mesh.sharp_edges.begin(), mesh.mesh.sharp_edges.end());
    for (u32 half = 0; half < opposites.size(); ++half)
        if (half < opposites[half] && of_triangles[half / 3].dot(of_triangles[opposites[half] / 3]) > 0.5) {
            edges.push_back(make_edge(half_edges::start(mesh.mesh, half), half_edges::end(mesh.mesh, half)));
            break;
        }
    ASSERT_EQ(edges.size(), 13u);
    std::ranges::sort(edges);
    a_patches::PatchMesh with_diagonal = mesh;
    with_diagonal.mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
    a_patches::Repairs repairs;
    a_patches::smooth_agreeing_edges(with_diagonal, repairs);
    EXPECT_EQ(repairs.smoothed, 0u) << "both ends of the diagonal are on lines that continue";
    // Without the other edges, the diagonal is not in a line.
    for (const Edge& edge : edges)
        if (!std::ranges::binary_search(mesh.mesh.sharp_edges, edge)) with_diagonal.mesh.sharp_edges = {edge};
    a_patches::smooth_agreeing_edges(with_diagonal, repairs);
    EXPECT_EQ(repairs.smoothed, 1u);
    EXPECT_TRUE(with_diagonal.mesh.sharp_edges.empty());
}

TEST(APatchSharp, AnEdgeWhoseCreaseLeavesIt_IsOpen_AndGivenNormalsAreKept) {
    // One edge of a cube's top, whose normals are turned along the edge by 45 degrees, in opposite directions.
    TriangleMesh mesh = sharp_cube();
    const std::vector<Vec3> of_triangles = a_patches::triangle_normals(mesh);
    const Edge edge = mesh.sharp_edges[0];
    const Vec3 along = (mesh.positions[edge[1]] - mesh.positions[edge[0]]).normalized();
    Array<double> normals;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        for (const u32 v : mesh.triangles[f]) {
            Vec3 n = of_triangles[f];
            const bool is_beside = std::abs(n.dot(along)) < 0.5;
            if (is_beside && v == edge[0]) n = (n + along).normalized();
            if (is_beside && v == edge[1]) n = (n + along).normalized();
            normals.insert(normals.end(), n.data(), n.data() + 3);
        }
    mesh.face_columns = {};
    mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(normals))));
    const PatchRun run = patched(mesh);
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    EXPECT_EQ(run.result.repairs.replaced, 0u);
    EXPECT_GT(run.result.repairs.opened, 0u);
    EXPECT_EQ(metric_of(run, "straight-edges"), static_cast<double>(run.result.repairs.opened));
    Execution execution;
    EXPECT_TRUE(topology(tessellate(run.result.patches, {8, {}}, execution)).closed);
}

/// Vertices moved along the torus by almost the spacing fold it.
PatchRun folded_torus() {
    Random random(1);
    return patched(with_positions(torus(1, 0.4, 24, 12), [&](const Vec3& p) -> Vec3 {
        return p + 0.2 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    }));
}

TEST(APatchSharp, WhereNoSmoothSurfaceFits_ItFollowsTheMesh) {
    const PatchRun run = folded_torus();
    const a_patches::Repairs& repairs = run.result.repairs;
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    EXPECT_LT(run.result.c1_jump, 1e-9);
    EXPECT_EQ(metric_of(run, "creased-edges"), static_cast<double>(repairs.creased));
    EXPECT_EQ(metric_of(run, "pointed-vertices"), static_cast<double>(run.result.loosened));
    EXPECT_EQ(metric_of(run, "flat-triangles"), static_cast<double>(repairs.flattened));
    EXPECT_GT(repairs.creased, 0u);
    EXPECT_GT(run.result.loosened, 0u);
    EXPECT_GT(repairs.flattened, 0u);
    EXPECT_THAT(run.warnings, testing::Contains(testing::AllOf(HasSubstr("no smooth surface fits at"),
                                                               HasSubstr("the surface follows the mesh at"))));
}

TEST(APatchSharp, AFlatTriangle_IsTheSurface) {
    const PatchRun run = folded_torus();
    std::size_t flat = 0;
    const PatchComplex& patches = run.result.patches;
    for (u32 row = 0; row < patches.tets.size(); ++row) {
        if (patches.kinds[row] != PatchKind::face || !run.result.flat[patches.triangles[row]]) continue;
        ++flat;
        for (const Barycentric& at : {Barycentric(0.3, 0.3, 0.4, 0), Barycentric(0.2, 0.7, 0.1, 0)})
            EXPECT_LT(std::abs(patch_value(patches.weights[row], at)), 1e-12);
    }
    EXPECT_GT(flat, 0u);
}

}  // namespace
}  // namespace scanmill
