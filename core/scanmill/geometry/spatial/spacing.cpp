// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/spacing.hpp"

#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <vector>

#include "scanmill/geometry/spatial/unsquared_tree.hpp"

namespace scanmill {

namespace {

constexpr std::size_t most_queries = 100'000;
/// A sum of squares has every digit from this one on.
constexpr double least_square = 0x1p-960;
/// Squared distances between such coordinates are finite.
constexpr double largest_coordinate = 0x1p508;

double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
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

/// FLANN's kd-tree: fast, by squared distances.
class SquaredTree {
public:
    /// Refers to the points. Pre: at least two.
    explicit SquaredTree(std::vector<Vec3>& points)
        : points_(points),
          tree_(flann::KDTreeSingleIndexParams(10, false)) {
        tree_.buildIndex(flann::Matrix<double>(points.front().data(), points.size(), 3));
    }

    /// Squared distance to the nearest of the other points.
    double to_nearest_other(std::size_t point) const {
        std::size_t neighbours[2];
        double squared[2];
        flann::Matrix<double> query(points_[point].data(), 1, 3);
        flann::Matrix<std::size_t> found(neighbours, 1, 2);
        flann::Matrix<double> found_squared(squared, 1, 2);
        const flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED, 0.0f);
        tree_.knnSearch(query, found, found_squared, 2, exact);
        return std::max(squared[0], squared[1]);  // one of the two is the point itself, at distance 0
    }

private:
    std::vector<Vec3>& points_;
    flann::KDTreeSingleIndex<flann::L2_3D<double>> tree_;
};

/// Distances to the nearest other place, by their squares where these are numbers.
class NearestDistances {
public:
    /// Refers to the points. Pre: finite, at least two, equal ones side by side.
    explicit NearestDistances(std::vector<Vec3>& points) : points_(points) {
        const auto is_small = [](const Vec3& p) { return p.cwiseAbs().maxCoeff() <= largest_coordinate; };
        if (std::ranges::all_of(points, is_small)) squared_.emplace(points);
    }

    /// Pre: no other point is at this one's place.
    double from(std::size_t point) {
        // Where one square is none, most are none, and a tree over them finds everything equally near.
        if (squared_ && !unsquared_)
            if (const double squared = squared_->to_nearest_other(point); squared >= least_square)
                return std::sqrt(squared);
        if (!unsquared_) {
            std::vector<Vec3> places;
            std::ranges::unique_copy(points_, std::back_inserter(places));
            unsquared_.emplace(std::move(places));
        }
        return unsquared_->to_nearest_other(points_[point]);
    }

private:
    std::vector<Vec3>& points_;
    std::optional<SquaredTree> squared_;
    std::optional<UnsquaredTree> unsquared_;
};

}  // namespace

double point_spacing(std::span<const Vec3> positions) {
    std::vector<Vec3> points = scattered(positions);
    if (points.size() < 2) return 0;

    NearestDistances nearest(points);
    const std::size_t queries = std::min(points.size(), most_queries);
    std::vector<double> distances(queries);
    for (std::size_t query = 0; query < queries; ++query) {
        const std::size_t index = query * points.size() / queries;
        // Of a duplicate without asking a tree that may hold millions of it.
        distances[query] = has_duplicate(points, index) ? 0 : nearest.from(index);
    }
    return median(distances);
}

double edge_spacing(const TriangleMesh& mesh) {
    std::vector<double> lengths;
    lengths.reserve(3 * mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3& from = mesh.positions[triangle[(corner + 1) % 3]];
            const Vec3& to = mesh.positions[triangle[corner]];
            if (from.allFinite() && to.allFinite()) lengths.push_back(length_between(from, to));
        }
    return median(lengths);
}

}  // namespace scanmill
