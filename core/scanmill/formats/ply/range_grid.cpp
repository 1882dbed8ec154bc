// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/ply/detail/range_grid.hpp"

#include <Eigen/Dense>
#include <vector>

namespace scanmill {

namespace {

constexpr u32 no_point = ~u32(0);

/// The point of each cell, or no_point. nullopt if a list has several numbers or its number is not a point.
std::optional<std::vector<u32>> points_of(const Column& cells, std::size_t points) {
    std::vector<u32> rows(cells.rows(), no_point);
    bool is_valid = cells.type() < ScalarType::float32;
    if (is_valid)
        visit_scalar(cells.type(), [&](auto zero) {
            const auto values = cells.values<decltype(zero)>();
            for (std::size_t cell = 0; cell < rows.size() && is_valid; ++cell) {
                const u64 first = cells.offsets()[cell], size = cells.offsets()[cell + 1] - first;
                if (size == 0) continue;
                const double row = static_cast<double>(values[first]);
                is_valid = size == 1 && row >= 0 && row < static_cast<double>(points);
                if (is_valid) rows[cell] = static_cast<u32>(row);
            }
        });
    if (!is_valid) return std::nullopt;
    return rows;
}

}  // namespace

std::optional<Vec3> direction_to_scanner(const Column& cells, std::size_t columns, std::span<const Vec3> positions) {
    if (columns < 2 || cells.rows() % columns != 0) return std::nullopt;
    const auto rows = points_of(cells, positions.size());
    if (!rows) return std::nullopt;
    const auto point = [&](std::size_t cell) -> const Vec3* {
        const u32 row = (*rows)[cell];
        return row != no_point && positions[row].allFinite() ? &positions[row] : nullptr;
    };
    // The affine map is computed from its normal equations, with positions relative to the first point.
    const Vec3* origin = nullptr;
    Vec3 facing = Vec3::Zero();
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), moments = Eigen::Matrix3d::Zero(), squares = moments;
    for (std::size_t cell = 0; cell < rows->size(); ++cell) {
        const Vec3* here = point(cell);
        if (!here) continue;
        if (!origin) origin = here;
        const Vec3 at(static_cast<double>(cell % columns), static_cast<double>(cell / columns), 1), p = *here - *origin;
        normal += at * at.transpose();
        moments += at * p.transpose();
        squares += p * p.transpose();
        if (cell % columns + 1 == columns || cell + columns >= rows->size()) continue;
        const Vec3 *right = point(cell + 1), *above = point(cell + columns);
        if (right && above) facing += (*right - *here).cross(*above - *here);
    }
    facing.stableNormalize();
    if (!(facing.norm() > 0.5)) return std::nullopt;
    const Eigen::Matrix3d affine = normal.completeOrthogonalDecomposition().solve(moments);
    const Eigen::Matrix3d residuals = squares - moments.transpose() * affine;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes((residuals + residuals.transpose()) / 2);
    Vec3 ray = axes.eigenvectors().col(2);
    if (ray.dot(facing) < 0) ray = -ray;
    return ray.dot(facing) < 0.5 ? facing : ray;
}

}  // namespace scanmill
