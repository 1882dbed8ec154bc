// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/point_tree.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/bounds.hpp"

namespace scanmill {

namespace {

double squared_distance(const Vec3& a, const Vec3& b) {
    const double x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
    return (x * x + y * y) + z * z;
}
/// Squared distance between two boxes. Subtraction, squaring and addition are monotone when rounded to nearest, so
/// the computed distance to a box never exceeds the computed distance to a point in it.
double squared_distance(const BoundingBox& a, const BoundingBox& b) {
    double gap[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double above = b.low[axis] - a.high[axis], below = a.low[axis] - b.high[axis];
        gap[axis] = std::max(std::max(above, below), 0.0);
    }
    return (gap[0] * gap[0] + gap[1] * gap[1]) + gap[2] * gap[2];
}

/// A balanced kd-tree without pointers. Node 1 is the root, the children of node i are 2 i and 2 i + 1. All leaves are
/// on one level; the points of every node are contiguous, and their range follows from the node's number. A node is
/// split at the median of its box's longest edge, by (coordinate, index).
class KdTree {
public:
    struct Point {
        Vec3 position;
        u32 index;
    };

    KdTree(std::span<const Vec3> positions, unsigned threads) : points_(positions.size()) {
        // Smaller leaves need more boxes. Larger leaves need more distances to points that are too far away.
        constexpr std::size_t most_in_leaf = 8;
        constexpr std::size_t chunk = 1 << 12;
        assert(!positions.empty() && positions.size() <= ~u32(0));
        for (u32 index = 0; index < positions.size(); ++index) points_[index] = {positions[index], index};
        while (positions.size() >> depth_ > most_in_leaf) ++depth_;
        boxes_.resize(2 * leaves());
        const auto for_level = [&](u64 first, auto&& action) {
            const std::size_t nodes_per_chunk = std::max<std::size_t>(1, chunk * first / positions.size());
            for_each_chunk(threads, first, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
                for (u64 node = first + begin; node < first + end; ++node) action(node);
            });
        };
        // Every level computes its boxes from the points. This costs less than the selection on the same level.
        for (u64 first = 1; first < leaves(); first *= 2) for_level(first, [&](u64 node) { bound(node), split(node); });
        for_level(leaves(), [&](u64 node) { bound(node); });
    }

    std::span<const Point> points() const { return points_; }
    std::span<const Point> points_of(u64 node) const {
        const std::size_t begin = begin_of(node, 0);
        return std::span(points_).subspan(begin, begin_of(node, 1) - begin);
    }
    const BoundingBox& box(u64 node) const { return boxes_[node]; }
    u64 leaves() const { return u64(1) << depth_; }
    u64 leaf(u64 number) const { return leaves() + number; }
    /// The leaf that contains points()[slot].
    u64 leaf_of(std::size_t slot) const { return leaves() + (((u64(slot) + 1) << depth_) - 1) / points_.size(); }

    /// The leaf reached by moving, at every node, to the child whose box is nearer to `point`. The left child wins
    /// ties.
    u64 leaf_near(const Vec3& point) const {
        const BoundingBox at{point, point};
        u64 node = 1;
        while (node < leaves())
            node = 2 * node + (squared_distance(boxes_[2 * node], at) > squared_distance(boxes_[2 * node + 1], at));
        return node;
    }

    /// The lowest node that contains `node` and at least `count` points; the root if no node has so many points.
    u64 ancestor_with(std::size_t count, u64 node) const {
        while (node > 1 && points_of(node).size() < count) node /= 2;
        return node;
    }

    /// Calls action(points of a leaf) for every leaf whose box is at most at the squared distance `squared` from
    /// `from`.
    template <class Action>
    void near(const BoundingBox& from, double squared, Action&& action) const {
        u64 node = 1;
        while (true) {
            if (squared_distance(boxes_[node], from) <= squared) {
                if (node < leaves()) {
                    node *= 2;
                    continue;
                }
                action(points_of(node));
            }
            ++node;
            node >>= std::countr_zero(node);  // up from a right child, to the next unvisited node
            if (node == 1) return;
        }
    }

private:
    /// The slot of the first point of a node: of the node `later` nodes after `node` on the same level.
    std::size_t begin_of(u64 node, u64 later) const {
        const int level = static_cast<int>(std::bit_width(node)) - 1;
        return (node - (u64(1) << level) + later) * points_.size() >> level;
    }
    void bound(u64 node) {
        BoundingBox box;
        for (const Point& point : points_of(node)) box.add(point.position);
        boxes_[node] = box;
    }

    void split(u64 node) {
        int axis;
        (boxes_[node].high - boxes_[node].low).maxCoeff(&axis);
        const auto at = [&](std::size_t slot) { return points_.begin() + static_cast<std::ptrdiff_t>(slot); };
        std::nth_element(at(begin_of(node, 0)), at(begin_of(2 * node, 1)), at(begin_of(node, 1)),
                         [axis](const Point& a, const Point& b) {
                             const double x = a.position[axis], y = b.position[axis];
                             return x != y ? x < y : a.index < b.index;
                         });
    }

    unsigned depth_ = 0;
    Array<Point> points_;
    Array<BoundingBox> boxes_;
};

/// The order of neighbours; a type, so that sorting inlines it.
struct ComesBefore {
    bool operator()(const Neighbour& a, const Neighbour& b) const {
        return a.squared != b.squared ? a.squared < b.squared : a.index < b.index;
    }
};

/// Finds all points within a radius that contains enough points, then chooses the nearest of these points.
///
/// The points of a leaf are searched together, with a radius derived from the radius that the previous leaf needed.
/// Counting shows whether the radius was large enough for a point. The few points with too few neighbours are searched
/// again; their radius is the distance of the (count + 1)-th point in a node around them.
class NeighbourSearch {
public:
    /// Pre: 1 ≤ count < number of points. For nearest_to(), count may equal the number of points.
    NeighbourSearch(const KdTree& tree, std::size_t count, NeighbourBuffer& buffer)
        : tree_(tree),
          count_(count),
          buffer_(buffer) {}

    /// Writes the #count neighbours of points()[slot] to `out`.
    void nearest(std::size_t slot, Neighbour* out) {
        const KdTree::Point& from = tree_.points()[slot];
        const double squared = enough_around(from.position, tree_.leaf_of(slot), count_ + 1);
        collect({from.position, from.position}, squared);
        [[maybe_unused]] const bool enough = choose(from, squared, out);
        assert(enough);
    }

    /// Writes the #count points nearest to `point` to `out`.
    void nearest_to(const Vec3& point, Neighbour* out) {
        const double squared = enough_around(point, tree_.leaf_near(point), count_);
        collect({point, point}, squared);
        [[maybe_unused]] const bool enough = choose({point, nobody}, squared, out);
        assert(enough);
    }

    /// Writes the neighbours of all points of a leaf to `out`, #points × count.
    void nearest_of_leaf(u64 leaf, Neighbour* out) {
        const std::span<const KdTree::Point> points = tree_.points_of(leaf);
        const double squared = radius_for_leaf(leaf);
        collect(tree_.box(leaf), squared);
        double needed = 0;
        u64 failed = 0;  // one bit for each point
        assert(points.size() <= 64);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (choose(points[i], squared, out + i * count_))
                needed = std::max(needed, out[(i + 1) * count_ - 1].squared);
            else
                failed |= u64(1) << i;
        }
        const auto first = static_cast<std::size_t>(points.data() - tree_.points().data());
        for (; failed; failed &= failed - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(failed));
            nearest(first + i, out + i * count_);
            needed = std::max(needed, out[(i + 1) * count_ - 1].squared);
        }
        last_squared_ = needed;
    }

private:
    static constexpr u32 nobody = ~u32(0);  // not an index: a tree has fewer points

    /// The square of a radius that contains enough points around every point of the leaf, or around most of them.
    double radius_for_leaf(u64 leaf) {
        constexpr double widening = 1.25;  // more widening: more candidates; less: more second searches
        const BoundingBox& box = tree_.box(leaf);
        // The distance from the middle of the box to the (count + 1)-th point, plus half the diagonal of the box.
        const double around =
            std::sqrt(enough_around((box.low + box.high) / 2, leaf, count_ + 1)) + (box.high - box.low).norm() / 2;
        return std::min(around * around, last_squared_ * widening);
    }

    /// A squared radius around `position` that contains at least `count` points, including a point at `position`.
    double enough_around(const Vec3& position, u64 leaf, std::size_t count) {
        const std::span<const KdTree::Point> points = tree_.points_of(tree_.ancestor_with(count, leaf));
        if (points.size() > buffer_.x.size()) buffer_.reserve(2 * points.size());
        const std::span<double> squares = std::span(buffer_.squares).first(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) squares[i] = squared_distance(points[i].position, position);
        const auto last = squares.begin() + static_cast<std::ptrdiff_t>(count - 1);
        std::nth_element(squares.begin(), last, squares.end());
        return *last;
    }

    /// Collects the points whose squared distance to the box is at most `squared`. These are the candidates.
    void collect(const BoundingBox& box, double squared) {
        std::size_t size = 0;
        tree_.near(box, squared, [&](std::span<const KdTree::Point> points) {
            if (size + points.size() > buffer_.x.size()) buffer_.reserve(2 * (size + points.size()));
            for (const KdTree::Point& point : points) {
                buffer_.x[size] = point.position.x();
                buffer_.y[size] = point.position.y();
                buffer_.z[size] = point.position.z();
                buffer_.indices[size] = point.index;
                // No branch, because the processor could not predict it.
                size += squared_distance(box, BoundingBox{point.position, point.position}) <= squared;
            }
        });
        buffer_.candidates = size;
    }

    /// Writes the #count nearest candidates other than `from` to `out`. Returns false if fewer of them are within the
    /// squared radius `squared`. Pre: all points within this radius are candidates.
    bool choose(const KdTree::Point& from, double squared, Neighbour* out) {
        const std::size_t size = buffer_.candidates;
        for (std::size_t i = 0; i < size; ++i) {
            const double x = buffer_.x[i] - from.position.x(), y = buffer_.y[i] - from.position.y(),
                         z = buffer_.z[i] - from.position.z();
            buffer_.squares[i] = (x * x + y * y) + z * z;
        }
        std::size_t found = 0;
        for (std::size_t i = 0; i < size; ++i) {
            buffer_.found[found] = {buffer_.squares[i], buffer_.indices[i]};
            found += unsigned{buffer_.squares[i] <= squared} & unsigned{buffer_.indices[i] != from.index};
        }
        if (found < count_) return false;
        choose_sorted(std::span(buffer_.found).first(found), squared, out);
        return true;
    }

    /// Writes the #count nearest of `found` to `out`, in order. On a surface, squared distances are spread evenly, so a
    /// bucket sort almost sorts them. An insertion sort does the rest.
    void choose_sorted(std::span<Neighbour> found, double squared, Neighbour* out) {
        constexpr u32 last_bucket = 63, most_in_bucket = 12;
        const double buckets_per_square = last_bucket / squared;
        std::array<u32, last_bucket + 2> begin{};
        u32 fullest = most_in_bucket + 1;
        if (buckets_per_square > 0 && std::isfinite(buckets_per_square)) {
            for (std::size_t i = 0; i < found.size(); ++i) {
                buffer_.buckets[i] = static_cast<u32>(found[i].squared * buckets_per_square);
                ++begin[buffer_.buckets[i] + 1];
            }
            fullest = *std::ranges::max_element(begin);
        }
        if (fullest > most_in_bucket) {
            const auto end = found.begin() + static_cast<std::ptrdiff_t>(count_);
            std::nth_element(found.begin(), end - 1, found.end(), ComesBefore());
            std::sort(found.begin(), end, ComesBefore());
            std::copy_n(found.begin(), count_, out);
            return;
        }
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        for (std::size_t i = 0; i < found.size(); ++i) buffer_.sorted[begin[buffer_.buckets[i]]++] = found[i];
        // No element moves farther than the size of its bucket.
        const std::size_t last = std::min(found.size(), count_ + most_in_bucket);
        for (std::size_t i = 1; i < last; ++i) {
            const Neighbour moving = buffer_.sorted[i];
            std::size_t slot = i;
            for (; slot > 0 && ComesBefore()(moving, buffer_.sorted[slot - 1]); --slot)
                buffer_.sorted[slot] = buffer_.sorted[slot - 1];
            buffer_.sorted[slot] = moving;
        }
        std::copy_n(buffer_.sorted.begin(), count_, out);
    }

    const KdTree& tree_;
    std::size_t count_;
    NeighbourBuffer& buffer_;
    /// The squared radius that the last leaf needed.
    double last_squared_ = std::numeric_limits<double>::infinity();
};

struct Row {
    double x;
    u32 row;
};

/// The rows in ascending order of their positions. Rows with equal positions ascend by row.
Array<Row> sorted_rows(std::span<const Vec3> positions, unsigned threads) {
    Array<Row> rows(positions.size());
    for (u32 row = 0; row < positions.size(); ++row) rows[row] = {positions[row].x(), row};
    const auto comes_before = [&](const Row& a, const Row& b) {
        if (a.x != b.x) return a.x < b.x;
        const Vec3 &p = positions[a.row], &q = positions[b.row];
        if (p.y() != q.y()) return p.y() < q.y();
        return p.z() != q.z() ? p.z() < q.z() : a.row < b.row;
    };
    if (threads > 1)
        within_thread_budget(threads, [&] { tbb::parallel_sort(rows.begin(), rows.end(), comes_before); });
    else
        std::ranges::sort(rows, comes_before);
    return rows;
}

}  // namespace

void NeighbourBuffer::reserve(std::size_t size) {
    x.resize(size), y.resize(size), z.resize(size), squares.resize(size);
    indices.resize(size), buckets.resize(size);
    found.resize(size + 1), sorted.resize(size);
}

struct PointTree::Tree {
    Tree(std::span<const Vec3> points, unsigned threads)
        : index_of_row(points.size()),
          positions(distinct(points, sorted_rows(points, threads))),
          boxes(positions, threads),
          slot_of_index(positions.size()) {
        for (u32 slot = 0; slot < slot_of_index.size(); ++slot) slot_of_index[boxes.points()[slot].index] = slot;
    }

    Array<Vec3> distinct(std::span<const Vec3> points, const Array<Row>& sorted) {
        Array<Vec3> found;
        found.reserve(points.size());
        for (const Row& row : sorted) {
            if (found.empty() || found.back() != points[row.row]) found.push_back(points[row.row]);
            index_of_row[row.row] = static_cast<u32>(found.size() - 1);
        }
        return found;
    }

    Array<u32> index_of_row;
    Array<Vec3> positions;
    KdTree boxes;
    /// For every index in `positions`, the slot in boxes.points().
    Array<u32> slot_of_index;
};

PointTree::PointTree(std::span<const Vec3> positions, unsigned threads)
    : tree_(std::make_shared<const Tree>(positions, threads)) {}

std::span<const Vec3> PointTree::positions() const { return tree_->positions; }
std::span<const u32> PointTree::index_of_row() const { return tree_->index_of_row; }

std::span<const Neighbour> PointTree::nearest(u32 index, std::size_t count, NeighbourBuffer& buffer) const {
    buffer.neighbours.resize(std::min(count, tree_->positions.size() - 1));
    if (!buffer.neighbours.empty())
        NeighbourSearch(tree_->boxes, buffer.neighbours.size(), buffer)
            .nearest(tree_->slot_of_index[index], buffer.neighbours.data());
    return buffer.neighbours;
}

std::span<const Neighbour> PointTree::nearest_to(const Vec3& point, std::size_t count, NeighbourBuffer& buffer) const {
    buffer.neighbours.resize(std::min(count, tree_->positions.size()));
    if (!buffer.neighbours.empty())
        NeighbourSearch(tree_->boxes, buffer.neighbours.size(), buffer).nearest_to(point, buffer.neighbours.data());
    return buffer.neighbours;
}

void PointTree::for_each_nearest(std::size_t count, unsigned threads,
                                 const std::function<void(const NeighbourBatch&)>& action) const {
    // The results of a batch should fit into the cache of a processor core. The searches of a chunk share a buffer.
    constexpr u64 leaves_per_batch = 32, leaves_per_chunk = 512;
    const KdTree& boxes = tree_->boxes;
    const std::size_t each = std::min(count, tree_->positions.size() - 1);
    for_each_chunk(threads, boxes.leaves(), leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
        NeighbourBuffer buffer;
        NeighbourSearch search(boxes, each, buffer);
        Array<u32> indices;
        for (u64 leaf = begin; leaf < end; leaf += leaves_per_batch) {
            indices.clear();
            buffer.neighbours.resize(0);
            for (u64 next = leaf; next < std::min<u64>(end, leaf + leaves_per_batch); ++next) {
                const std::span<const KdTree::Point> points = boxes.points_of(boxes.leaf(next));
                for (const KdTree::Point& point : points) indices.push_back(point.index);
                buffer.neighbours.resize(indices.size() * each);
                if (each > 0)
                    search.nearest_of_leaf(boxes.leaf(next),
                                           &buffer.neighbours[(indices.size() - points.size()) * each]);
            }
            action({indices, buffer.neighbours, each});
        }
    });
}

std::span<const Neighbour> PointTree::within(u32 index, double squared, NeighbourBuffer& buffer) const {
    buffer.neighbours.clear();
    const Vec3& from = tree_->positions[index];
    tree_->boxes.near({from, from}, squared, [&](std::span<const KdTree::Point> points) {
        for (const KdTree::Point& point : points) {
            const double distance = squared_distance(point.position, from);
            if (distance < squared && point.index != index) buffer.neighbours.push_back({distance, point.index});
        }
    });
    std::ranges::sort(buffer.neighbours, ComesBefore());
    return buffer.neighbours;
}

}  // namespace scanmill
