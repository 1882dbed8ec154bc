// SPDX-License-Identifier: GPL-3.0-or-later
/// Laws of decimate on random and moved meshes, threads, cancellation, progress.
#include <gmock/gmock.h>

#include "filters/decimate/cases.hpp"
#include "scanmill/geometry/distance/certified_hausdorff.hpp"

namespace scanmill::test {
namespace {

TEST(DecimateLaws, RandomMeshes_KeepTopologyVerticesAndDistance) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        Random random(seed);
        const double noise = random.uniform(0, 0.05), max_error = random.uniform(0.001, 0.08);
        for (const TriangleMesh& mesh : {bumpy_sphere(8, noise, seed), bumpy_grid(14, 9, 4 * noise, seed),
                                         permuted(gridded_cube(6), static_cast<unsigned>(seed)),
                                         without_triangles(bumpy_sphere(6, noise, seed), {0, 1, 40, 77})}) {
            DecimateParams params = within(max_error);
            params.mode = seed % 3 == 0 ? DecimateMode::accumulated : DecimateMode::direct;
            const DecimateResult result = decimated(mesh, params);
            SCOPED_TRACE(fmt::format("seed {}, {} vertices, max-error {}", seed, mesh.positions.size(), max_error));
            expect_laws(mesh, result, max_error);
            EXPECT_LE(intersections_of(result.mesh), intersections_of(mesh));
        }
    }
}

TEST(DecimateLaws, Accumulated_ErrorsOfTrianglesBoundTheDistance) {
    // The two scalars follow the tilted normals only to first order: nearly always, not always.
    std::size_t runs = 0, beyond = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        Random random(seed);
        const double noise = random.uniform(0, 0.03), max_error = random.uniform(0.005, 0.05);
        const TriangleMesh mesh = seed % 2 == 0 ? bumpy_sphere(5, noise, seed) : bumpy_grid(10, 10, 3 * noise, seed);
        DecimateParams params = within(max_error);
        params.mode = DecimateMode::accumulated;
        const DecimateResult result = decimated(mesh, params);
        Execution execution;
        const CertifiedHausdorff distance = certified_hausdorff(result.mesh, mesh, {0.001, 10'000'000, {}}, execution);
        const double scalar =
            std::max(largest_in(result.mesh, "error-outside"), largest_in(result.mesh, "error-inside"));
        ++runs;
        beyond += distance.lower > scalar * (1 + 1e-6) + 1e-12;
    }
    EXPECT_LT(static_cast<double>(beyond), 0.01 * static_cast<double>(runs)) << beyond << " of " << runs;
}

TEST(DecimateLaws, Accumulated_OnASurfaceThatIsNoHeightField_StaysWithinMaxError) {
    // Bumps higher than the edges are long: round many vertices some triangles face away from the mean normal.
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
        const TriangleMesh mesh = bumpy_grid(40, 40, 3, seed);
        DecimateParams params = within(2);
        params.mode = DecimateMode::accumulated;
        const DecimateResult result = decimated(mesh, params);
        EXPECT_LE(result.certificate.upper, 2) << seed;
        EXPECT_LT(result.mesh.triangles.size(), mesh.triangles.size()) << seed;
    }
}

TEST(DecimateLaws, MovedMeshes_GiveTheSameCounts) {
    for (const TriangleMesh& mesh : {bumpy_sphere(16, 0.005, 2), torus(2, 0.7, 60, 30)}) {
        const double triangles = static_cast<double>(decimated(mesh, 0.02).mesh.triangles.size());
        const auto expect_alike = [&](const TriangleMesh& moved, double max_error) {
            const DecimateResult result = decimated(moved, max_error);
            expect_laws(moved, result, max_error);
            EXPECT_NEAR(static_cast<double>(result.mesh.triangles.size()), triangles, 0.02 * triangles + 2);
        };
        expect_alike(shifted(mesh, Vec3(1000.1, -77.7, 3.3)), 0.02);
        expect_alike(scaled(mesh, 1e-6), 0.02e-6);
        expect_alike(scaled(mesh, 7.3e5), 0.02 * 7.3e5);
        expect_alike(turned(mesh, 0.7, Vec3(1, 2, 3)), 0.02);
    }
}

TEST(DecimateLaws, FrameAndOrigin_AreKept) {
    TriangleMesh mesh = bumpy_sphere(8, 0.005, 2);
    mesh.frame.origin = Vec3(5e5, 4.5e6, 300);
    mesh.frame.unit = LengthUnit::millimetre;
    mesh.frame.name = "part";
    const DecimateResult result = decimated(mesh, 0.02);
    EXPECT_EQ(result.mesh.frame, mesh.frame);
    mesh.frame = {};
    EXPECT_TRUE(same_mesh(result.mesh, decimated(mesh, 0.02).mesh));
}

TEST(DecimateLaws, Threads_GiveTheSameBytes) {
    for (const DecimateMode mode : {DecimateMode::direct, DecimateMode::accumulated})
        for (const TriangleMesh& mesh : {bumpy_sphere(24, 0.005, 9), gridded_cube(20)}) {
            DecimateParams params = within(0.01);
            params.mode = mode;
            const PointCloud points = random_sphere(500, 3, 1.003);
            const DecimateResult one = decimated(mesh, params, &points, 1);
            for (const unsigned threads : {2u, 3u}) {
                const DecimateResult other = decimated(mesh, params, &points, threads);
                EXPECT_TRUE(same_mesh(one.mesh, other.mesh)) << threads;
                EXPECT_EQ(one.certificate.upper, other.certificate.upper);
                EXPECT_EQ(one.points_max, other.points_max);
            }
        }
}

TEST(DecimateLaws, ASecondRun_RemovesLittle) {
    // Not nothing: the second run measures from the first result.
    const TriangleMesh mesh = bumpy_sphere(16, 0.003, 5);
    const DecimateResult first = decimated(mesh, 0.01);
    EXPECT_EQ(decimated(first.mesh, 0).removed, 0u);
}

TEST(DecimateCancelled, EndsInEveryStage) {
    const TriangleMesh mesh = bumpy_sphere(20, 0.005, 1);
    for (const double stage : {0.0, 0.05, 0.1, 0.3, 0.75}) {
        bool reached = false;
        ContextOptions options;
        options.on_progress = [&](double fraction) { reached = reached || fraction >= stage; };
        options.is_cancelled = [&] { return reached; };
        Context context(options);
        EXPECT_THROW(decimate(mesh, nullptr, within(0.02), context), Cancelled) << stage;
        EXPECT_TRUE(reached) << stage;
    }
}

TEST(DecimateProgress, RisesToOne) {
    ContextOptions options;
    std::vector<double> fractions;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    decimate(bumpy_sphere(20, 0.005, 1), nullptr, within(0.02), context);
    EXPECT_GT(fractions.size(), 8u);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace scanmill::test
