// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call tight-cocone, and what they check of every result.

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "filters/cocone/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "support/doubts.hpp"
#include "tight_cocone/tight_cocone.hpp"

namespace scanmill::test {

inline TightCoconeResult closed_through(const TetMesh& tets, const TightCoconeParams& params = {},
                                        unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return tight_cocone(tets, params, context);
}
inline TightCoconeResult closed_through(const PointCloud& cloud, const TightCoconeParams& params = {},
                                        unsigned threads = 1) {
    return closed_through(tets_of(cloud, threads), params, threads);
}

/// A result with what was reported about it, or the reason why there is none.
struct Outcome {
    std::optional<TightCoconeResult> result;
    std::optional<Error> refusal;
    std::vector<std::string> warnings, doubts;
};

inline Outcome outcome_of(const PointCloud& cloud, const TightCoconeParams& params = {}) {
    ContextOptions options;
    options.threads = 2;
    Context context(options);
    Outcome outcome;
    try {
        outcome.result = tight_cocone(tets_of(cloud, 2), params, context);
    } catch (const Error& error) {
        outcome.refusal = error;
    }
    outcome.warnings = context.warnings();
    outcome.doubts = doubts_of(context);
    return outcome;
}

inline TightCoconeParams with_big_balls(double factor = 1) {
    TightCoconeParams params;
    params.noise = TightCoconeParams::Noise::big_balls;
    params.noise_factor = factor;
    return params;
}

inline double volume(const TriangleMesh& mesh) { return signed_volume(mesh.positions.span(), mesh.triangles.span()); }

inline std::size_t intersections(const TriangleMesh& mesh) {
    ExecutionOptions options;
    options.threads = 2;
    Execution execution(options);
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 2);
    return self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution).count;
}

inline double inside_volume(const TetMesh& tets) {
    double sum = 0;
    for (std::size_t c = 0; c < tets.cells.size(); ++c) {
        const auto& [i, j, k, l] = tets.cells[c];
        const Vec3& a = tets.positions[i];
        if (tets.inside[c] == 1)
            sum += (tets.positions[j] - a).cross(tets.positions[k] - a).dot(tets.positions[l] - a) / 6;
    }
    return sum;
}

inline double surface_area(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm() / 2;
    return sum;
}

/// What is true of every result. `points`: the number of distinct points of the input.
inline void expect_promised(const TightCoconeResult& result, std::size_t points) {
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);  // two triangles at each edge, one fan at each vertex, consistently oriented
    EXPECT_EQ(found.unused_vertices, 0u);
    EXPECT_GT(volume(result.mesh), 0);
    EXPECT_EQ(result.tets.inside.size(), result.tets.cells.size());
    EXPECT_NEAR(volume(result.mesh) / inside_volume(result.tets), 1, 1e-9);
    EXPECT_EQ(result.unused + result.mesh.positions.size(), points);
    EXPECT_EQ(result.good + result.poor, result.tets.positions.size());
    EXPECT_NEAR(result.area / surface_area(result.mesh), 1, 1e-9);
    EXPECT_LE(result.invented_area, result.area);
    EXPECT_GE(result.invented_area, 0);
}

/// Every coordinate moved by a normal number times `deviation`.
inline PointCloud noisy(const PointCloud& cloud, double deviation, std::uint64_t seed = 1) {
    Random random(seed);
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    for (Vec3& p : positions)
        for (int k = 0; k < 3; ++k) p[k] += deviation * random.normal();
    PointCloud result;
    result.frame = cloud.frame;
    result.positions = std::move(positions);
    return result;
}

}  // namespace scanmill::test
