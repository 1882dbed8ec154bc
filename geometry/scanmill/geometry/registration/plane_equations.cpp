// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/plane_equations.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

namespace scanmill {

Vector6 PlaneEquations::eigenvalues() const {
    return Eigen::SelfAdjointEigenSolver<Matrix6>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Matrix6 PlaneEquations::eigenvectors() const { return Eigen::SelfAdjointEigenSolver<Matrix6>(matrix).eigenvectors(); }

RigidMotion PlaneEquations::motion(double least_eigenvalue) const {
    if (!(radius > 0)) return {};
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(matrix);
    Vector6 step = Vector6::Zero();
    for (int i = 0; i < 6; ++i) {
        const double value = solver.eigenvalues()[i];
        if (value > 0 && value >= least_eigenvalue)
            step -= solver.eigenvectors().col(i).dot(gradient) / value * solver.eigenvectors().col(i);
    }
    return small_motion(step.head<3>() / radius, centre, step.tail<3>());
}

PlaneEquations plane_equations(std::span<const PlanePair> pairs) {
    PlaneEquations equations;
    double total = 0, squares = 0;
    Vec3 sum = Vec3::Zero();
    for (const PlanePair& pair : pairs) {
        total += pair.weight;
        sum += pair.weight * pair.point;
    }
    if (!(total > 0)) return equations;
    equations.centre = sum / total;
    for (const PlanePair& pair : pairs) squares += pair.weight * (pair.point - equations.centre).squaredNorm();
    equations.radius = std::sqrt(squares / total);
    if (!(equations.radius > 0)) return equations;
    Matrix6 sums = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero(), j;
    for (const PlanePair& pair : pairs) {
        if (!(pair.weight > 0)) continue;  // the residual may be NaN
        j.head<3>() = (pair.point - equations.centre).cross(pair.normal) / equations.radius;
        j.tail<3>() = pair.normal;
        const Vector6 weighted = pair.weight * j;
        sums.noalias() += j * weighted.transpose();
        gradient += pair.residual * weighted;
    }
    // The halves differ by rounding; a symmetric matrix takes one.
    equations.matrix = sums.selfadjointView<Eigen::Lower>();
    equations.matrix /= total;
    equations.gradient = gradient / total;
    return equations;
}

}  // namespace scanmill
