// SPDX-License-Identifier: GPL-3.0-or-later
/// Compares nearest-triangle queries of TriangleTree and of CGAL's AABB tree, in turn, in one process.
///
/// Equal: a million triangles of a bumpy sphere, a million queries near it along a space-filling curve, two threads and
/// doubles for both (CGAL with its fastest kernel, Simple_cartesian<double>). CGAL runs first with its own table of
/// hints, then with the last answer as hint, as ours does; the better result counts. Not equal: ours returns the
/// squared distance and the triangle, CGAL the point. At large distances CGAL gets fewer queries, and rates per second
/// are compared. Prints the largest difference between the answers.
///
/// usage: measure_bench [rounds = 5]

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "measure/measure.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "support/shapes.hpp"

namespace {

using namespace scanmill;
using Kernel = CGAL::Simple_cartesian<double>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Kernel::Triangle_3>::const_iterator>;
using CgalTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

constexpr unsigned threads = 2;
constexpr std::size_t chunk = 4096;

double seconds_of(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

TriangleMesh bumpy_sphere(u32 frequency) {
    TriangleMesh mesh = test::geodesic_sphere(1, frequency);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& p : positions) p *= 1 + 0.05 * std::sin(7 * p.x()) * std::sin(9 * p.y() + 1) * std::cos(8 * p.z());
    mesh.positions = std::move(positions);
    return mesh;
}

/// Points on the mesh, moved by `distance` in a random direction, in spatial order.
Array<Vec3> queries_near(const TriangleMesh& mesh, std::size_t count, double distance) {
    Random random(1);
    Array<Vec3> points(count);
    for (Vec3& point : points) {
        const auto& [a, b, c] = mesh.triangles[random.index(mesh.triangles.size())];
        const double away = std::sqrt(random.uniform()), across = random.uniform();
        point = mesh.positions[a] + away * (1 - across) * (mesh.positions[b] - mesh.positions[a]) +
                away * across * (mesh.positions[c] - mesh.positions[a]);
        point += distance * Vec3(random.normal(), random.normal(), random.normal()).normalized();
    }
    const Array<u32> order = spatial_order(points);
    Array<Vec3> sorted(count);
    for (std::size_t i = 0; i < count; ++i) sorted[i] = points[order[i]];
    return sorted;
}

void ask(const TriangleTree& tree, std::span<const Vec3> queries, Array<double>& squared) {
    for_each_chunk(threads, queries.size(), chunk, [&](std::size_t begin, std::size_t end) {
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            const NearestTriangle found = tree.nearest(queries[i], hint);
            squared[i] = found.squared_distance;
            hint = found.slot;
        }
    });
}

void ask(const CgalTree& tree, std::span<const Vec3> queries, bool from_last, Array<double>& squared) {
    for_each_chunk(threads, queries.size(), chunk, [&](std::size_t begin, std::size_t end) {
        Kernel::Point_3 last;
        for (std::size_t i = begin; i < end; ++i) {
            const Kernel::Point_3 query(queries[i].x(), queries[i].y(), queries[i].z());
            last = from_last && i > begin ? tree.closest_point(query, last) : tree.closest_point(query);
            squared[i] = CGAL::squared_distance(query, last);
        }
    });
}

void compare(const TriangleMesh& mesh, const TriangleTree& ours, const CgalTree& theirs, double distance,
             std::size_t cgal_queries, int rounds) {
    const Array<Vec3> queries = queries_near(mesh, 1'000'000, distance);
    // A section of the curve, with the density of the whole curve.
    const std::span<const Vec3> part = std::span(queries).first(cgal_queries);
    Array<double> our_answers(queries.size()), their_answers(part.size());
    std::vector<double> our_rates, table_rates, last_rates;
    for (int round = 0; round < rounds; ++round) {
        const double count = static_cast<double>(queries.size()), part_count = static_cast<double>(part.size());
        our_rates.push_back(count / seconds_of([&] { ask(ours, queries, our_answers); }));
        table_rates.push_back(part_count / seconds_of([&] { ask(theirs, part, false, their_answers); }));
        last_rates.push_back(part_count / seconds_of([&] { ask(theirs, part, true, their_answers); }));
    }
    double difference = 0;
    for (std::size_t i = 0; i < part.size(); ++i)
        difference = std::max(difference, std::abs(std::sqrt(our_answers[i]) - std::sqrt(their_answers[i])));
    const double cgal = std::max(median(table_rates), median(last_rates));
    fmt::print(
        "  {:<8.4g} {:10.0f} /s ours   {:10.0f} /s CGAL, its table   {:10.0f} /s CGAL, last answer   {:6.2f} times the "
        "better   largest difference {:.2g}\n",
        distance, median(our_rates), median(table_rates), median(last_rates), median(our_rates) / cgal, difference);
}

void whole_measure(const TriangleMesh& mesh, const TriangleMesh& truth) {
    const auto seconds = [&](bool self_intersections, bool certify, Measurement& result) {
        MeasureParams params;
        params.self_intersections = self_intersections;
        params.certify = certify;
        ContextOptions options;
        options.threads = threads;
        Context context(options);
        return seconds_of([&] { result = measure(mesh, truth, params, context); });
    };
    Measurement result;
    const double plain = seconds(false, false, result);
    const double with_intersections = seconds(true, false, result);
    const double with_all = seconds(true, true, result);
    fmt::print(
        "\nmeasure, {} triangles against {}: {:.2f} s, self-intersections {:.2f} s more, certify {:.2f} s more ({:.6g} "
        "to "
        "{:.6g}, {} cuts, {})\n",
        mesh.triangles.size(), truth.triangles.size(), plain, with_intersections - plain, with_all - with_intersections,
        result.certified->lower, result.certified->upper, result.certified->cuts,
        result.certified->reached ? "reached" : "ended");
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::max(1, std::stoi(argv[1])) : 5;
    const TriangleMesh mesh = bumpy_sphere(224);
    std::vector<Kernel::Triangle_3> triangles;
    for (const Triangle& triangle : mesh.triangles) {
        const auto corner = [&](u32 vertex) {
            const Vec3& p = mesh.positions[vertex];
            return Kernel::Point_3(p.x(), p.y(), p.z());
        };
        triangles.emplace_back(corner(triangle[0]), corner(triangle[1]), corner(triangle[2]));
    }
    std::optional<TriangleTree> ours;
    CgalTree theirs(triangles.begin(), triangles.end());
    const double our_build = seconds_of([&] { ours.emplace(mesh.positions.span(), mesh.triangles.span(), threads); });
    const double their_build = seconds_of([&] {
        theirs.build();
        theirs.accelerate_distance_queries();
    });
    fmt::print(
        "{} triangles, edges of about 0.005; built in {:.2f} s (ours, 2 threads), {:.2f} s (CGAL with its table)\n",
        mesh.triangles.size(), our_build, their_build);
    fmt::print("queries per second on 2 threads, by distance from the surface:\n");
    compare(mesh, *ours, theirs, 0, 1'000'000, rounds);
    compare(mesh, *ours, theirs, 0.0005, 1'000'000, rounds);
    compare(mesh, *ours, theirs, 0.005, 200'000, rounds);
    compare(mesh, *ours, theirs, 0.05, 50'000, rounds);

    whole_measure(bumpy_sphere(100), mesh);
}
