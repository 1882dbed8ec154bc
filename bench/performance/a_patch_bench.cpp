// SPDX-License-Identifier: GPL-3.0-or-later
/// How the times of a-patch, tessellate and the evaluation of patches grow with the mesh: spheres of 9,680 and 98,000
/// triangles. Linear time means equal rates. And the time to fit 350,000 points, with and without noise.
///
/// usage: a_patch_bench [rounds = 3] [threads = 1]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "a_patch/a_patch.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"
#include "support/shapes.hpp"
#include "tessellate/tessellate.hpp"

namespace {

using namespace scanmill;

/// The median, in seconds.
template <class Action>
double time_of(int rounds, Action&& action) {
    std::vector<double> seconds;
    for (int round = 0; round < rounds; ++round) {
        const auto begin = std::chrono::steady_clock::now();
        action();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    std::ranges::sort(seconds);
    return seconds[seconds.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::stoi(argv[1]) : 3;
    ContextOptions options;
    if (argc > 2) options.threads = static_cast<unsigned>(std::stoi(argv[2]));
    for (const u32 frequency : {22u, 70u}) {
        const TriangleMesh mesh = test::geodesic_sphere(1, frequency);
        const auto triangles = static_cast<double>(mesh.triangles.size());
        APatchResult result;
        const double build = time_of(rounds, [&] {
            Context context(options);
            result = a_patch(mesh, nullptr, {}, context);
        });
        TriangleMesh fine;
        const double tessellation = time_of(rounds, [&] {
            Execution execution(options);
            fine = tessellate(result.patches, {}, execution);
        });
        for (const double noise : {0.0, 1e-3}) {
            constexpr std::size_t count = 350'000;
            PointCloud points = test::random_sphere(count, 1);
            Random random(2);
            Array<Vec3> positions(points.positions.begin(), points.positions.end());
            for (Vec3& p : positions) p *= 1 + noise * random.uniform(-1, 1);
            points.positions = std::move(positions);
            APatchParams params;
            params.normals = APatchParams::Normals::mesh;
            const double fit = time_of(rounds, [&] {
                Context context(options);
                a_patch(mesh, &points, params, context);
            });
            fmt::print("{} points with noise {}: a-patch {:.3f} s, {:.1f} us per point for the fit\n", count, noise,
                       fit, (fit - build) / count * 1e6);
        }
        const PatchCell cell(result.patches, 0);
        const Vec3 corner = result.patches.positions[result.patches.tets[0][0]];
        constexpr int points = 1'000'000;
        double sum = 0;
        const double evaluation = time_of(rounds, [&] {
            for (int i = 0; i < points; ++i) sum += cell.value(corner + Vec3(1e-9 * i, 0, 0));
        });
        fmt::print(
            "{} triangles: a-patch {:.3f} s, {:.1f} us per triangle; tessellate {:.3f} s, {:.3f} us per triangle made; "
            "evaluation {:.1f} million points per second ({:.0e})\n",
            mesh.triangles.size(), build, build / triangles * 1e6, tessellation,
            tessellation / static_cast<double>(fine.triangles.size()) * 1e6, points / evaluation / 1e6, sum);
    }
}
