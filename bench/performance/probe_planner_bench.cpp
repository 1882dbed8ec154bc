// SPDX-License-Identifier: GPL-3.0-or-later
/// How the time of probe-planner grows with the touches: a field of 100 blocks with 10,000 and with 100,000 touches, on
/// meshes of 77,000 triangles. Linear time means equal rates.
///
/// usage: probe_planner_bench [rounds = 3] [threads = 2]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "probe_planner/probe_planner.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace {

using namespace scanmill;

/// 10 x 10 blocks of 6 x 6 x 4, every face of 8 x 8 x 2 triangles.
TriangleMesh blocks() {
    constexpr u32 n = 8;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 block = 0; block < 100; ++block) {
        const Vec3 low(10.0 * (block % 10), 10.0 * (block / 10), 0), size(6, 6, 4);
        const auto first = static_cast<u32>(positions.size());
        std::vector<u32> at((n + 1) * (n + 1) * (n + 1), ~0u);
        const auto vertex = [&](const std::array<u32, 3>& p) {
            u32& number = at[(p[0] * (n + 1) + p[1]) * (n + 1) + p[2]];
            if (number == ~0u) {
                number = static_cast<u32>(positions.size()) - first;
                positions.push_back(low + Vec3(size.x() * p[0], size.y() * p[1], size.z() * p[2]) / n);
            }
            return first + number;
        };
        for (u32 axis = 0; axis < 3; ++axis)
            for (const u32 level : {0u, n})
                for (u32 i = 0; i < n; ++i)
                    for (u32 j = 0; j < n; ++j) {
                        const auto corner = [&](u32 u, u32 v) {
                            std::array<u32, 3> p{};
                            p[axis] = level;
                            p[(axis + 1) % 3] = u;
                            p[(axis + 2) % 3] = v;
                            return vertex(p);
                        };
                        const u32 a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1),
                                  d = corner(i, j + 1);
                        if (level == n)
                            triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
                        else
                            triangles.insert(triangles.end(), {{a, c, b}, {a, d, c}});
                    }
    }
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::stoi(argv[1]) : 3;
    ContextOptions options;
    options.threads = argc > 2 ? static_cast<unsigned>(std::stoi(argv[2])) : 2;
    const TriangleMesh mesh = blocks();
    const FeatureGraph features = find_features(mesh, {}, Execution()).graph;
    for (const double spacing : {0.64, 0.064}) {
        ProbePlannerParams params;
        params.radius = 0.5;
        params.scanner_error = 0.05;
        params.spacing = spacing;
        std::vector<double> seconds;
        ProbePlannerResult result;
        for (int round = 0; round < rounds; ++round) {
            Context context(options);
            const auto begin = std::chrono::steady_clock::now();
            result = probe_planner(features, mesh, params, context);
            seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        }
        std::ranges::sort(seconds);
        const double median = seconds[seconds.size() / 2];
        const auto touches = static_cast<double>(result.plan.touches.size());
        fmt::print("{} triangles, {} touches, {} of them unreachable: {:.3f} s, {:.1f} us per touch\n",
                   mesh.triangles.size(), result.plan.touches.size(), result.unreachable, median,
                   median / touches * 1e6);
    }
}
