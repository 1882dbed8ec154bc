// SPDX-License-Identifier: GPL-3.0-or-later
/// How the time of plate-corners, align and virtual-probe grows with points, pairs and touches, each ten times as many.
/// Linear time means equal rates.
///
/// usage: registration_bench [rounds = 3] [threads = 2]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "align/align.hpp"
#include "plate_corners/plate_corners.hpp"
#include "scanmill/base/random.hpp"
#include "virtual_probe/virtual_probe.hpp"

namespace {

using namespace scanmill;

/// A plate of 200 x 120 with noise of 0.02, and as many points above it as a tenth.
PointCloud plate(std::size_t points) {
    Random random(1);
    Array<Vec3> positions;
    for (std::size_t i = 0; i < points; ++i)
        positions.push_back(i % 11 == 0 ? Vec3(random.uniform(80, 120), random.uniform(40, 80), random.uniform(1, 40))
                                        : Vec3(random.uniform(0, 200), random.uniform(0, 120), 0.02 * random.normal()));
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

/// A ridge of 90 degrees along y, 1,000 long, of 100,000 triangles.
TriangleMesh ridge() {
    constexpr u32 along = 1000, across = 25;
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 i = 0; i <= along; ++i)
        for (u32 j = 0; j <= 2 * across; ++j) {
            const double x = 2.0 * (double(j) - across);
            positions.emplace_back(x, i, -std::abs(x));
        }
    const auto at = [](u32 i, u32 j) { return i * (2 * across + 1) + j; };
    for (u32 i = 0; i < along; ++i)
        for (u32 j = 0; j < 2 * across; ++j)
            triangles.insert(triangles.end(),
                             {{at(i, j), at(i, j + 1), at(i + 1, j)}, {at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}});
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

ProbePlan touches(std::size_t count) {
    ProbePlan plan;
    plan.radius = 2;
    plan.scanner_error = 0.5;
    Random random(2);
    for (std::size_t i = 0; i < count; ++i) {
        ProbeTouch touch;
        touch.touch = touch.order = static_cast<u32>(i);
        touch.position = Vec3(0, random.uniform(1, 999), 0);
        touch.tangent = Vec3::UnitY();
        touch.approach = Vec3::UnitZ();
        touch.start = touch.position + 12 * touch.approach;
        plan.touches.push_back(touch);
    }
    return plan;
}

double median_seconds(int rounds, unsigned threads, const std::function<void(Context&)>& work) {
    std::vector<double> seconds;
    for (int round = 0; round < rounds; ++round) {
        ContextOptions options;
        options.threads = threads;
        Context context(options);
        const auto begin = std::chrono::steady_clock::now();
        work(context);
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    std::ranges::sort(seconds);
    return seconds[seconds.size() / 2];
}

void print(const char* filter, std::size_t count, const char* what, double seconds) {
    fmt::print("{}: {} {}: {:.3f} s, {:.2f} us each\n", filter, count, what, seconds,
               seconds / static_cast<double>(count) * 1e6);
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::stoi(argv[1]) : 3;
    const unsigned threads = argc > 2 ? static_cast<unsigned>(std::stoi(argv[2])) : 2;
    for (const std::size_t points : {100'000, 1'000'000}) {
        const PointCloud cloud = plate(points);
        PlateCornersParams params;
        params.tolerance = 0.2;
        print("plate-corners", points, "points",
              median_seconds(rounds, threads, [&](Context& context) { plate_corners(cloud, params, context); }));
        print("align", points, "pairs",
              median_seconds(rounds, threads, [&](Context& context) { align(cloud, cloud, {}, {}, context); }));
    }
    const TriangleMesh mesh = ridge();
    for (const std::size_t count : {10'000, 100'000}) {
        const ProbePlan plan = touches(count);
        VirtualProbeParams params;
        params.reference_error = 0.5;
        print("virtual-probe", count, "touches",
              median_seconds(rounds, threads, [&](Context& context) { virtual_probe(plan, mesh, params, context); }));
    }
}
