// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The Gauss-Newton equations of pairs of a point and a plane: which small motion of the points brings them onto their
/// planes, and which motions the planes do not determine.
///
/// Source: Chen and Medioni 1992; Gelfand, Ikemoto, Rusinkiewicz and Levoy 2003 for the eigenvalues.

#include <span>

#include "scanmill/geometry/registration/rigid_motion.hpp"

namespace scanmill {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct PlanePair {
    Vec3 point;
    Vec3 normal;  ///< unit vector
    double residual;  ///< signed distance of the point from the plane, positive towards the normal
    double weight = 1;  ///< >= 0; with 0 the pair does not count, and its residual may be NaN
};

/// Weighted means over the pairs with J = (c × n / R, n): n is the normal, c the point relative to `centre`, R =
/// `radius`.
struct PlaneEquations {
    Vec3 centre = Vec3::Zero();  ///< weighted centroid of the points
    double radius = 0;  ///< weighted root mean square distance of the points from `centre`
    Matrix6 matrix = Matrix6::Zero();  ///< mean of J^T J; it has no unit, and its trace is between 1 and 2
    Vector6 gradient = Vector6::Zero();  ///< mean of J^T residual; a length

    /// Eigenvalues of `matrix`, ascending. Motions with an eigenvalue near 0 are not determined by the planes.
    Vector6 eigenvalues() const;
    /// By column, in the order of eigenvalues(): the motion that turns by the first three numbers / `radius` and shifts
    /// by the last three.
    Matrix6 eigenvectors() const;
    /// The motion that minimises the weighted squared residuals, without the directions whose eigenvalue is below
    /// `least_eigenvalue`. The identity without pairs.
    RigidMotion motion(double least_eigenvalue) const;
};

/// Pre: normals of length 1; points relative to an origin near them, because `centre` has the rounding errors of their
/// coordinates. Sums run in the order of the pairs. Without pairs of positive weight, all members are 0.
PlaneEquations plane_equations(std::span<const PlanePair> pairs);

}  // namespace scanmill
