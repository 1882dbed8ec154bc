// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/length_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <flann/flann.hpp>

#include "scanmill/filter/error.hpp"
#include "scanmill/formats/point_stream.hpp"
#include "scanmill/geometry/surface_box.hpp"

namespace scanmill {

namespace {

constexpr std::size_t most_queries = 100'000;

double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::span<const Vec3> positions_of(const Value& value) {
    return std::visit(
        []<class T>(const std::shared_ptr<const T>& object) -> std::span<const Vec3> {
            if constexpr (requires { object->positions; })
                return object->positions.span();
            else
                return {};
        },
        value);
}

/// Well mixed 64 bits of the coordinates' values; both zeros are equal.
std::uint64_t hash_of(const Vec3& p) {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash += std::bit_cast<std::uint64_t>(p[axis] + 0.0) + 0x9e3779b97f4a7c15u;
        hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;  // the finaliser of splitmix64
        hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
        hash ^= hash >> 31;
    }
    return hash;
}

/// The finite points in an order that scatters them over space, depends on their coordinates alone and puts equal
/// points side by side.
std::vector<Vec3> scattered(std::span<const Vec3> positions) {
    struct Point {
        std::uint64_t hash;
        Vec3 position;
    };
    std::vector<Point> points;
    points.reserve(positions.size());
    for (const Vec3& p : positions)
        if (p.allFinite()) points.push_back({hash_of(p), p});
    std::ranges::sort(points, [](const Point& a, const Point& b) {
        if (a.hash != b.hash) return a.hash < b.hash;
        return std::ranges::lexicographical_compare(std::span(a.position.data(), 3), std::span(b.position.data(), 3));
    });
    std::vector<Vec3> result;
    result.reserve(points.size());
    for (const Point& point : points) result.push_back(point.position);
    return result;
}

bool has_duplicate(const std::vector<Vec3>& scattered, std::size_t index) {
    return (index > 0 && scattered[index - 1] == scattered[index]) ||
           (index + 1 < scattered.size() && scattered[index + 1] == scattered[index]);
}

BoundingBox box_of(const Value& value) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value);
        mesh && !(*mesh)->triangles.empty())
        return surface_box(**mesh);
    return bounding_box(positions_of(value));
}

Error without_size(std::size_t points) {
    return Error("the scan has no size: {} at one place; at least two places are needed",
                 points == 1 ? "its only point is" : fmt::format("all {} points are", points))
        .hint("give lengths in the scan's unit, as 0.5 u, or leave this scan out");
}

double diagonal_of(const Value& value) {
    const std::span<const Vec3> positions = positions_of(value);
    const double diagonal = box_of(value).diagonal();
    if (diagonal > 0 || positions.empty()) return diagonal;
    require_finite(positions);
    throw without_size(positions.size());
}

double spacing_of(const Value& value) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value);
        mesh && !(*mesh)->triangles.empty())
        return edge_spacing(**mesh);
    return point_spacing(positions_of(value));
}

/// Computes at most once, however often it is copied or asked.
std::function<double()> memoised(std::function<double()> compute) {
    return [memo = std::make_shared<std::optional<double>>(), compute = std::move(compute)] {
        if (!*memo) *memo = compute();
        return **memo;
    };
}

LengthScale scale_beside(const std::shared_ptr<const Metrics>& metrics) {
    return {metrics->unit,
            [metrics] {
                const Metric* diagonal = metrics->find("diagonal");
                if (!diagonal)
                    throw Error("%diag means nothing here: no metric `diagonal` says how large the object is")
                        .hint("give the length in a unit, or in u");
                return diagonal->value;
            },
            []() -> double {
                throw Error("spacing means nothing beside metrics").hint("give the length in a unit, in u or in %diag");
            }};
}

}  // namespace

double point_spacing(std::span<const Vec3> positions) {
    std::vector<Vec3> finite = scattered(positions);
    if (finite.size() < 2) return 0;

    flann::Matrix<double> data(finite.front().data(), finite.size(), 3);
    flann::Index<flann::L2_3D<double>> tree(data, flann::KDTreeSingleIndexParams(10, false));
    tree.buildIndex();
    const std::size_t queries = std::min(finite.size(), most_queries);
    std::vector<double> distances(queries);
    flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED, 0.0f);
    for (std::size_t query = 0; query < queries; ++query) {
        const std::size_t index = query * finite.size() / queries;
        if (has_duplicate(finite, index)) {
            distances[query] = 0;  // without asking a tree that may hold millions of it
            continue;
        }
        std::size_t neighbours[2];
        double squared[2];
        flann::Matrix<double> point(finite[index].data(), 1, 3);
        flann::Matrix<std::size_t> found(neighbours, 1, 2);
        flann::Matrix<double> found_squared(squared, 1, 2);
        tree.knnSearch(point, found, found_squared, 2, exact);
        // One of the two is the point itself, at distance 0.
        distances[query] = std::sqrt(std::max(squared[0], squared[1]));
    }
    return median(distances);
}

double edge_spacing(const TriangleMesh& mesh) {
    std::vector<double> lengths;
    lengths.reserve(3 * mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3 along = mesh.positions[triangle[corner]] - mesh.positions[triangle[(corner + 1) % 3]];
            if (along.allFinite()) lengths.push_back(along.norm());
        }
    return median(lengths);
}

LengthScale length_scale(const PointStream& scan) {
    const double diagonal = scan.bounds().diagonal();
    return {scan.frame().unit,
            [diagonal, points = scan.size()] { return diagonal > 0 ? diagonal : throw without_size(points); },
            []() -> double { throw Error("spacing takes all points to measure, which a stream never has"); }};
}

LengthScale length_scale(const Value& value) {
    if (const auto* metrics = std::get_if<std::shared_ptr<const Metrics>>(&value)) return scale_beside(*metrics);
    const Frame* frame = frame_of(value);
    return {frame ? frame->unit : LengthUnit::unknown, memoised([value] { return diagonal_of(value); }),
            memoised([value] { return spacing_of(value); })};
}

}  // namespace scanmill
