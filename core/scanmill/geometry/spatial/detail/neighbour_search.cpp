// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/detail/neighbour_search.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

namespace scanmill {

namespace {

/// Of the squared radius of the leaf before: wider costs candidates, narrower second searches.
constexpr double widening = 1.25;
constexpr u32 most_pile = 63, most_in_pile = 12;

}  // namespace

void NeighbourSearch::nearest(std::size_t index, Neighbour* into) {
    const BoxTree::Point& from = tree_.points()[index];
    const double squared = enough_around(from.position, tree_.leaf_of(index));
    collect({from.position, from.position}, squared);
    [[maybe_unused]] const bool enough = choose(from, squared, into);
    assert(enough);
}

void NeighbourSearch::nearest_of_leaf(u64 leaf, Neighbour* into) {
    const std::span<const BoxTree::Point> points = tree_.points_of(leaf);
    const double squared = radius_for_leaf(leaf);
    collect(tree_.box(leaf), squared);
    double needed = 0;
    u64 failed = 0;  // a bit for each point
    assert(points.size() <= 64);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (choose(points[i], squared, into + i * count_))
            needed = std::max(needed, into[(i + 1) * count_ - 1].squared);
        else
            failed |= u64(1) << i;
    }
    const std::size_t first = static_cast<std::size_t>(points.data() - tree_.points().data());
    for (; failed; failed &= failed - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(failed));
        nearest(first + i, into + i * count_);
        needed = std::max(needed, into[(i + 1) * count_ - 1].squared);
    }
    last_squared_ = needed;
}

/// The square of a radius that holds enough around each point of the leaf, or will do so for most.
double NeighbourSearch::radius_for_leaf(u64 leaf) {
    const BoundingBox& box = tree_.box(leaf);
    // From the middle of the box to count + 1 points, and from every point to the middle.
    const double around = std::sqrt(enough_around((box.low + box.high) / 2, leaf)) + (box.high - box.low).norm() / 2;
    return std::min(around * around, last_squared_ * widening);
}

/// A squared radius around `position` that holds at least count + 1 points, itself included when it is one.
double NeighbourSearch::enough_around(const Vec3& position, u64 leaf) {
    const std::span<const BoxTree::Point> points = tree_.points_of(tree_.ancestor_with(count_ + 1, leaf));
    if (points.size() > buffer_.room) buffer_.make_room(2 * points.size());
    const std::span<double> squares = std::span(buffer_.squares).first(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) squares[i] = squared_distance(points[i].position, position);
    const auto last = squares.begin() + static_cast<std::ptrdiff_t>(count_);
    std::nth_element(squares.begin(), last, squares.end());
    return *last;
}

/// The points whose squared distance to the box is at most `squared` become candidates.
void NeighbourSearch::collect(const BoundingBox& box, double squared) {
    std::size_t size = 0;
    tree_.near(box, squared, [&](std::span<const BoxTree::Point> points) {
        if (size + points.size() > buffer_.room) buffer_.make_room(2 * (size + points.size()));
        for (const BoxTree::Point& point : points) {
            buffer_.x[size] = point.position.x();
            buffer_.y[size] = point.position.y();
            buffer_.z[size] = point.position.z();
            buffer_.numbers[size] = point.number;
            size += squared_distance(box, point.position) <= squared;  // no branch: it could not be predicted
        }
    });
    buffer_.candidates = size;
}

/// False when fewer than count other candidates lie within. Pre: all points that do are candidates.
bool NeighbourSearch::choose(const BoxTree::Point& from, double squared, Neighbour* into) {
    const std::size_t size = buffer_.candidates;
    for (std::size_t i = 0; i < size; ++i) {
        const double x = buffer_.x[i] - from.position.x(), y = buffer_.y[i] - from.position.y(),
                     z = buffer_.z[i] - from.position.z();
        buffer_.squares[i] = (x * x + y * y) + z * z;
    }
    std::size_t found = 0;
    for (std::size_t i = 0; i < size; ++i) {
        buffer_.found[found] = {buffer_.squares[i], buffer_.numbers[i]};
        found += unsigned{buffer_.squares[i] <= squared} & unsigned{buffer_.numbers[i] != from.number};
    }
    if (found < count_) return false;
    choose_sorted(std::span(buffer_.found).first(found), squared, into);
    return true;
}

/// Puts the nearest #count of the found ones into `into`, in order. On a surface squared distances are spread evenly:
/// dealing them out into piles nearly sorts them.
void NeighbourSearch::choose_sorted(std::span<Neighbour> found, double squared, Neighbour* into) {
    const double piles_per_square = most_pile / squared;
    std::array<u32, most_pile + 2> begin{};
    u32 highest = most_in_pile + 1;
    if (piles_per_square > 0 && std::isfinite(piles_per_square)) {
        for (std::size_t i = 0; i < found.size(); ++i) {
            buffer_.piles[i] = static_cast<u32>(found[i].squared * piles_per_square);
            ++begin[buffer_.piles[i] + 1];
        }
        highest = *std::ranges::max_element(begin);
    }
    if (highest > most_in_pile) {
        std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count_) - 1, found.end(),
                         ComesBefore());
        std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count_), ComesBefore());
        std::copy_n(found.begin(), count_, into);
        return;
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (std::size_t i = 0; i < found.size(); ++i) buffer_.dealt[begin[buffer_.piles[i]]++] = found[i];
    // By insertion: nobody is farther from its place than its pile is high.
    const std::size_t last = std::min(found.size(), count_ + most_in_pile);
    for (std::size_t i = 1; i < last; ++i) {
        const Neighbour moving = buffer_.dealt[i];
        std::size_t place = i;
        for (; place > 0 && ComesBefore()(moving, buffer_.dealt[place - 1]); --place)
            buffer_.dealt[place] = buffer_.dealt[place - 1];
        buffer_.dealt[place] = moving;
    }
    std::copy_n(buffer_.dealt.begin(), count_, into);
}

}  // namespace scanmill
