// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/block_system.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace scanmill::a_patches {

namespace {

constexpr double accuracy = 1e-8;  // of the solution, in the norm of the matrix
constexpr int most_steps = 2000;

}  // namespace

BlockSystem::BlockSystem(std::size_t size, std::vector<std::pair<u32, u32>> pairs)
    : begin_(size + 1, 0),
      right_(size, Vector::Zero()) {
    std::ranges::sort(pairs);
    pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
    for (const auto& [row, column] : pairs) {
        ++begin_[row + 1];
        columns_.push_back(column);
    }
    for (std::size_t row = 0; row < size; ++row) begin_[row + 1] += begin_[row];
    blocks_.assign(columns_.size(), Matrix::Zero());
}

void BlockSystem::clear() {
    std::ranges::fill(blocks_, Matrix::Zero());
    std::ranges::fill(right_, Vector::Zero());
}

void BlockSystem::add(const BlockSystem& other) {
    for (std::size_t n = 0; n < blocks_.size(); ++n) blocks_[n] += other.blocks_[n];
    for (std::size_t row = 0; row < size(); ++row) right_[row] += other.right_[row];
}

void BlockSystem::add_to_diagonal(double value) {
    for (u32 row = 0; row < size(); ++row) block(row, row).diagonal().array() += value;
}

double BlockSystem::energy(const std::vector<Vector>& x) const {
    const std::vector<Vector> product = times(x);
    double sum = 0;
    for (std::size_t row = 0; row < size(); ++row) sum += x[row].dot(product[row]) - 2 * x[row].dot(right_[row]);
    return sum;
}

std::size_t BlockSystem::index(u32 row, u32 column) const {
    const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(begin_[row]),
               last = columns_.begin() + static_cast<std::ptrdiff_t>(begin_[row + 1]);
    return static_cast<std::size_t>(std::lower_bound(first, last, column) - columns_.begin());
}

BlockSystem::Matrix& BlockSystem::block(u32 row, u32 column) { return blocks_[index(row, column)]; }

std::vector<BlockSystem::Vector> BlockSystem::times(const std::vector<Vector>& x) const {
    std::vector<Vector> result(size());
    for (std::size_t row = 0; row < size(); ++row) {
        Vector sum = Vector::Zero();
        for (std::size_t n = begin_[row]; n < begin_[row + 1]; ++n) sum += blocks_[n] * x[columns_[n]];
        result[row] = sum;
    }
    return result;
}

BlockSystem::Vector BlockSystem::remainder(u32 row, const std::vector<Vector>& x) const {
    Vector result = right_[row];
    for (std::size_t n = begin_[row]; n < begin_[row + 1]; ++n)
        if (columns_[n] != row) result -= blocks_[n] * x[columns_[n]];
    return result;
}

void BlockSystem::solve(std::vector<Vector>& x, const Execution& execution) const {
    std::vector<Matrix> inverse;
    for (u32 e = 0; e < size(); ++e) inverse.push_back(blocks_[index(e, e)].inverse());
    std::vector<Vector> residual = times(x), direction(size()), scaled(size());
    double limit = 0, product = 0;
    for (std::size_t e = 0; e < size(); ++e) {
        limit += right_[e].dot(inverse[e] * right_[e]);
        residual[e] = right_[e] - residual[e];
        direction[e] = inverse[e] * residual[e];
        product += residual[e].dot(direction[e]);
    }
    limit *= accuracy * accuracy;
    for (int step = 0; step < most_steps && product > limit; ++step) {
        execution.check_cancelled();
        const std::vector<Vector> ahead = times(direction);
        double curvature = 0, after = 0;
        for (std::size_t e = 0; e < size(); ++e) curvature += direction[e].dot(ahead[e]);
        const double length = product / curvature;
        for (std::size_t e = 0; e < size(); ++e) {
            x[e] += length * direction[e];
            residual[e] -= length * ahead[e];
            scaled[e] = inverse[e] * residual[e];
            after += residual[e].dot(scaled[e]);
        }
        for (std::size_t e = 0; e < size(); ++e) direction[e] = scaled[e] + (after / product) * direction[e];
        product = after;
    }
}

}  // namespace scanmill::a_patches
