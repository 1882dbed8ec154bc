// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/view_checks.hpp"

#include <Eigen/Eigenvalues>

#include "scanmill/base/error.hpp"
#include "scanmill/data/array.hpp"

namespace scanmill::registration {

namespace {

/// The second eigenvalue of the covariance of points on a line, as a share of the first.
constexpr double line_share = 1e-12;

}  // namespace

void require_surface(std::span<const Vec3> points, std::string_view name) {
    if (points.empty()) throw Error("the view '{}' has no points", name).hint("remove it from the list of views");
    if (points.size() < 3)
        throw Error("the view '{}' has {} points; at least 3 are needed", name, points.size())
            .hint("remove it from the list of views");
    Vec3 sum = Vec3::Zero();
    for (std::size_t row = 0; row < points.size(); ++row) {
        if (!points[row].allFinite())
            throw Error("the view '{}' has coordinates that are not finite, first in row {}", name, row + 1)
                .hint("remove these points first");
        sum += points[row] - points[0];
    }
    const Vec3 centre = points[0] + sum / static_cast<double>(points.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Vec3& p : points) covariance += (p - centre) * (p - centre).transpose();
    const Vec3 spread =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues();
    if (spread[1] >= line_share * spread[2] && spread[2] > 0) return;
    throw Error("all {} points of the view '{}' {}", points.size(), name, spread[2] > 0 ? "lie on a line" : "are equal")
        .hint("a view needs points on a surface; remove it from the list of views");
}

}  // namespace scanmill::registration
