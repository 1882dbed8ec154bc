// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/facet_height.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace scanmill::a_patches {

namespace {

constexpr std::size_t next(std::size_t i) { return (i + 1) % 3; }
constexpr std::size_t previous(std::size_t i) { return (i + 2) % 3; }

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double power(double base, int exponent) {
    double result = 1;
    for (; exponent > 0; --exponent) result *= base;
    return result;
}

}  // namespace

std::size_t FacetHeight::number_of(const std::array<int, 3>& of) {
    return static_cast<std::size_t>(std::ranges::find(exponents, of) - exponents.begin());
}

FacetHeight::FacetHeight(const std::array<Vec3, 3>& corners) : origin_(corners[0]) {
    axes_[0] = (corners[1] - corners[0]).normalized();
    normal_ = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    axes_[1] = normal_.cross(axes_[0]);
    for (std::size_t i = 0; i < 3; ++i) corners_[i] = in_plane(corners[i]);
    std::array<double, 3> lengths;
    for (std::size_t i = 0; i < 3; ++i) lengths[i] = (corners_[next(i)] - corners_[i]).norm();
    const double around = lengths[0] + lengths[1] + lengths[2];
    std::array<double, 3> share;  // the barycentric coordinates that give the base point
    for (std::size_t i = 0; i < 3; ++i) share[i] = lengths[next(i)] / around;
    base_ = share[0] * corners_[0] + share[1] * corners_[1] + share[2] * corners_[2];
    const double radius = cross(corners_[1] - corners_[0], corners_[2] - corners_[0]) / around;

    const auto unit = [](std::size_t n) -> Numbers { return Numbers::Unit(static_cast<Eigen::Index>(n)); };
    // f(corner, corner, point)
    const auto at_corner = [&](std::size_t i, const Vec2& point) -> Numbers {
        return unit(i) +
               (unit(3 + 2 * i) * (point - corners_[i]).x() + unit(4 + 2 * i) * (point - corners_[i]).y()) / 3;
    };
    std::array<Numbers, 3> between;  // f(corner, next corner, base point)
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = next(i);
        const Vec2 d = corners_[j] - corners_[i];
        const double along = (base_ - corners_[i]).dot(d) / d.squaredNorm();
        between[i] =
            (1 - along) * at_corner(i, corners_[j]) + along * at_corner(j, corners_[i]) - radius / 3 * unit(9 + i);
    }
    std::array<Numbers, 3> beside_base;  // f(corner, base point, base point)
    Numbers at_base = Numbers::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
        beside_base[i] =
            share[i] * at_corner(i, base_) + share[next(i)] * between[i] + share[previous(i)] * between[previous(i)];
        at_base += share[i] * beside_base[i];
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = next(i);
        const std::array<Numbers, ordinates> rows{at_base,
                                                  beside_base[i],
                                                  beside_base[j],
                                                  at_corner(i, base_),
                                                  between[i],
                                                  at_corner(j, base_),
                                                  unit(i),
                                                  at_corner(i, corners_[j]),
                                                  at_corner(j, corners_[i]),
                                                  unit(j)};
        for (std::size_t n = 0; n < ordinates; ++n) parts_[i].row(static_cast<Eigen::Index>(n)) = rows[n].transpose();
        const std::array<Vec2, 3> part{base_, corners_[i], corners_[j]};
        const double twice_area = cross(part[1] - part[0], part[2] - part[0]);
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec2 opposite = part[previous(c)] - part[next(c)];
            gradients_[i][c] = Vec2(-opposite.y(), opposite.x()) / twice_area;
        }
    }
}

Vec3 FacetHeight::across(std::size_t i) const {
    const Vec2 d = (corners_[next(i)] - corners_[i]).normalized();
    return d.y() * axes_[0] - d.x() * axes_[1];
}

std::array<double, 2> FacetHeight::range_of_shares(const Vec2& at) const {
    const double whole = cross(corners_[1] - corners_[0], corners_[2] - corners_[0]);
    double least = 1, most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double share = cross(corners_[next(i)] - at, corners_[previous(i)] - at) / whole;
        least = std::min(least, share);
        most = std::max(most, share);
    }
    return {least, most};
}

FacetHeight::Basis FacetHeight::basis(const Vec2& at) const {
    // The part that contains the point, or is nearest to it.
    std::size_t best = 0;
    double greatest = 0;
    std::array<double, 3> share{};
    for (std::size_t i = 0; i < 3; ++i) {
        std::array<double, 3> here;
        here[1] = gradients_[i][1].dot(at - base_);
        here[2] = gradients_[i][2].dot(at - base_);
        here[0] = 1 - here[1] - here[2];
        const double least = std::min(here[1], here[2]);
        if (i > 0 && least <= greatest) continue;
        greatest = least;
        best = i;
        share = here;
    }
    Eigen::Matrix<double, ordinates, 1> values;
    std::array<Eigen::Matrix<double, ordinates, 1>, 2> derivatives;
    for (std::size_t n = 0; n < ordinates; ++n) {
        const auto& e = exponents[n];
        double factorials = 6;
        for (const int each : e) factorials /= each == 3 ? 6 : each == 2 ? 2 : 1;
        const auto row = static_cast<Eigen::Index>(n);
        std::array<double, 3> powers;
        for (std::size_t c = 0; c < 3; ++c) powers[c] = power(share[c], e[c]);
        values[row] = factorials * powers[0] * powers[1] * powers[2];
        Vec2 gradient = Vec2::Zero();
        for (std::size_t c = 0; c < 3; ++c)
            if (e[c] > 0)
                gradient += gradients_[best][c] *
                            (factorials * e[c] * power(share[c], e[c] - 1) * powers[next(c)] * powers[previous(c)]);
        derivatives[0][row] = gradient.x();
        derivatives[1][row] = gradient.y();
    }
    const auto& part = parts_[best];
    return {part.transpose() * values, {part.transpose() * derivatives[0], part.transpose() * derivatives[1]}};
}

FacetHeight::Matrix FacetHeight::bending() const {
    Matrix result = Matrix::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
        const std::array<Vec2, 3> part{base_, corners_[i], corners_[next(i)]};
        const double area = cross(part[1] - part[0], part[2] - part[0]) / 2;
        using Second = std::array<Numbers, 3>;  // xx, xy, yy
        std::array<Second, 3> at;
        for (std::size_t c = 0; c < 3; ++c) {
            at[c].fill(Numbers::Zero());
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b) {
                    std::array<int, 3> of{0, 0, 0};
                    for (const std::size_t k : {a, b, c}) ++of[k];
                    const Numbers ordinate = parts_[i].row(static_cast<Eigen::Index>(number_of(of))).transpose();
                    const Vec2 &u = gradients_[i][a], &v = gradients_[i][b];
                    at[c][0] += 6 * u.x() * v.x() * ordinate;
                    at[c][1] += 6 * u.x() * v.y() * ordinate;
                    at[c][2] += 6 * u.y() * v.y() * ordinate;
                }
        }
        // Second derivatives are linear, and the rule of the sides' middles is exact for their squares.
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < 3; ++k) {
                const Numbers middle = (at[c][k] + at[next(c)][k]) / 2;
                result += (k == 1 ? 2 : 1) * area / 3 * middle * middle.transpose();
            }
    }
    return result;
}

}  // namespace scanmill::a_patches
