// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/plane_equations.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

namespace scanmill {

Vector6 PlaneEquations::eigenvalues() const {
    return Eigen::SelfAdjointEigenSolver<Matrix6>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

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
    if (pairs.empty()) return equations;
    const double count = static_cast<double>(pairs.size());
    Vec3 sum = Vec3::Zero();
    for (const PlanePair& pair : pairs) sum += pair.point;
    equations.centre = sum / count;
    double squares = 0;
    for (const PlanePair& pair : pairs) squares += (pair.point - equations.centre).squaredNorm();
    equations.radius = std::sqrt(squares / count);
    if (!(equations.radius > 0)) return equations;
    // Only the lower triangle, column by column: half of the products.
    double sums[21] = {};
    for (const PlanePair& pair : pairs) {
        const Vec3 arm = (pair.point - equations.centre).cross(pair.normal) / equations.radius;
        const double j[6] = {arm.x(), arm.y(), arm.z(), pair.normal.x(), pair.normal.y(), pair.normal.z()};
        int next = 0;
        for (int column = 0; column < 6; ++column) {
            for (int row = column; row < 6; ++row) sums[next++] += j[row] * j[column];
            equations.gradient[column] += j[column] * pair.residual;
        }
    }
    int next = 0;
    for (int column = 0; column < 6; ++column)
        for (int row = column; row < 6; ++row)
            equations.matrix(row, column) = equations.matrix(column, row) = sums[next++] / count;
    equations.gradient /= count;
    return equations;
}

}  // namespace scanmill
