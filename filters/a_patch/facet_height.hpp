// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The height of a surface over a triangle, to first order: the piecewise cubic function of Clough and Tocher, which is
/// the trace of a patch on its triangle.
///
/// Source: Clough, Tocher 1965, "Finite element stiffness matrices for analysis of plates in bending".

#include <Eigen/Core>
#include <array>

#include "scanmill/data/frame.hpp"

namespace scanmill::a_patches {

/// The twelve numbers that determine the height are those of the three corners: heights (0 to 2) and slopes in the
/// directions of both axes (3 + 2 * corner + axis); and for each edge, from corner i to the next, the slope across it
/// in its middle, outwards (9 + i). Positions in the plane are relative to corner 0.
class FacetHeight {
public:
    static constexpr int numbers = 12;
    using Numbers = Eigen::Matrix<double, numbers, 1>;
    using Matrix = Eigen::Matrix<double, numbers, numbers>;
    using Vec2 = Eigen::Vector2d;

    /// Pre: the triangle has an area.
    explicit FacetHeight(const std::array<Vec3, 3>& corners);

    const Vec3& origin() const { return origin_; }
    const Vec3& normal() const { return normal_; }
    /// The axes of the plane.
    const std::array<Vec3, 2>& axes() const { return axes_; }
    /// The direction across edge i, outwards.
    Vec3 across(std::size_t i) const;
    Vec2 in_plane(const Vec3& point) const { return {axes_[0].dot(point - origin_), axes_[1].dot(point - origin_)}; }
    /// Smallest and largest barycentric coordinate of a point of the plane.
    std::array<double, 2> range_of_shares(const Vec2& at) const;

    /// By number: its part of the height at a point of the plane, and of the slopes there.
    struct Basis {
        Numbers height;
        std::array<Numbers, 2> slopes;
    };
    Basis basis(const Vec2& at) const;

    /// The matrix M for which the integral of the squared second derivatives |H|² over the triangle is n · M n.
    Matrix bending() const;

private:
    static constexpr std::size_t ordinates = 10;  ///< number of coefficients of a cubic
    /// Exponents of the base point and of the two corners of a part, by ordinate.
    static constexpr std::array<std::array<int, 3>, ordinates> exponents{
        {{3, 0, 0}, {2, 1, 0}, {2, 0, 1}, {1, 2, 0}, {1, 1, 1}, {1, 0, 2}, {0, 3, 0}, {0, 2, 1}, {0, 1, 2}, {0, 0, 3}}};
    static std::size_t number_of(const std::array<int, 3>& exponents_of);

    Vec3 origin_, normal_;
    std::array<Vec3, 2> axes_;
    std::array<Vec2, 3> corners_;
    Vec2 base_;  ///< the centre of the inscribed circle
    std::array<Eigen::Matrix<double, ordinates, numbers>, 3> parts_;  ///< by edge: the ordinates of the part beside it
    std::array<std::array<Vec2, 3>, 3> gradients_;  ///< by part: of the coordinates of the base point and the corners
};

}  // namespace scanmill::a_patches
