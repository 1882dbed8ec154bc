// SPDX-License-Identifier: GPL-3.0-or-later
/// How the time of edge-flip grows with the mesh: seconds per million triangles of a bumpy sphere, at 70,000 and at
/// 700,000 triangles. One mesh has vertices that are moved at random by a third of an edge; in the other a fifth of
/// the edges were flipped at random as well. Linear time means equal rates; the larger mesh has more cache misses.
///
/// usage: edge_flip_bench [rounds = 5]

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "edge_flip/edge_flip.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/mesh/editable_mesh.hpp"
#include "support/shapes.hpp"

namespace {

using namespace scanmill;

TriangleMesh uneven_sphere(u32 frequency) {
    TriangleMesh mesh = test::geodesic_sphere(1, frequency);
    Random random(1);
    const double third = 0.4 / frequency;  // edges are about 1.2 / frequency long
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& p : positions) {
        p += third * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        p = p.normalized() * (1 + 0.05 * p.x() * p.y());
    }
    mesh.positions = std::move(positions);
    return mesh;
}

/// Flips a fifth of the edges wherever the two triangles are nearly flat and convex, so that a flip can be undone.
TriangleMesh with_random_flips(TriangleMesh mesh) {
    EditableMesh edited(mesh);
    Random random(2);
    const auto at = [&](u32 vertex) -> const Vec3& { return mesh.positions[vertex]; };
    for (std::size_t tries = 0; tries < edited.rows() * 3 / 10; ++tries) {
        const u32 h = static_cast<u32>(random.index(3 * edited.rows()));
        const Vec3 &a = at(edited.start(h)), &b = at(edited.end(h)), &c = at(edited.apex(h)),
                   &d = at(edited.apex(edited.opposite(h)));
        const Vec3 one = (a - c).cross(d - c), two = (d - c).cross(b - c);
        if (one.dot(two) > 0.8 * one.norm() * two.norm() && edited.can_flip(h)) edited.flip(h);
    }
    mesh.triangles = edited.compact_triangles();
    return mesh;
}

/// The median, in seconds.
double time_of(const TriangleMesh& mesh, int rounds, std::size_t& flips) {
    std::vector<double> seconds;
    for (int round = 0; round < rounds; ++round) {
        Context context;
        const auto begin = std::chrono::steady_clock::now();
        flips = edge_flip(mesh, {}, context).flips.size();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    std::ranges::sort(seconds);
    return seconds[seconds.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::stoi(argv[1]) : 5;
    for (const bool is_flipped : {false, true}) {
        double small_rate = 0;
        for (const u32 frequency : {59u, 187u}) {
            TriangleMesh mesh = uneven_sphere(frequency);
            if (is_flipped) mesh = with_random_flips(std::move(mesh));
            std::size_t flips = 0;
            const double seconds = time_of(mesh, rounds, flips);
            const double rate = seconds / static_cast<double>(mesh.triangles.size()) * 1e6;
            fmt::print("{}: {} triangles, {} flips, {:.3f} s, {:.3f} s per million", is_flipped ? "flipped" : "uneven",
                       mesh.triangles.size(), flips, seconds, rate);
            if (small_rate > 0) fmt::print(", growth of the rate {:.2f}", rate / small_rate);
            fmt::print("\n");
            small_rate = rate;
        }
    }
}
