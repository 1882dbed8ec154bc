// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Cubic polynomials in Bernstein-Bezier form over a tetrahedron: value, derivatives, polar form, zeros along a line.
///
/// Barycentric coordinates are four numbers whose sum is 1, or 0 for a direction. All functions cost a few hundred
/// operations and use no libm function whose result depends on the processor.

#include <Eigen/Core>
#include <optional>

#include "scanmill/data/patches.hpp"

namespace scanmill {

using Barycentric = Eigen::Vector4d;

/// The value at the point with these coordinates.
double patch_value(const PatchWeights& weights, const Barycentric& at);
/// The polar form f(a, b, c): symmetric, affine in each argument, and f(a, a, a) is the value at a.
double patch_blossom(const PatchWeights& weights, const Barycentric& a, const Barycentric& b, const Barycentric& c);
/// The derivatives by the four coordinates. By the position x: the sum of each times the gradient of its coordinate.
Eigen::Vector4d patch_derivatives(const PatchWeights& weights, const Barycentric& at);

/// A tetrahedron with its function.
class PatchCell {
public:
    /// Pre: a tetrahedron with a volume.
    PatchCell(const std::array<Vec3, 4>& corners, const PatchWeights& weights);
    PatchCell(const PatchComplex& patches, std::size_t tet);

    Barycentric coordinates(const Vec3& point) const;
    Vec3 point(const Barycentric& at) const;
    double value(const Vec3& point) const { return patch_value(*weights_, coordinates(point)); }
    Vec3 gradient(const Barycentric& at) const { return gradients_ * patch_derivatives(*weights_, at); }
    Vec3 gradient(const Vec3& point) const { return gradient(coordinates(point)); }
    Eigen::Matrix3d hessian(const Vec3& point) const;

private:
    std::array<Vec3, 4> corners_;
    Eigen::Matrix<double, 3, 4> gradients_;  ///< of the four coordinates
    const PatchWeights* weights_;
};

/// The zero t in [0, 1] of the cubic with these Bernstein weights at 0, 1/3, 2/3 and 1, to the last bits; nothing if
/// the first and the last weight have one sign and are not 0. Pre: at most one zero.
std::optional<double> zero_of_cubic(const std::array<double, 4>& weights);

/// The point where the segment from `from` to `to` meets the surface, as its share t of the segment.
std::optional<double> patch_hit(const PatchWeights& weights, const Barycentric& from, const Barycentric& to);

}  // namespace scanmill
