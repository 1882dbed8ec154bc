// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/unsquared_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/data/points.hpp"

namespace scanmill {

namespace {

/// Sums of squares between them have every digit.
constexpr double least_square = 0x1p-960, largest_square = 0x1p1020;
/// Brings the square of any double's difference, and of any difference of doubles, between these.
constexpr double far_scale = 0x1p-640, near_scale = 0x1p640;
constexpr std::size_t largest_leaf = 8;

int longest_axis(std::span<const Vec3> points) {
    const BoundingBox box = bounding_box(points);
    int longest = 0;
    (box.high / 2 - box.low / 2).maxCoeff(&longest);
    return longest;
}

}  // namespace

double length_between(const Vec3& from, const Vec3& to) {
    const Vec3 along = to - from;
    const double squared = along.squaredNorm();
    if (squared >= least_square && squared <= largest_square) return std::sqrt(squared);
    if (squared < least_square) return (along * near_scale).norm() / near_scale;
    return (to * far_scale - from * far_scale).norm() / far_scale;
}

UnsquaredTree::UnsquaredTree(std::vector<Vec3> points) : points_(std::move(points)), axes_(points_.size()) {
    build(0, points_.size());
}

void UnsquaredTree::build(std::size_t begin, std::size_t end) {
    if (end - begin <= largest_leaf) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    const int axis = longest_axis(std::span(points_).subspan(begin, end - begin));
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
    axes_[middle] = static_cast<u8>(axis);
    build(begin, middle);
    build(middle + 1, end);
}

double UnsquaredTree::to_nearest_other(const Vec3& from) const {
    double nearest = std::numeric_limits<double>::infinity();
    search(0, points_.size(), from, nearest);
    return nearest;
}

void UnsquaredTree::search(std::size_t begin, std::size_t end, const Vec3& from, double& nearest) const {
    const auto offer = [&](const Vec3& point) {
        if (point != from) nearest = std::min(nearest, length_between(from, point));
    };
    if (end - begin <= largest_leaf) {
        for (std::size_t i = begin; i < end; ++i) offer(points_[i]);
        return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    offer(points_[middle]);
    const double beyond = from[axes_[middle]] - points_[middle][axes_[middle]];
    // No distance is shorter than its part along one axis, however both are rounded.
    const bool is_right = beyond > 0;
    for (const bool right : {is_right, !is_right}) {
        if (right != is_right && std::abs(beyond) > nearest) return;
        right ? search(middle + 1, end, from, nearest) : search(begin, middle, from, nearest);
    }
}

}  // namespace scanmill
