// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/fit/covariance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace scanmill {

namespace {

/// The symmetric matrix of second moments about the centroid.
struct Moments {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

    double trace() const { return xx + yy + zz; }
    double sum_of_minors() const { return (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz); }
    double determinant() const {
        return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    }
};

Moments moments_about(const Vec3& centroid, std::span<const Vec3> points) {
    Moments m;
    for (const Vec3& p : points) {
        const double x = p.x() - centroid.x(), y = p.y() - centroid.y(), z = p.z() - centroid.z();
        m.xx += x * x;
        m.xy += x * y;
        m.xz += x * z;
        m.yy += y * y;
        m.yz += y * z;
        m.zz += z * z;
    }
    return m;
}

/// Newton's method from 0. It never overshoots, because the characteristic polynomial is concave left of its least
/// root. Where two roots are close, the steps become short. Any direction between the two eigenvectors is then good
/// enough.
double least_eigenvalue(const Moments& m) {
    const double trace = m.trace(), minors = m.sum_of_minors(), determinant = m.determinant();
    // Of points on a line, minors and determinant are rounding errors, and their quotients have any size.
    constexpr double rounding = 1e-14;
    if (!(minors > rounding * trace * trace)) return 0;
    double root = 0;
    for (int step = 0; step < 50; ++step) {
        const double value = ((root - trace) * root + minors) * root - determinant;
        const double slope = (3 * root - 2 * trace) * root + minors;
        const double next = root - value / slope;
        if (!(next > root * (1 + 1e-15))) break;  // also when the slope is 0
        root = next;
    }
    return root;
}

/// The eigenvector of the least eigenvalue: the longest cross product of two rows of M - eigenvalue I.
Vec3 direction_of(const Moments& m, double eigenvalue) {
    const Vec3 x(m.xx - eigenvalue, m.xy, m.xz), y(m.xy, m.yy - eigenvalue, m.yz), z(m.xz, m.yz, m.zz - eigenvalue);
    Vec3 best = x.cross(y);
    for (const Vec3& other : {Vec3(x.cross(z)), Vec3(y.cross(z))})
        if (other.squaredNorm() > best.squaredNorm()) best = other;
    // For points on a line all products are 0 apart from rounding.
    const double size = m.trace() * m.trace();
    if (best.squaredNorm() > 1e-24 * size * size) return best.normalized();
    Vec3 along = x;
    for (const Vec3& other : {y, z})
        if (other.squaredNorm() > along.squaredNorm()) along = other;
    const Vec3 across = along.cross(std::abs(along.z()) < 0.7 * along.norm() ? Vec3::UnitZ() : Vec3::UnitX());
    return across.squaredNorm() > 0 ? along.cross(across).normalized() : Vec3(Vec3::UnitZ());
}

}  // namespace

Vec3 with_positive_sign(const Vec3& v) {
    int axis = 0;
    v.cwiseAbs().maxCoeff(&axis);
    return v[axis] < 0 ? Vec3(-v) : v;
}

Scatter scatter_of(std::span<const Vec3> points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : points) sum += p;
    Scatter scatter;
    scatter.centroid = sum / static_cast<double>(points.size());
    const Moments moments = moments_about(scatter.centroid, points);
    const double least = least_eigenvalue(moments);
    scatter.normal = with_positive_sign(direction_of(moments, least));
    const double others = moments.trace() - least;
    scatter.flatness = others > 0 ? std::max(0.0, moments.sum_of_minors() - least * others) / (others * others) : 0;
    scatter.surface_variation = moments.trace() > 0 ? least / moments.trace() : 0;
    return scatter;
}

}  // namespace scanmill
