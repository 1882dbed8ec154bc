// SPDX-License-Identifier: GPL-3.0-or-later
// Fits through the vertices of the mesh: recovered surfaces, errors of known shapes, outliers, and what fitting must
// not change.
#include "a_patch/fit.hpp"

#include <limits>
#include <memory>

#include "a_patch/block_system.hpp"
#include "a_patch/normals.hpp"
#include "a_patch/outliers.hpp"
#include "a_patch/slope_dependence.hpp"
#include "filters/a_patch/sharp_cases.hpp"
#include "support/point_sets.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

PointCloud cloud(Array<Vec3> positions) {
    PointCloud points;
    points.positions = std::move(positions);
    return points;
}

/// Points of the unit sphere.
PointCloud sphere_points(std::size_t count) { return random_sphere(count, 5); }

Vec3 torus_point(double u, double v) {
    const Vec3 out(std::cos(u), std::sin(u), 0);
    return out + 0.4 * (std::cos(v) * out + std::sin(v) * Vec3::UnitZ());
}
PointCloud torus_points(std::size_t count, double noise = 0) {
    Random random(5);
    Array<Vec3> positions;
    while (positions.size() < count) {
        const double u = random.uniform(0, 2 * std::numbers::pi), v = random.uniform(0, 2 * std::numbers::pi);
        if (random.uniform(0, 1.4) > 1 + 0.4 * std::cos(v)) continue;  // equally many per area
        positions.push_back(torus_point(u, v) +
                            noise * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    }
    return cloud(std::move(positions));
}

/// Radii 1 and 0.4, vertices moved along the torus by up to `share` of the spacing; the normals are those of the mesh.
TriangleMesh irregular_torus(u32 around, u32 along, double share, std::uint64_t seed = 1) {
    TriangleMesh mesh = exact_torus(around, along);
    mesh.face_columns = {};
    Random random(seed);
    Array<Vec3> positions;
    for (u32 i = 0; i < around; ++i)
        for (u32 j = 0; j < along; ++j) {
            const double u = i + random.uniform(-share, share), v = j + random.uniform(-share, share);
            positions.push_back(torus_point(2 * std::numbers::pi * u / around, 2 * std::numbers::pi * v / along));
        }
    mesh.positions = std::move(positions);
    return mesh;
}

/// A torus whose outermost circle is a crease: the normals on its sides are those of the mesh, and differ.
TriangleMesh creased_torus(u32 around, u32 along) {
    TriangleMesh mesh = exact_torus(around, along);
    mesh.face_columns = {};
    std::vector<Edge> rim;
    for (u32 i = 0; i < around; ++i) rim.push_back(make_edge(i * along, (i + 1) % around * along));
    std::ranges::sort(rim);
    mesh.sharp_edges = Array<Edge>(rim.begin(), rim.end());
    return mesh;
}

/// Normals of the mesh unless it has corner-normals: not of the points.
APatchParams params_for(const TriangleMesh& mesh) {
    APatchParams params;
    params.normals = mesh.face_columns.find("corner-normals") ? PatchNormals::given : PatchNormals::mesh;
    return params;
}
PatchRun fitted(const TriangleMesh& mesh, const PointCloud& points, unsigned threads = 1) {
    return patched(mesh, params_for(mesh), &points, threads);
}
PatchRun by_default(const TriangleMesh& mesh, const PointCloud* points = nullptr) {
    APatchParams params = params_for(mesh);
    params.fit = false;
    return patched(mesh, params, points);
}

void expect_same_bits(const PatchComplex& one, const PatchComplex& other) {
    EXPECT_TRUE(std::ranges::equal(one.positions, other.positions));
    EXPECT_TRUE(std::ranges::equal(one.tets, other.tets));
    EXPECT_TRUE(std::ranges::equal(one.weights, other.weights));
}

void expect_sound(const APatchResult& result) {
    const auto [value, gradient] = errors_at_vertices(result);
    EXPECT_LT(value, 1e-13);
    EXPECT_LT(gradient, 1e-11);
    EXPECT_LT(joints_of(result.patches).gradient, 1e-10);
    EXPECT_LT(result.c1_jump, 1e-10);
    EXPECT_EQ(result.inverted, 0u);
    EXPECT_EQ(result.sign_violations, 0u);
}

double rms(const std::vector<double>& values) {
    double squares = 0;
    for (const double v : values) squares += v * v;
    return std::sqrt(squares / static_cast<double>(values.size()));
}

/// Root mean square distance over the surface's points above the triangles.
template <class Distance>
double rms_distance(const PatchComplex& patches, Distance&& distance) {
    std::vector<double> found;
    for_each_ray(patches, 20, [&](u32, const Vec3& p) { found.push_back(distance(p)); });
    return rms(found);
}

/// The default hull and weights of a mesh; the hull refers to `mesh`.
struct DefaultPatches {
    a_patches::PatchMesh mesh;
    a_patches::Hull hull;
    a_patches::Weights weights;
};
std::unique_ptr<DefaultPatches> default_patches(const TriangleMesh& mesh, Split split = Split::always) {
    auto result = std::make_unique<DefaultPatches>();
    const APatchResult built = patched(mesh, Curvature::distance, split).result;
    result->mesh.mesh = built.mesh;
    const Column* normals = built.mesh.face_columns.find("corner-normals");
    for (std::size_t f = 0; f < built.mesh.triangles.size(); ++f) {
        auto& corners = result->mesh.normals.emplace_back();
        for (u32 i = 0; i < 3; ++i)
            corners[i] = Vec3(normals->number(f, 3 * i), normals->number(f, 3 * i + 1), normals->number(f, 3 * i + 2));
    }
    Execution execution;
    result->hull = make_hull(result->mesh, 1.5, split, execution);
    result->weights = make_weights(result->hull, Curvature::distance, execution);
    return result;
}
const auto no_violation = [](const PatchComplex&) { return std::vector<u32>(); };

// Derivatives.

TEST(APatchFit, DerivativesBySlopes_AreTheDifferencesOfWeights) {
    for (const Split split : {Split::always, Split::where_needed})
        for (const TriangleMesh& mesh :
             {exact_torus(12, 6), without_triangles(geodesic_sphere(1, 2), {0}), creased_torus(24, 12)}) {
            const auto base = default_patches(mesh, split);
            const std::vector<a_patches::Directions> free = free_directions(base->hull);
            Random random(3);
            Execution execution;
            std::array<double, 4> largest{};  // by kind
            for (u32 e = 0; e < base->hull.edges.size(); e += 5)
                for (const int component : {0, 1}) {
                    a_patches::Hull hull = base->hull;
                    const double change = 0.01;  // F is affine: any change is exact, unless a weight is raised
                    for (Vec3& slope : hull.edges[e].slopes) slope += change * free[e].col(component);
                    const a_patches::Weights weights = make_weights(hull, Curvature::distance, execution);
                    ASSERT_EQ(weights.raised + base->weights.raised, 0u);
                    for (u32 tet = 0; tet < weights.patches.tets.size(); ++tet) {
                        Barycentric at;
                        for (int i = 0; i < 4; ++i) at[i] = random.uniform(0, 1);
                        at /= at.sum();
                        const double found = (patch_value(weights.patches.weights[tet], at) -
                                              patch_value(base->weights.patches.weights[tet], at)) /
                                             change;
                        const a_patches::SlopeDependence dependence(base->hull, free, base->weights.patches, tet);
                        const auto derivatives = dependence.derivatives(at);
                        double expected = 0;
                        for (std::size_t n = 0; n < dependence.count(); ++n)
                            if (dependence.edge(n) == e) expected += derivatives[n][component];
                        ASSERT_NEAR(found, expected, 1e-12);
                        double& most = largest[static_cast<std::size_t>(weights.patches.kinds[tet])];
                        most = std::max(most, std::abs(expected));
                    }
                }
            EXPECT_GT(largest[0], 0.001);
            EXPECT_GT(largest[1], 0.001);
            if (!mesh.sharp_edges.empty()) {
                EXPECT_GT(largest[2], 1e-4);
            }
            EXPECT_EQ(largest[3], 0);
        }
}

// What points decide.

TEST(APatchFit, ASurfaceOfOtherSlopes_IsFoundAgainFromItsPoints) {
    // The surface has slopes that differ from the default by up to 2 %, and the points are exactly on it.
    const auto base = default_patches(exact_torus(12, 6));
    const std::vector<a_patches::Directions> free = free_directions(base->hull);
    a_patches::Hull hull = base->hull;
    Random random(4);
    Execution execution;
    for (u32 e = 0; e < hull.edges.size(); ++e)
        hull.edges[e].slopes.fill(hull.edges[e].slopes[0] +
                                  free[e] * Eigen::Vector2d(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02)));
    const a_patches::Weights truth = make_weights(hull, Curvature::distance, execution);
    ASSERT_EQ(truth.raised, 0u);
    Array<Vec3> points;
    for_each_ray(truth.patches, 100, [&](u32, const Vec3& p) { points.push_back(p); });
    const a_patches::LocatedPoints located =
        a_patches::locate(base->weights.patches, std::span<const Vec3>(points), execution);
    EXPECT_EQ(located.left_out, 0u);
    a_patches::Hull found = base->hull;
    const a_patches::Weights weights =
        fit(found, base->weights, located, Curvature::distance, {1e-9}, no_violation, execution).weights;
    double before = 0, after = 0;
    for (u32 tet = 0; tet < weights.patches.tets.size(); ++tet)
        for (std::size_t i = 0; i < 20; ++i) {
            before = std::max(before, std::abs(base->weights.patches.weights[tet][i] - truth.patches.weights[tet][i]));
            after = std::max(after, std::abs(weights.patches.weights[tet][i] - truth.patches.weights[tet][i]));
        }
    EXPECT_GT(before, 1e-3);
    EXPECT_LT(after, 1e-2 * before);
    EXPECT_LT(rms(distances(found, weights.patches, points, located, execution).to_surface), 1e-7);
}

TEST(APatchFit, OfASphere_TheErrorFallsToATenth) {
    const TriangleMesh mesh = exact_sphere(2);
    const PatchRun run = fitted(mesh, sphere_points(5000));
    expect_sound(run.result);
    EXPECT_GT(worst_distance(by_default(mesh).result.patches, sphere_distance), 2.2e-3);
    EXPECT_LT(worst_distance(run.result.patches, sphere_distance), 2.6e-4);
}

TEST(APatchFit, OfATorus_TheErrorFallsToATenth) {
    const TriangleMesh mesh = exact_torus(12, 6);
    const PatchRun run = fitted(mesh, torus_points(5000));
    expect_sound(run.result);
    const double before = rms_distance(by_default(mesh).result.patches, torus_distance);
    EXPECT_LT(rms_distance(run.result.patches, torus_distance), 0.1 * before);
    EXPECT_LT(worst_distance(run.result.patches, torus_distance), 2.4e-3);  // from 7.3e-3
}

TEST(APatchFit, OfIrregularToriWithNormalsOfTheMesh_TheErrorFallsToHalf) {
    for (std::uint64_t seed = 1; seed < 5; ++seed) {
        const TriangleMesh mesh = irregular_torus(24, 12, 0.25, seed);
        const PatchRun before = by_default(mesh), after = fitted(mesh, torus_points(6000));
        expect_sound(after.result);
        EXPECT_LT(rms_distance(after.result.patches, torus_distance),
                  0.55 * rms_distance(before.result.patches, torus_distance));
    }
}

TEST(APatchFit, SlopesAtTheirLimits_AreTheBestTogether) {
    // Shortened one by one, or limited by the signs of the weights alone, they leave more of the distance.
    const TriangleMesh mesh = irregular_torus(24, 12, 0.25);
    const PointCloud points = torus_points(50'000);
    EXPECT_LT(fitted(mesh, points).result.fit->rms, 0.35 * by_default(mesh, &points).result.fit->rms);
}

TEST(APatchFit, OfVeryIrregularTori_AllSignsStayRight) {
    for (std::uint64_t seed = 1; seed < 5; ++seed) {
        const TriangleMesh mesh = irregular_torus(24, 12, 0.3, seed);
        const PatchRun before = by_default(mesh), after = fitted(mesh, torus_points(50'000));
        EXPECT_EQ(before.result.sign_violations, 0u) << seed;
        EXPECT_EQ(after.result.sign_violations, 0u) << seed;
    }
}

TEST(APatchFit, Distances_AreThoseOfFootPoints) {
    const TriangleMesh mesh = exact_torus(12, 6);
    const PointCloud points = torus_points(3000, 0.01);
    const PatchRun run = fitted(mesh, points);
    const PatchSurface surface(run.result.patches);
    std::vector<double> found;
    for (const Vec3& p : points.positions)
        if (const auto foot = surface.foot(p)) found.push_back(std::abs(foot->distance));
    ASSERT_GT(found.size(), 2990u);
    std::ranges::sort(found);
    EXPECT_NEAR(metric_of(run, "fit-rms"), rms(found), 1e-3 * rms(found));
    EXPECT_NEAR(metric_of(run, "fit-p95"), found[found.size() * 95 / 100], 0.01 * found.back());
    EXPECT_NEAR(metric_of(run, "fit-max"), found.back(), 0.01 * found.back());
}

TEST(APatchFit, OutliersOfOnePercent_ChangeTheOthersLittle) {
    const TriangleMesh mesh = exact_torus(24, 12);
    // As if the mesh were decimated within this distance.
    const double max_error = 0.01;
    const PointCloud points = torus_points(20'000, 1e-4);
    const auto rms_of_others = [&](const PatchComplex& patches) {
        const PatchSurface surface(patches);
        std::vector<double> found;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (i % 100 != 0) {
                const auto foot = surface.foot(points.positions[i]);
                if (foot) found.push_back(foot->distance);
            }
        EXPECT_GT(found.size(), 19'700u);
        return rms(found);
    };
    const double before = rms_of_others(fitted(mesh, points).result.patches);
    Random random(6);
    Array<Vec3> positions(points.positions.begin(), points.positions.end());
    for (std::size_t i = 0; i < positions.size(); i += 100) {
        Vec3 direction;
        do direction = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        while (direction.norm() > 1);
        positions[i] += 5 * max_error * direction.normalized();
    }
    const PatchRun disturbed = fitted(mesh, cloud(std::move(positions)));
    EXPECT_LT(disturbed.result.left_out, 200u);  // some of them count
    EXPECT_LT(rms_of_others(disturbed.result.patches), 1.1 * before);
}

TEST(APatchFit, FewNoisyPoints_DoNotMakeAGoodSurfaceWorse) {
    // The default surface is within 3e-4 (rms) of the torus, the points within 1.1e-3: 3.5 of them per triangle.
    const TriangleMesh mesh = exact_torus(24, 12);
    const PatchRun noisy = fitted(mesh, torus_points(2000, 2e-3));
    EXPECT_GE(metric_of(noisy, "regularisation"), 1);
    EXPECT_LT(rms_distance(noisy.result.patches, torus_distance),
              rms_distance(by_default(mesh).result.patches, torus_distance));
    const PatchRun exact = fitted(mesh, torus_points(50'000));
    EXPECT_EQ(metric_of(exact, "regularisation"), 1e-3);
}

TEST(APatchFit, NoisyPointsOnOneSide_KeepTheSignsOfAllWeights) {
    // All points are far to one side, so the slopes reach their limits.
    const TriangleMesh mesh = geodesic_sphere(1, 4);
    for (const double radius : {0.97, 1.03}) {
        const PointCloud points = moved(sphere_points(5000), radius);
        const PatchRun run = fitted(mesh, points);
        expect_sound(run.result);
        EXPECT_GT(for_each_ray(run.result.patches, 4, [](u32, const Vec3&) {}), 1000u);
        EXPECT_LT(run.result.fit->rms, by_default(mesh, &points).result.fit->rms);
    }
}

// Parts.

TEST(BestWeights, OfSignalAndNoise_AreTheLeastAndTheGreatest) {
    // Unconnected rows. Both halves agree on the first 10, contradict each other on the next 10, and the rest is empty.
    constexpr u32 size = 30;
    std::vector<std::pair<u32, u32>> pairs;
    for (u32 row = 0; row < size; ++row) pairs.emplace_back(row, row);
    std::array halves{a_patches::BlockSystem(size, pairs), a_patches::BlockSystem(size, pairs)};
    for (u32 half = 0; half < 2; ++half)
        for (u32 row = 0; row < 20; ++row) {
            halves[half].block(row, row) = Eigen::Matrix2d::Identity();
            halves[half].right(row) = (row >= 10 && half == 1 ? -1 : 1) * Eigen::Vector2d(1, 2);
        }
    const std::vector<double> weights{0.01, 0.1, 1, 10};
    Execution execution;
    const std::vector<double> found = best_weights(
        halves, 100'000, weights, [](a_patches::BlockSystem& half, double weight) { half.add_to_diagonal(weight); },
        [](std::vector<Eigen::Vector2d>&) {}, execution);
    for (u32 row = 0; row < size; ++row) EXPECT_EQ(found[row], row >= 10 && row < 20 ? 10 : 0.01) << row;
}

TEST(OutlierDistances, ByHand) {
    // Triangles 0 and 1 are neighbours, 2 has none, 3 has no points. Of an even number the lower one in the middle.
    constexpr u32 none = ~u32(0);
    const std::vector<double> distances{5, 1, 2, a_patches::no_distance, 4, 7};
    const std::vector<u32> triangles{0, 0, 1, 1, 1, 2};
    const std::vector<std::array<u32, 3>> neighbours{
        {1, none, none}, {0, none, none}, {none, none, none}, {none, none, none}};
    EXPECT_THAT(a_patches::outlier_distances(distances, triangles, neighbours), ElementsAre(6, 6, 21, 0));
}

TEST(MostNormal, ByHand) {
    using a_patches::most_normal;
    const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
    const auto of = [](std::vector<Vec3> normals) { return most_normal(normals); };
    EXPECT_EQ(of({z}), z);
    EXPECT_LT((of({x, y}) - Vec3(1, 1, 0).normalized()).norm(), 1e-15);
    EXPECT_LT((of({x, y, z}) - Vec3(1, 1, 1).normalized()).norm(), 1e-15);
    EXPECT_LT((of({x, y, Vec3(1, 1, 0.1).normalized()}) - Vec3(1, 1, 0).normalized()).norm(), 0.1);
    EXPECT_LT((of({x, -x, y, -y, z}) - z).norm(), 1e-15) << "all but one are perpendicular to it";
}

TEST(MostNormal, OfManyNormals_HasTheGreatestLeastCosine) {
    Random random(8);
    for (int round = 0; round < 20; ++round) {
        std::vector<Vec3> normals;
        for (int i = 0; i < 40; ++i)
            normals.push_back(
                Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.2 * round / 5, 1)).normalized());
        const auto least = [&](const Vec3& direction) {
            double smallest = 1;
            for (const Vec3& n : normals) smallest = std::min(smallest, n.dot(direction));
            return smallest;
        };
        const double found = least(a_patches::most_normal(normals));
        // One, two or three of the normals decide.
        double greatest = -1;
        for (std::size_t i = 0; i < normals.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j) {
                const Vec3 sum = normals[i] + normals[j];
                if (sum.norm() > 0) greatest = std::max(greatest, least(sum.normalized()));
                for (std::size_t k = 0; k < j; ++k) {
                    const Vec3 across = (normals[i] - normals[j]).cross(normals[j] - normals[k]).normalized();
                    if (across == Vec3::Zero()) continue;
                    greatest = std::max({greatest, least(across), least(-across)});
                }
            }
        EXPECT_NEAR(found, greatest, 1e-13);
    }
    // The apex of a cone: all are equally far from the axis.
    std::vector<Vec3> cone;
    for (int i = 0; i < 5000; ++i)
        cone.push_back(
            Vec3(std::cos(2 * std::numbers::pi * i / 5000), std::sin(2 * std::numbers::pi * i / 5000), 1).normalized());
    EXPECT_LT((a_patches::most_normal(cone) - Vec3::UnitZ()).norm(), 1e-10);
}

// What fitting must not change.

TEST(APatchFit, WithoutPoints_NothingChanges) {
    const TriangleMesh mesh = exact_torus(24, 12);
    const PatchRun run = patched(mesh, params_for(mesh));
    expect_same_bits(run.result.patches, by_default(mesh).result.patches);
    EXPECT_THAT(run.warnings, IsEmpty());
    EXPECT_FALSE(run.result.fit);
    EXPECT_EQ(metric_of(run, "left-out"), 0);
    EXPECT_TRUE(std::isnan(metric_of(run, "regularisation")));
}

TEST(APatchFit, AnEmptyCloud_IsAsNone) {
    // If a mesh has no corner-normals, the points give the normals.
    TriangleMesh mesh = exact_torus(12, 6);
    mesh.face_columns = {};
    const PointCloud none;
    const PatchRun run = patched(mesh, {}, &none);
    expect_same_bits(run.result.patches, patched(mesh).result.patches);
    EXPECT_THAT(run.warnings, ElementsAre("the input `points` is empty: the surface is not fitted"));
}

TEST(APatchFit, Off_ReportsNoRegularisation_AndThatNothingIsMeasured) {
    const TriangleMesh mesh = exact_torus(12, 6);
    const PointCloud points = torus_points(500), far = cloud({{9, 0, 0}});
    const PatchRun measured = by_default(mesh, &points);
    EXPECT_GT(metric_of(measured, "fit-rms"), 0);
    EXPECT_TRUE(std::isnan(metric_of(measured, "regularisation")));
    EXPECT_THAT(
        by_default(mesh, &far).warnings,
        ElementsAre("1 of 1 point is in no tetrahedron near the surface and does not count; check that the mesh and "
                    "the points show the same object in the same position"));
}

TEST(APatchFit, ASurfaceFartherFromThePointsThanItsMesh_IsDoubtful) {
    // Normals that are 45 degrees off bend the surface away from the sphere that its vertices are on.
    TriangleMesh mesh = geodesic_sphere(1, 4);
    Random random(4);
    std::vector<Vec3> normals;
    for (const Vec3& p : mesh.positions) {
        const Vec3 side = p.cross(Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        normals.push_back((p + side.normalized()).normalized());
    }
    mesh = with_normals(mesh, normals);
    const PointCloud points = sphere_points(5000);
    const PatchRun run = by_default(mesh, &points);
    EXPECT_GT(run.result.fit->rms, run.result.fit->rms_to_mesh);
    EXPECT_THAT(run.warnings,
                testing::Contains(fmt::format(
                    "the points are farther from the surface (rms {:.3g} u) than from the mesh (rms {:.3g} u)",
                    run.result.fit->rms, run.result.fit->rms_to_mesh)));
    APatchParams params;
    params.interpolate = APatchParams::Interpolate::yes;
    const PatchRun fitted = patched(mesh, params, &points);
    EXPECT_LT(fitted.result.fit->rms, 0.2 * fitted.result.fit->rms_to_mesh);
    EXPECT_THAT(fitted.warnings, testing::Not(testing::Contains(HasSubstr("farther from the surface"))));
}

TEST(APatchFit, WithoutPointsInReach_TheBitsAreTheDefaults) {
    const TriangleMesh mesh = exact_torus(12, 6);
    const PatchRun far = fitted(mesh, cloud({{9, 0, 0}, {0, 9, 0}, {0, 0, 0}}));
    expect_same_bits(far.result.patches, by_default(mesh).result.patches);
    EXPECT_EQ(metric_of(far, "left-out"), 3);
    EXPECT_THAT(
        far.warnings,
        ElementsAre("3 of 3 points are in no tetrahedron near the surface and do not count in the fit; check that the "
                    "mesh and the points show the same object in the same position"));
    const PatchRun empty = fitted(mesh, PointCloud{});
    expect_same_bits(empty.result.patches, by_default(mesh).result.patches);
    EXPECT_THAT(empty.warnings, ElementsAre("the input `points` is empty: the surface is not fitted"));
}

TEST(APatchFit, EdgesAwayFromAllPoints_KeepTheirBits) {
    const TriangleMesh mesh = exact_sphere(4);
    Array<Vec3> above;
    for (const Vec3& p : sphere_points(20'000).positions)
        if (p.z() > 0.5) above.push_back(p);
    const PatchRun run = fitted(mesh, cloud(std::move(above)));
    const PatchComplex &found = run.result.patches, before = by_default(mesh).result.patches;
    std::size_t same = 0, others = 0;
    for (u32 tet = 0; tet < found.tets.size(); ++tet) {
        const bool is_far = std::ranges::all_of(found.tets[tet], [&](u32 v) { return found.positions[v].z() < 0; });
        if (is_far) {
            EXPECT_EQ(found.weights[tet], before.weights[tet]);
            ++same;
        } else {
            others += found.weights[tet] != before.weights[tet];
        }
    }
    EXPECT_GT(same, 1000u);
    EXPECT_GT(others, 500u);
}

TEST(APatchFit, AllPointsOnOneTriangle_ChangeItsSurroundingsOnly) {
    const TriangleMesh mesh = exact_sphere(2);
    const Triangle& t = mesh.triangles[17];
    Random random(2);
    Array<Vec3> points;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 share = Vec3(random.uniform(0.05, 1), random.uniform(0.05, 1), random.uniform(0.05, 1));
        points.push_back(
            (share[0] * mesh.positions[t[0]] + share[1] * mesh.positions[t[1]] + share[2] * mesh.positions[t[2]])
                .normalized());
    }
    const PatchRun run = fitted(mesh, cloud(std::move(points)));
    expect_sound(run.result);
    EXPECT_LT(run.result.fit->max, 1e-3);
    // Points beside the triangle's edges also change the other edges of its neighbours.
    const PatchComplex before = by_default(mesh).result.patches;
    const Vec3 centre = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
    std::size_t far = 0;
    for (u32 tet = 0; tet < before.tets.size(); ++tet)
        if (std::ranges::all_of(before.tets[tet], [&](u32 v) { return (before.positions[v] - centre).norm() > 0.9; })) {
            EXPECT_EQ(run.result.patches.weights[tet], before.weights[tet]);
            ++far;
        }
    EXPECT_GT(far, 500u);
}

TEST(APatchFit, WhereTheMeshIntersectsItself_TheRestIsFittedAllTheSame) {
    Random random(1);
    const TriangleMesh mesh = with_positions(torus(1, 0.4, 24, 12), [&](const Vec3& p) -> Vec3 {
        const Vec3 noise(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        return p.x() > 0.3 ? p + 0.2 * noise : p;
    });
    PointCloud points;
    Array<Vec3> of_left;
    for (const Vec3& p : torus_points(20'000).positions)
        if (p.x() < -0.3) of_left.push_back(p);
    points.positions = std::move(of_left);
    APatchParams params;
    params.normals = APatchParams::Normals::mesh;
    params.fit = false;
    const PatchRun before = patched(mesh, params, &points);
    params.fit = true;
    const PatchRun run = patched(mesh, params, &points);
    EXPECT_THAT(run.warnings, Contains(HasSubstr("parts of the surface intersect at ")));
    EXPECT_LT(run.result.fit->rms, 0.5 * before.result.fit->rms);
}

TEST(APatchFit, OnlyOutliers_KeepTheSurfaceSound) {
    const TriangleMesh mesh = exact_torus(12, 6);
    Random random(7);
    Array<Vec3> points;
    for (int i = 0; i < 2000; ++i)
        points.emplace_back(random.uniform(-1.6, 1.6), random.uniform(-1.6, 1.6), random.uniform(-0.6, 0.6));
    const PatchRun run = fitted(mesh, cloud(std::move(points)));
    expect_sound(run.result);
    EXPECT_GT(run.result.left_out, 500u);
    EXPECT_LT(run.result.left_out, 2000u);
}

TEST(APatchFit, AnyNumberOfThreads_GivesTheSameBits) {
    const TriangleMesh mesh = irregular_torus(24, 12, 0.25);
    const PointCloud points = torus_points(20'000, 1e-3);
    const PatchRun one = fitted(mesh, points), four = fitted(mesh, points, 4);
    expect_same_bits(one.result.patches, four.result.patches);
    for (const char* name : {"fit-rms", "fit-p95", "fit-max", "left-out"})
        EXPECT_EQ(metric_of(one, name), metric_of(four, name)) << name;
}

TEST(APatchFit, ALargerMeshWithLargerPoints_HasLargerWeights) {
    const TriangleMesh mesh = irregular_torus(12, 6, 0.1);
    const PointCloud points = torus_points(4000, 1e-3);
    const APatchResult one = fitted(mesh, points).result,
                       other = fitted(scaled(mesh, 1000), moved(points, 1000)).result;
    for (u32 tet = 0; tet < one.patches.tets.size(); ++tet)
        for (std::size_t i = 0; i < 20; ++i)
            EXPECT_NEAR(other.patches.weights[tet][i], 1000 * one.patches.weights[tet][i], 1e-4);
}

TEST(APatchFit, UndividedTriangles_AreFitted) {
    const TriangleMesh mesh = exact_torus(24, 12);
    APatchParams params = params_for(mesh);
    params.split = Split::where_needed;
    const PointCloud points = torus_points(10'000);
    const PatchRun run = patched(mesh, params, &points);
    expect_sound(run.result);
    EXPECT_EQ(run.result.divided, 292u);
    params.fit = false;
    EXPECT_LT(run.result.fit->rms, 0.6 * patched(mesh, params, &points).result.fit->rms);
}

TEST(APatchFit, AnOpenMesh_IsFitted) {
    const TriangleMesh open = without_triangles(geodesic_sphere(1, 2), {0});
    const TriangleMesh mesh = with_normals(open, std::vector<Vec3>(open.positions.begin(), open.positions.end()));
    const PointCloud points = sphere_points(5000);
    const PatchRun run = fitted(mesh, points);
    expect_sound(run.result);
    EXPECT_GT(run.result.left_out, 20u);
    EXPECT_LT(run.result.fit->rms, 0.2 * by_default(mesh, &points).result.fit->rms);
}

TEST(APatchFit, Creases_StaySoundAndThroughTheirVertices) {
    const TriangleMesh mesh = creased_torus(24, 12);
    const PointCloud points = torus_points(6000, 1e-3);
    const PatchRun before = by_default(mesh, &points), after = fitted(mesh, points);
    ASSERT_GT(std::ranges::count(after.result.patches.kinds, PatchKind::continuation), 24);
    expect_sound(after.result);
    EXPECT_GT(for_each_ray(after.result.patches, 10, [](u32, const Vec3&) {}), 1000u);
    EXPECT_LT(after.result.fit->rms, before.result.fit->rms);
    // The slopes of the crease are the default's, so where only they count the functions are.
    for (u32 tet = 0; tet < after.result.patches.tets.size(); ++tet)
        if (after.result.patches.kinds[tet] == PatchKind::continuation) {
            EXPECT_EQ(after.result.patches.weights[tet], before.result.patches.weights[tet]);
        }
}

TEST(APatchFit, SharpStraightEdges_StayExactlyStraight) {
    TriangleMesh mesh = cube();
    const auto normal = [&](const Triangle& t) -> Vec3 {
        return (mesh.positions[t[1]] - mesh.positions[t[0]])
            .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
            .normalized();
    };
    std::vector<Edge> sharp;
    for (const Triangle& one : mesh.triangles)
        for (const Triangle& other : mesh.triangles)
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j)
                    if (one[i] == other[(j + 1) % 3] && one[(i + 1) % 3] == other[j] && one[i] < other[j] &&
                        normal(one).dot(normal(other)) < 0.5)
                        sharp.push_back(make_edge(one[i], one[(i + 1) % 3]));
    std::ranges::sort(sharp);
    ASSERT_EQ(sharp.size(), 12u);
    mesh.sharp_edges = Array<Edge>(sharp.begin(), sharp.end());
    // Noise, so that the diagonals' slopes change.
    Random random(3);
    Array<Vec3> scan;
    for (int i = 0; i < 6000; ++i) {
        Vec3 p(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
        p[i % 3] = (i / 3 % 2) + random.uniform(-0.01, 0.01);
        scan.push_back(p);
    }
    const PatchRun run = fitted(mesh, cloud(std::move(scan)));
    expect_sound(run.result);
    EXPECT_NE(run.result.patches.weights[0], by_default(mesh).result.patches.weights[0]);
    const PatchComplex& patches = run.result.patches;
    for (u32 tet = 0; tet < patches.tets.size(); ++tet)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const u32 a = patches.tets[tet][i], b = patches.tets[tet][j];
                if (a < 8 && b < 8 && std::ranges::binary_search(sharp, make_edge(a, b))) {
                    Barycentric at = Barycentric::Zero();
                    at[static_cast<Eigen::Index>(i)] = 0.3;
                    at[static_cast<Eigen::Index>(j)] = 0.7;
                    EXPECT_EQ(combined_value(patches, tet, at), 0);
                }
            }
}

// Normals.

TEST(APatchFitNormals, ThatFollowDetailsBetweenTheVertices_AreTurnedTowardsThePoints) {
    // A torus whose normals are up to 30 degrees off, as those of a dense mesh with noise are.
    TriangleMesh mesh = exact_torus(24, 12);
    std::vector<Vec3> normals(mesh.positions.size());
    Random random(6);
    for (std::size_t v = 0; v < normals.size(); ++v) {
        const Vec3 p = mesh.positions[v], exact = (p - outwards(p)).normalized();
        normals[v] =
            (exact + 0.5 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))).normalized();
    }
    mesh = with_normals(mesh, normals);
    const PointCloud points = torus_points(20'000);
    const auto error = [&](PatchNormals source, const PointCloud* wired) {
        APatchParams params;
        params.normals = source;
        params.interpolate = APatchParams::Interpolate::yes;
        const PatchRun run = patched(mesh, params, wired);
        expect_sound(run.result);
        return rms_distance(run.result.patches, torus_distance);
    };
    const double unfitted = error(PatchNormals::automatic, nullptr), kept = error(PatchNormals::given, &points),
                 turned = error(PatchNormals::automatic, &points);
    EXPECT_LT(kept, unfitted);
    EXPECT_LT(turned, 0.1 * kept);
    EXPECT_LT(turned, 1e-3);
}

TEST(APatchFitNormals, WithoutPointsNearThem_Stay) {
    const TriangleMesh mesh = exact_torus(12, 6);
    const PointCloud far = cloud({{9, 9, 9}, {0, 0, 0}, {-8, 1, 2}});
    for (const PointCloud* wired : {static_cast<const PointCloud*>(nullptr), &far}) {
        const PatchRun run = patched(mesh, {}, wired);
        expect_same_bits(run.result.patches, by_default(mesh).result.patches);
    }
}

TEST(APatchFitNormals, OfManyThreads_HaveTheSameBits) {
    const TriangleMesh mesh = irregular_torus(24, 12, 0.2);
    const PointCloud points = torus_points(5000, 1e-3);
    expect_same_bits(patched(mesh, {}, &points, 1).result.patches, patched(mesh, {}, &points, 4).result.patches);
}

TEST(APatchFitNormals, OfACurvedSurfaceBesidePlanes_AreFitted) {
    // Most points are exactly on the planes of a cylinder, so the median distance of all points is 0.
    TriangleMesh mesh = cylinder(12);
    mesh.face_columns = {};
    Random random(4);
    Array<Vec3> positions;
    for (int i = 0; i < 12'000; ++i) {
        const double angle = random.uniform(0, 2 * std::numbers::pi), radius = std::sqrt(random.uniform(0, 1));
        const Vec3 out(std::cos(angle), std::sin(angle), 0);
        positions.push_back(i % 4 == 0 ? Vec3(out.x(), out.y(), random.uniform(-1, 1))
                                       : Vec3(radius * out.x(), radius * out.y(), i % 8 < 4 ? -1 : 1));
    }
    const PointCloud points = cloud(std::move(positions));
    APatchParams params;
    params.interpolate = APatchParams::Interpolate::yes;
    const PatchRun run = patched(mesh, params, &points);
    EXPECT_LT(worst_distance(run.result.patches, cylinder_distance), 3e-3);
}

// Refusals.

Error refusal(const APatchParams& params, const PointCloud* points = nullptr) {
    return error_of([&] { patched(icosahedron(), params, points); });
}

TEST(APatchFitRefuses, NotFinitePoints) {
    const PointCloud points = cloud({{0, 0, 1}, {0, std::numeric_limits<double>::quiet_NaN(), 0}});
    EXPECT_THAT(refusal({}, &points).sentence(), HasSubstr("1 of 2 points"));
}

TEST(APatchFitRefuses, NegativeFairing) {
    APatchParams params;
    params.fairing = -1;
    EXPECT_THAT(refusal(params).sentence(), HasSubstr("fairing must be at least 0; it is -1"));
    EXPECT_FALSE(refusal(params).hint().empty());
}

TEST(APatchFitRefuses, RegularisationOutOfRange) {
    APatchParams params;
    params.regularisation = 0;
    EXPECT_THAT(refusal(params).sentence(), HasSubstr("regularisation must be from 1e-06 to 1; it is 0"));
    EXPECT_FALSE(refusal(params).hint().empty());
}

}  // namespace
}  // namespace scanmill
