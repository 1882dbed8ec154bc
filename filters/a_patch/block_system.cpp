// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/block_system.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace scanmill::a_patches {

namespace {

constexpr double accuracy = 1e-8;  // relative error of the solution, in the norm of the matrix
constexpr int most_steps = 2000;
constexpr double worthwhile = 1e-3;  // a larger weight must lower the error by this share of the squared solution
constexpr double most_times = 10;  // largest error of a row, as a multiple of the approximate geometric mean near it
constexpr double enough_points = 2000;  // near a row, to choose its weight

// rough_logarithm() is a logarithm to base 2 that is linear between powers of 2; rough_power() is its inverse. std::log
// and std::exp give results that depend on the processor.

double rough_logarithm(double number) {
    int exponent;
    const double mantissa = std::frexp(number, &exponent);
    return exponent + 2 * mantissa - 2;
}

double rough_power(double exponent) {
    const double whole = std::floor(exponent);
    return std::ldexp(1 + (exponent - whole), static_cast<int>(whole));
}

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

std::vector<double> BlockSystem::energies(const std::vector<Vector>& x) const {
    const std::vector<Vector> product = times(x);
    std::vector<double> result(size());
    for (std::size_t row = 0; row < size(); ++row) result[row] = x[row].dot(product[row]);
    return result;
}

std::vector<double> BlockSystem::sums_of_neighbours(std::span<const double> values) const {
    std::vector<double> result(size(), 0.0);
    for (std::size_t row = 0; row < size(); ++row)
        for (std::size_t n = begin_[row]; n < begin_[row + 1]; ++n) result[row] += values[columns_[n]];
    return result;
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

std::vector<double> best_weights(const std::array<BlockSystem, 2>& halves, std::size_t points,
                                 std::span<const double> weights,
                                 const std::function<void(BlockSystem&, double)>& add_prior,
                                 const std::function<void(std::vector<BlockSystem::Vector>&)>& restrict,
                                 const Execution& execution) {
    const std::size_t size = halves[0].size();
    // r rings around a row contain about 10 r² rows.
    const double per_row = static_cast<double>(points) / static_cast<double>(size);
    const auto rings = static_cast<int>(std::clamp(std::ceil(std::sqrt(enough_points / 10 / per_row)), 2.0, 20.0));
    const auto near = [&](std::vector<double> values) {
        for (int ring = 0; ring < rings; ++ring) values = halves[0].sums_of_neighbours(values);
        return values;
    };
    using Solution = std::vector<BlockSystem::Vector>;
    const auto solution = [&](std::size_t half, double weight) {
        BlockSystem system = halves[half];
        add_prior(system, weight);
        Solution x(size, BlockSystem::Vector::Zero());
        system.solve(x, execution);
        return x;
    };
    // The solutions with the smallest weight approximate the solutions of the data alone. Up to a constant, a
    // solution's squared error is its squared difference from the solution of the other half's data alone, in the norm
    // of the data's matrix. This also holds for the summands of the rows near one row.
    const std::array<Solution, 2> least{solution(0, weights.front()), solution(1, weights.front())};
    std::vector<double> size_of_least(size, 0.0), best(size, weights.front()), least_error;
    for (std::size_t half = 0; half < 2; ++half) {
        const std::vector<double> found = halves[half].energies(least[half]);
        for (std::size_t row = 0; row < size; ++row) size_of_least[row] += found[row];
    }
    std::vector<std::vector<double>> errors;  // by weight and row
    for (const double weight : weights) {
        std::vector<double>& error = errors.emplace_back(size, 0.0);
        for (std::size_t half = 0; half < 2; ++half) {
            Solution x = weight == weights.front() ? least[half] : solution(half, weight);
            restrict(x);
            for (std::size_t row = 0; row < size; ++row) x[row] -= least[1 - half][row];
            const std::vector<double> found = halves[1 - half].energies(x);
            for (std::size_t row = 0; row < size; ++row) error[row] += found[row];
        }
    }
    // The error of a row counts at most as a multiple of the geometric mean near it. Otherwise a few rows with outliers
    // would decide for their neighbours.
    std::vector<double> largest = size_of_least, exponents(size), used(size);
    for (std::size_t row = 0; row < size; ++row) {
        for (const auto& error : errors) largest[row] = std::max(largest[row], std::abs(error[row]));
        used[row] = largest[row] > 0 ? 1 : 0;
        exponents[row] = largest[row] > 0 ? rough_logarithm(largest[row]) : 0;
    }
    exponents = near(std::move(exponents));
    used = near(std::move(used));
    for (std::size_t row = 0; row < size; ++row) {
        if (!(largest[row] > 0)) continue;
        const double share = std::min(1.0, most_times * rough_power(exponents[row] / used[row]) / largest[row]);
        for (auto& error : errors) error[row] *= share;
        size_of_least[row] *= share;
    }
    size_of_least = near(std::move(size_of_least));
    for (std::size_t n = 0; n < weights.size(); ++n) {
        errors[n] = near(std::move(errors[n]));
        if (n == 0) least_error = errors[0];
        for (std::size_t row = 0; row < size; ++row) {
            if (!(errors[n][row] < least_error[row] - worthwhile * size_of_least[row])) continue;
            least_error[row] = errors[n][row];
            best[row] = weights[n];
        }
    }
    return best;
}

}  // namespace scanmill::a_patches
