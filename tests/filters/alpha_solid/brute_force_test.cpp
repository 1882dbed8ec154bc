// SPDX-License-Identifier: GPL-3.0-or-later
/// The search for alpha and its verdicts against the definition, for many seeded random clouds and every radius.

#include <gmock/gmock.h>

#include "filters/alpha_solid/brute_force.hpp"
#include "filters/alpha_solid/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

/// Random points, loose or in clumps of many sizes that touch and merge.
PointCloud random_cloud(std::uint64_t seed) {
    Random random(seed);
    PointCloud cloud = random_cube(8 + random.index(30), random.next());
    for (std::uint64_t clumps = random.index(4); clumps > 0; --clumps)
        cloud = joined(cloud, moved(random_cube(5 + random.index(12), random.next()), random.uniform(0.05, 0.4),
                                    Vec3(random.uniform(), random.uniform(), random.uniform())));
    return cloud;
}

std::vector<AlphaSolidParams> demands() {
    return {{}, many(), covering(90), covering(60), covering(35), covering(90, AlphaComponents::many)};
}

TEST(AlphaSolidByDefinition, BoundaryDefectsAtAnyAlpha_AgreeWithTheFans) {
    int defective = 0, edge_manifold_only = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        const TetMesh tets = tets_of(random_cloud(seed));
        const double cover = solid_of(tets, many()).alpha_cover;
        for (double factor : {0.7, 0.85, 1.0, 1.05, 1.3, 2.0}) {
            AlphaSolidResult result;
            try {
                result = solid_of(tets, at_alpha(factor * cover));
            } catch (const Error&) {
                continue;  // no cell inside
            }
            const BruteForceVerdict verdict = brute_force_verdict(tets, result.tets.inside.span());
            ASSERT_EQ(result.nonmanifold_vertices, verdict.bad_vertices) << seed << " " << factor;
            ASSERT_EQ(result.nonmanifold_edges, verdict.bad_edges) << seed << " " << factor;
            ASSERT_EQ(result.components, verdict.components) << seed << " " << factor;
            ASSERT_EQ(tets.positions.size() - result.uncovered_points.size(), verdict.covered);
            defective += verdict.bad_vertices > 0;
            edge_manifold_only += verdict.bad_vertices > 0 && verdict.bad_edges == 0;
        }
    }
    EXPECT_GT(defective, 100);
    EXPECT_GT(edge_manifold_only, 20);
}

TEST(AlphaSolidByDefinition, TheScan_FindsTheLeastValidOfAllAlphas) {
    int beyond_cover = 0, repaired = 0;
    for (std::uint64_t seed = 0; seed < 120; ++seed) {
        const TetMesh tets = tets_of(random_cloud(seed));
        for (const AlphaSolidParams& params : demands()) {
            const AlphaSolidResult result = solid_of(tets, params);
            const auto spectrum = brute_force_spectrum(tets, params);
            const auto least = std::ranges::find(spectrum, true, &BruteForceSolid::valid);
            ASSERT_NE(least, spectrum.end());
            if (result.choice == AlphaChoice::scan) {
                ASSERT_NEAR(result.alpha * result.alpha / least->from, 1, 1e-14) << seed;
            } else {
                // Repaired only where nothing is valid up to four times alpha_cover.
                ASSERT_GT(std::sqrt(least->from), 4 * result.alpha_cover * (1 - 1e-12)) << seed;
                ++repaired;
            }
            beyond_cover += result.alpha > result.alpha_cover;
        }
    }
    EXPECT_GT(beyond_cover, 100);
    EXPECT_GT(repaired, 0);
}

TEST(AlphaSolidByDefinition, Spectrum_CountsTheDifferentSolidsFromAlphaCoverUp) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const TetMesh tets = tets_of(random_cloud(seed));
        const AlphaSolidResult result = solid_of(tets);
        const auto spectrum = brute_force_spectrum(tets, {});
        const double cover = result.alpha_cover;
        EXPECT_EQ(static_cast<long>(result.spectrum),
                  std::ranges::count_if(spectrum, [&](const auto& s) { return s.to > cover * cover; }));
        // A given alpha below alpha_cover counts from its own solid on.
        const double lower = std::sqrt(spectrum[spectrum.size() / 4].from) * (1 + 1e-12);
        if (lower >= cover) continue;
        EXPECT_EQ(static_cast<long>(solid_of(tets, at_alpha(lower)).spectrum),
                  std::ranges::count_if(spectrum, [&](const auto& s) { return s.to > lower * lower; }));
    }
}

TEST(AlphaSolidByDefinition, LatticeCube_HasASpectrumOfOne) {
    // Every square of the lattice is a wall from half its diagonal on: all cells enter together.
    EXPECT_EQ(solid_of(lattice_cube(3)).spectrum, 1u);
}

TEST(AlphaSolidByDefinition, Triangles_AreTwiceThePointsLessTheEulerCharacteristic) {
    // F = 2n − 2χ over the n points on the boundary, for every valid solid of any genus and number of components.
    std::set<long> characteristics;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        const AlphaSolidResult result = solid_of(random_cloud(seed), covering(60, AlphaComponents::many));
        const long euler = topology(result.mesh).euler;
        const std::size_t others = result.interior_points.size() + result.uncovered_points.size();
        const long on_boundary = static_cast<long>(result.tets.positions.size() - others);
        ASSERT_EQ(static_cast<long>(result.mesh.triangles.size()), 2 * on_boundary - 2 * euler);
        characteristics.insert(euler);
    }
    EXPECT_GE(characteristics.size(), 3u);
}

/// From alpha to the nearest of the radii.
double distance(const BruteForceSolid& solid, double alpha) {
    return std::max({0.0, std::sqrt(solid.from) - alpha, alpha - std::sqrt(solid.to)});
}

TEST(AlphaSolidByDefinition, NearestValid_IsTheNearestOfAllAlphas) {
    int wrong = 0, below = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const TetMesh tets = tets_of(random_cloud(seed));
        for (AlphaSolidParams params : demands()) {
            const auto spectrum = brute_force_spectrum(tets, params);
            const double cover = solid_of(tets, params).alpha_cover;
            for (double factor : {0.8, 1.0, 1.1, 1.4, 2.2}) {
                const double alpha = factor * cover;
                if (alpha * alpha < spectrum.front().from) continue;
                params.alpha = Length(alpha);
                const AlphaSolidResult result = solid_of(tets, params);
                const auto here = std::ranges::find_if(
                    spectrum, [&](const auto& s) { return alpha * alpha >= s.from && alpha * alpha < s.to; });
                ASSERT_EQ(result.nearest_valid.has_value(), !here->valid) << seed << " " << factor;
                if (here->valid) continue;
                ++wrong;
                double nearest = HUGE_VAL;
                for (const BruteForceSolid& solid : spectrum)
                    if (solid.valid) nearest = std::min(nearest, distance(solid, alpha));
                const double found = std::clamp(alpha, result.nearest_valid->least, result.nearest_valid->largest);
                ASSERT_NEAR(std::abs(found - alpha), nearest, 1e-12 * alpha) << seed << " " << factor;
                below += found < alpha;
                params.alpha = Length(found);
                ASSERT_FALSE(solid_of(tets, params).nearest_valid) << seed << " " << factor;
            }
        }
    }
    EXPECT_GT(wrong, 200);
    EXPECT_GT(below, 20);
}

}  // namespace
}  // namespace scanmill
