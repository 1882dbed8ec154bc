// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/point_tree.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/detail/neighbour_search.hpp"

namespace scanmill {

namespace {

/// A batch's answers should stay in a processor's own cache; a chunk's searches share their memory.
constexpr u64 leaves_per_batch = 32, leaves_per_chunk = 512;

struct Row {
    double x;
    u32 row;
};

/// The rows in ascending order of their positions, equal ones by row.
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

void NeighbourBuffer::make_room(std::size_t size) {
    room = size;
    x.resize(size), y.resize(size), z.resize(size), squares.resize(size);
    numbers.resize(size), piles.resize(size);
    found.resize(size + 1), dealt.resize(size);
}

struct PointTree::Tree {
    Tree(std::span<const Vec3> positions, unsigned threads)
        : place_of_row(positions.size()),
          places(distinct(positions, sorted_rows(positions, threads))),
          boxes(places, threads),
          index_of_place(places.size()) {
        for (u32 index = 0; index < index_of_place.size(); ++index)
            index_of_place[boxes.points()[index].number] = index;
    }

    Array<Vec3> distinct(std::span<const Vec3> positions, const Array<Row>& sorted) {
        Array<Vec3> found;
        found.reserve(positions.size());
        for (const Row& row : sorted) {
            if (found.empty() || found.back() != positions[row.row]) found.push_back(positions[row.row]);
            place_of_row[row.row] = static_cast<u32>(found.size() - 1);
        }
        return found;
    }

    /// Calls action(Neighbour) for the others nearer than that, in the tree's order.
    template <class Action>
    void visit_within(u32 place, double squared, Action&& action) const {
        const Vec3& from = places[place];
        boxes.near({from, from}, squared, [&](std::span<const BoxTree::Point> points) {
            for (const BoxTree::Point& point : points) {
                const double distance = squared_distance(point.position, from);
                if (distance < squared && point.number != place) action(Neighbour{distance, point.number});
            }
        });
    }

    Array<u32> place_of_row;
    Array<Vec3> places;
    BoxTree boxes;
    /// Where the tree keeps each place.
    Array<u32> index_of_place;
};

PointTree::PointTree(std::span<const Vec3> positions, unsigned threads)
    : tree_(std::make_unique<Tree>(positions, threads)) {}
PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;

std::span<const Vec3> PointTree::places() const { return tree_->places; }
std::span<const u32> PointTree::place_of_row() const { return tree_->place_of_row; }

std::span<const Neighbour> PointTree::nearest(u32 place, std::size_t count, NeighbourBuffer& buffer) const {
    buffer.neighbours.resize(std::min(count, tree_->places.size() - 1));
    if (!buffer.neighbours.empty())
        NeighbourSearch(tree_->boxes, buffer.neighbours.size(), buffer)
            .nearest(tree_->index_of_place[place], buffer.neighbours.data());
    return buffer.neighbours;
}

std::vector<double> PointTree::nearest(u32 place, std::size_t count) const {
    const BoxTree& boxes = tree_->boxes;
    const Vec3& from = tree_->places[place];
    const std::size_t size = std::min(count, tree_->places.size() - 1);
    // As NeighbourSearch does, without telling equals apart. The place itself is the first, at distance 0.
    const u64 around = boxes.ancestor_with(size + 1, boxes.leaf_of(tree_->index_of_place[place]));
    std::vector<double> squares;
    squares.reserve(4 * boxes.points_of(around).size());
    for (const BoxTree::Point& point : boxes.points_of(around))
        squares.push_back(squared_distance(point.position, from));
    const auto last = static_cast<std::ptrdiff_t>(size);
    std::nth_element(squares.begin(), squares.begin() + last, squares.end());
    const double enough = squares[size];
    squares.clear();
    boxes.near({from, from}, enough, [&](std::span<const BoxTree::Point> points) {
        for (const BoxTree::Point& point : points) {
            const double squared = squared_distance(point.position, from);
            if (squared <= enough && point.number != place) squares.push_back(squared);
        }
    });
    std::nth_element(squares.begin(), squares.begin() + last, squares.end());
    std::sort(squares.begin(), squares.begin() + last);
    squares.resize(size);
    return squares;
}

void PointTree::for_each_nearest(std::size_t count, unsigned threads,
                                 const std::function<void(const NeighbourBatch&)>& answer) const {
    const BoxTree& boxes = tree_->boxes;
    const std::size_t each = std::min(count, tree_->places.size() - 1);
    for_each_chunk(threads, boxes.leaves(), leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
        NeighbourBuffer buffer;
        NeighbourSearch search(boxes, each, buffer);
        Array<u32> places;
        for (u64 leaf = begin; leaf < end; leaf += leaves_per_batch) {
            places.clear();
            buffer.neighbours.resize(0);
            for (u64 next = leaf; next < std::min<u64>(end, leaf + leaves_per_batch); ++next) {
                const std::span<const BoxTree::Point> points = boxes.points_of(boxes.leaf(next));
                for (const BoxTree::Point& point : points) places.push_back(point.number);
                buffer.neighbours.resize(places.size() * each);
                if (each > 0)
                    search.nearest_of_leaf(boxes.leaf(next),
                                           &buffer.neighbours[(places.size() - points.size()) * each]);
            }
            answer({places, buffer.neighbours, each});
        }
    });
}

std::span<const Neighbour> PointTree::within(u32 place, double squared, NeighbourBuffer& buffer) const {
    buffer.neighbours.clear();
    tree_->visit_within(place, squared, [&](const Neighbour& other) { buffer.neighbours.push_back(other); });
    std::ranges::sort(buffer.neighbours, ComesBefore());
    return buffer.neighbours;
}

std::vector<u32> PointTree::within(u32 place, double squared) const {
    std::vector<u32> numbers;
    tree_->visit_within(place, squared, [&](const Neighbour& other) { numbers.push_back(other.place); });
    std::ranges::sort(numbers);
    return numbers;
}

}  // namespace scanmill
