// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <flann/flann.hpp>
#include <limits>
#include <numeric>

namespace scanmill {

namespace {

bool comes_before(const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// The least float that is not below `value`.
float float_above(double value) {
    const float nearest = static_cast<float>(std::min<double>(value, std::numeric_limits<float>::max()));
    return static_cast<double>(nearest) < value ? std::nextafterf(nearest, std::numeric_limits<float>::infinity())
                                                : nearest;
}

}  // namespace

struct PointTree::Tree {
    explicit Tree(std::span<const Vec3> positions) : place_of_row(positions.size()) {
        Array<u32> order(positions.size());
        std::iota(order.begin(), order.end(), 0);
        std::ranges::sort(order, [&](u32 a, u32 b) { return comes_before(positions[a], positions[b]); });
        places.reserve(positions.size());
        for (u32 row : order) {
            if (places.empty() || places.back() != positions[row]) places.push_back(positions[row]);
            place_of_row[row] = static_cast<u32>(places.size() - 1);
        }
        index = std::make_unique<Index>(flann::Matrix<double>(places.front().data(), places.size(), 3),
                                        flann::KDTreeSingleIndexParams(10, true));
        index->buildIndex();
    }

    flann::Matrix<double> query(u32 place) const {
        return {const_cast<double*>(places[place].data()), 1, 3};  // FLANN only reads it
    }

    using Index = flann::Index<flann::L2_3D<double>>;
    Array<Vec3> places;
    Array<u32> place_of_row;
    std::unique_ptr<Index> index;
};

PointTree::PointTree(std::span<const Vec3> positions) : tree_(std::make_unique<Tree>(positions)) {}
PointTree::~PointTree() = default;

std::span<const Vec3> PointTree::places() const { return tree_->places; }
std::span<const u32> PointTree::place_of_row() const { return tree_->place_of_row; }

std::vector<double> PointTree::nearest(u32 place, std::size_t count) const {
    const std::size_t asked = std::min(count + 1, tree_->places.size());  // the first is the place itself
    std::vector<std::size_t> numbers(asked);
    std::vector<double> squares(asked);
    flann::Matrix<std::size_t> found(numbers.data(), 1, asked);
    flann::Matrix<double> found_squares(squares.data(), 1, asked);
    tree_->index->knnSearch(tree_->query(place), found, found_squares, asked,
                            flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED, 0.0f));
    squares.erase(squares.begin());
    return squares;
}

std::vector<u32> PointTree::within(u32 place, double squared) const {
    std::vector<std::vector<std::size_t>> found;
    std::vector<std::vector<double>> squares;
    flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED, 0.0f, false);
    tree_->index->radiusSearch(tree_->query(place), found, squares, float_above(squared), exact);
    std::vector<u32> result;
    for (std::size_t i = 0; i < found[0].size(); ++i)
        if (found[0][i] != place && squares[0][i] < squared) result.push_back(static_cast<u32>(found[0][i]));
    std::ranges::sort(result);
    return result;
}

}  // namespace scanmill
