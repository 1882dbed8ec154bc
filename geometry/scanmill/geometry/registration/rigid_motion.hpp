// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Rigid motions, and the motion that fits pairs of points best.
///
/// All functions use only exactly rounded operations, so their bits do not depend on the processor.

#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Maps p to rotation * p + translation.
struct RigidMotion {
    /// Orthonormal with determinant +1.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Vec3 translation = Vec3::Zero();

    Vec3 apply(const Vec3& p) const { return turned(p) + translation; }
    /// The image of a direction. Written out, because Eigen's product is a function call.
    Vec3 turned(const Vec3& v) const {
        const auto row = [&](int i) {
            return rotation(i, 0) * v.x() + rotation(i, 1) * v.y() + rotation(i, 2) * v.z();
        };
        return {row(0), row(1), row(2)};
    }
    RigidMotion inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
    /// First this motion, then `next`.
    RigidMotion then(const RigidMotion& next) const {
        return {next.rotation * rotation, next.rotation * translation + next.translation};
    }
};

/// A turn about `centre` and a shift. The turn has the axis of `turn` and the angle 2 atan(|turn| / 2), which is |turn|
/// radians for small turns.
RigidMotion small_motion(const Vec3& turn, const Vec3& centre, const Vec3& shift);

/// The same motion with a rotation that is orthonormal to rounding. Removes what many products have added up.
RigidMotion orthonormal(const RigidMotion& motion);

/// How far two motions differ: the root mean square distance between the images of eight points, `centre` counted twice
/// and `centre` moved by `radius` along each axis in both directions. Does not depend on the directions of the axes.
double displacement(const RigidMotion& one, const RigidMotion& other, const Vec3& centre, double radius);

/// Pairs of points relative to their centroids, and the singular value decomposition of their sum of products.
struct PairsFit {
    Vec3 from_mean = Vec3::Zero(), to_mean = Vec3::Zero();  ///< weighted centroids
    double from_squares = 0;  ///< weighted sum of the squared distances of `from` from its centroid
    /// left * diagonal matrix of values * right^T = weighted sum of from * to^T; the values descend.
    Eigen::Matrix3d left = Eigen::Matrix3d::Identity(), right = Eigen::Matrix3d::Identity();
    Vec3 values = Vec3::Zero();
    bool mirrors = false;  ///< whether right * left^T has the determinant -1

    /// The best rotation, never a reflection.
    Eigen::Matrix3d rotation() const { return map(mirrors ? -1 : 1); }
    /// The best orthonormal map with determinant -1.
    Eigen::Matrix3d reflection() const { return map(mirrors ? 1 : -1); }
    /// The best factor of the rotation: the size of `to` relative to `from`. 1 if all `from` are at one point.
    double scale() const;
    RigidMotion motion() const;

private:
    Eigen::Matrix3d map(double last) const { return right * Vec3(1, 1, last).asDiagonal() * left.transpose(); }
};

/// The weighted least squares of pairs of points: the maps of `from` with the smallest sums of squared distances from
/// `to`.
///
/// Pre:  equal numbers of points, at least one; weights >= 0 with a positive sum. An empty span of weights means equal
///       weights.
/// Post: if the points of one set are on a line, one of the best rotations.
/// Source: Kabsch 1976; Umeyama 1991 for the sign and the scale.
PairsFit pairs_fit(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights = {});

/// The motion that minimises the weighted sum of squared distances between the moved `from` and `to`; see pairs_fit().
RigidMotion fitted_motion(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights = {});

}  // namespace scanmill
