// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/fit/jet.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr Eigen::Index coefficients = 6;
/// Least ratio of the smallest to the largest pivot. Points on a conic give 1e-16; a strip of 1 : 100 about 1e-3.
constexpr double least_pivot = 1e-7;

}  // namespace

Jet fit_jet(std::span<const Vec3> offsets, std::span<const double> weights) {
    const Scatter scatter = scatter_of(offsets);
    const Vec3& normal = scatter.normal;
    Jet jet{normal, scatter.centroid.dot(normal) * normal, false};
    const auto count = static_cast<Eigen::Index>(offsets.size());
    if (count < coefficients) return jet;
    const auto [u, v] = directions_across(normal);
    double size = 0;
    for (const Vec3& offset : offsets) size += offset.squaredNorm();
    size = std::sqrt(size / static_cast<double>(offsets.size()));
    if (!(size > 0)) return jet;
    Eigen::Matrix<double, Eigen::Dynamic, coefficients> rows(count, coefficients);
    Eigen::VectorXd heights(count);
    double distances = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 offset = offsets[static_cast<std::size_t>(i)] / size;
        const double x = offset.dot(u), y = offset.dot(v);
        const double weight = weights.empty() ? 1 : std::sqrt(weights[static_cast<std::size_t>(i)]);
        rows.row(i) << weight, weight * x, weight * y, weight * x * x, weight * x * y, weight * y * y;
        heights[i] = weight * offset.dot(normal);
        distances += weight * weight * offset.squaredNorm();
    }
    Eigen::ColPivHouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, coefficients>> solver;
    solver.setThreshold(least_pivot);
    solver.compute(rows);
    if (solver.rank() < coefficients) return jet;
    const Eigen::Matrix<double, coefficients, 1> fit = solver.solve(heights);
    jet.offset = size * fit[0] * normal;
    jet.normal = with_positive_sign((normal - fit[1] * u - fit[2] * v).normalized());
    jet.is_curved = true;
    jet.error = (rows * fit - heights).norm() / std::sqrt(distances);
    return jet;
}

}  // namespace scanmill
