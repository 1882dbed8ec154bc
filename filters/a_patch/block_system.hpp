// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A sparse symmetric system of equations with two unknowns per edge.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::a_patches {

/// A symmetric positive definite matrix of 2 × 2 blocks with a right-hand side.
class BlockSystem {
public:
    using Vector = Eigen::Vector2d;
    using Matrix = Eigen::Matrix2d;

    /// `pairs` contains (row, column) of every block that may differ from 0, in any order; duplicates are allowed. It
    /// must contain every (a, a), and (b, a) for every (a, b).
    BlockSystem(std::size_t size, std::vector<std::pair<u32, u32>> pairs);

    void clear();
    /// Pre: both systems were made from the same pairs.
    void add(const BlockSystem& other);
    void add_to_diagonal(double value);
    std::size_t size() const { return right_.size(); }
    Matrix& block(u32 row, u32 column);
    Vector& right(u32 row) { return right_[row]; }

    /// Solves by conjugate gradients, preconditioned by the diagonal blocks, starting at `x`. Unknowns that are 0, and
    /// have no connection to a right-hand side, stay exactly 0. Cost: at most some hundred products of the matrix and a
    /// vector.
    void solve(std::vector<Vector>& x, const Execution& execution) const;

    /// The summands of x · matrix · x, one for each row.
    std::vector<double> energies(const std::vector<Vector>& x) const;

    /// For each row, the sum of the values over the rows that its equation contains.
    std::vector<double> sums_of_neighbours(std::span<const double> values) const;

    /// The right-hand side of a row's equation, minus the terms of all other rows' unknowns with their values in `x`.
    Vector remainder(u32 row, const std::vector<Vector>& x) const;

private:
    std::vector<Vector> times(const std::vector<Vector>& x) const;
    std::size_t index(u32 row, u32 column) const;

    std::vector<std::size_t> begin_;
    std::vector<u32> columns_;
    std::vector<Matrix> blocks_;
    std::vector<Vector> right_;
};

/// For each row, chooses from `weights` the weight with which each half of the data best predicts the other half near
/// that row. The choice differs between rows because noise varies. "Near" means within 2 to 20 rings of neighbouring
/// rows, enough for about 2000 of the `points` points. `add_prior` adds the prior with the given weight to a half.
/// `restrict` moves a solution to an admissible one. Ties: the first of `weights`.
std::vector<double> best_weights(const std::array<BlockSystem, 2>& halves, std::size_t points,
                                 std::span<const double> weights,
                                 const std::function<void(BlockSystem&, double)>& add_prior,
                                 const std::function<void(std::vector<BlockSystem::Vector>&)>& restrict,
                                 const Execution& execution);

}  // namespace scanmill::a_patches
