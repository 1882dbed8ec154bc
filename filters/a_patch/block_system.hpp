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

    /// `pairs`: the rows and columns of the blocks that may differ from 0, in any order, several times; both of (a, b)
    /// and (b, a), and every (a, a).
    BlockSystem(std::size_t size, std::vector<std::pair<u32, u32>> pairs);

    void clear();
    /// Pre: one pattern.
    void add(const BlockSystem& other);
    void add_to_diagonal(double value);
    std::size_t size() const { return right_.size(); }
    Matrix& block(u32 row, u32 column);
    Vector& right(u32 row) { return right_[row]; }

    /// Conjugate gradients, preconditioned by the diagonal blocks, starting at `x`. Unknowns without a connection to a
    /// right-hand side stay exactly 0 if they are. Cost: some hundred multiplications at most.
    void solve(std::vector<Vector>& x, const Execution& execution) const;

    /// x · matrix · x as a sum over the rows.
    std::vector<double> energies(const std::vector<Vector>& x) const;

    /// For each row, the sum of the values over the rows that its equation contains.
    std::vector<double> sums_of_neighbours(std::span<const double> values) const;

    /// Right-hand side of the row's equation for its own unknowns, with `x` for the others.
    Vector remainder(u32 row, const std::vector<Vector>& x) const;

private:
    std::vector<Vector> times(const std::vector<Vector>& x) const;
    std::size_t index(u32 row, u32 column) const;

    std::vector<std::size_t> begin_;
    std::vector<u32> columns_;
    std::vector<Matrix> blocks_;
    std::vector<Vector> right_;
};

/// Chooses from `weights`, for each row, the weight with which each half of the data best predicts the other half near
/// that row, because noise varies. "Near" means two rings of neighbouring rows, or more, up to 20, until about 2000
/// points are reached. Ties: the first of `weights`. `add_prior` adds the prior of a weight to a half; `restrict` moves
/// a solution to an admissible one.
std::vector<double> best_weights(const std::array<BlockSystem, 2>& halves, std::size_t points,
                                 std::span<const double> weights,
                                 const std::function<void(BlockSystem&, double)>& add_prior,
                                 const std::function<void(std::vector<BlockSystem::Vector>&)>& restrict,
                                 const Execution& execution);

}  // namespace scanmill::a_patches
