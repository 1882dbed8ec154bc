// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/rigid_motion.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cassert>
#include <cmath>

namespace scanmill {

RigidMotion small_motion(const Vec3& turn, const Vec3& centre, const Vec3& shift) {
    const Eigen::Quaterniond q(1, turn.x() / 2, turn.y() / 2, turn.z() / 2);
    const Eigen::Matrix3d rotation = q.normalized().toRotationMatrix();
    return {rotation, centre - rotation * centre + shift};
}

RigidMotion orthonormal(const RigidMotion& motion) {
    return {Eigen::Quaterniond(motion.rotation).normalized().toRotationMatrix(), motion.translation};
}

double displacement(const RigidMotion& one, const RigidMotion& other, const Vec3& centre, double radius) {
    const Eigen::Matrix3d turn = one.rotation - other.rotation;
    const Vec3 shift = turn * centre + (one.translation - other.translation);
    return std::sqrt(shift.squaredNorm() + radius * radius * turn.squaredNorm() / 4);
}

double PairsFit::scale() const {
    return from_squares > 0 ? (values[0] + values[1] + (mirrors ? -1 : 1) * values[2]) / from_squares : 1;
}

RigidMotion PairsFit::motion() const {
    const Eigen::Matrix3d turn = rotation();
    return {turn, to_mean - turn * from_mean};
}

PairsFit pairs_fit(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
    assert(from.size() == to.size() && !from.empty() && (weights.empty() || weights.size() == from.size()));
    const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
    Vec3 from_sum = Vec3::Zero(), to_sum = Vec3::Zero();
    double total = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        from_sum += weight(i) * from[i];
        to_sum += weight(i) * to[i];
        total += weight(i);
    }
    PairsFit fit;
    fit.from_mean = from_sum / total, fit.to_mean = to_sum / total;
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        products += weight(i) * (from[i] - fit.from_mean) * (to[i] - fit.to_mean).transpose();
        fit.from_squares += weight(i) * (from[i] - fit.from_mean).squaredNorm();
    }
    // GCC 12 at -O3 believes that the singular values are not set.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
    fit.left = svd.matrixU(), fit.right = svd.matrixV(), fit.values = svd.singularValues();
    fit.mirrors = (fit.right * fit.left.transpose()).determinant() < 0;
    return fit;
}
#pragma GCC diagnostic pop

RigidMotion fitted_motion(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
    return pairs_fit(from, to, weights).motion();
}

}  // namespace scanmill
