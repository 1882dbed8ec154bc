// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/a_patch.hpp"

#include <Eigen/LU>
#include <cmath>

namespace scanmill {

namespace {

// Weights of a polynomial of degree d are numbered like PatchWeights. The weight of degree 3 with exponents e + unit(m)
// belongs to the m-th argument of the weight of degree 2 with exponents e.

constexpr int number_of(int degree, int i, int j, int k) {
    int number = 0;
    for (int a = degree; a >= 0; --a)
        for (int b = degree - a; b >= 0; --b)
            for (int c = degree - a - b; c >= 0; --c) {
                if (a == i && b == j && c == k) return number;
                ++number;
            }
    return -1;
}

/// For each weight of degree `degree - 1` the numbers of the four weights of degree `degree` that it is made of.
template <int degree, int count>
constexpr std::array<std::array<int, 4>, count> raised() {
    std::array<std::array<int, 4>, count> table{};
    int number = 0;
    for (int i = degree - 1; i >= 0; --i)
        for (int j = degree - 1 - i; j >= 0; --j)
            for (int k = degree - 1 - i - j; k >= 0; --k) {
                table[static_cast<std::size_t>(number++)] = {
                    number_of(degree, i + 1, j, k), number_of(degree, i, j + 1, k), number_of(degree, i, j, k + 1),
                    number_of(degree, i, j, k)};
            }
    return table;
}
constexpr auto to_quadratic = raised<3, 10>();
constexpr auto to_linear = raised<2, 4>();

template <std::size_t count, class Table, class From>
std::array<double, count> lowered(const Table& table, const From& from, const Barycentric& at) {
    std::array<double, count> to;
    for (std::size_t n = 0; n < count; ++n) {
        const auto& parts = table[n];
        to[n] = at[0] * from[static_cast<std::size_t>(parts[0])] + at[1] * from[static_cast<std::size_t>(parts[1])] +
                at[2] * from[static_cast<std::size_t>(parts[2])] + at[3] * from[static_cast<std::size_t>(parts[3])];
    }
    return to;
}

Eigen::Vector4d linear_part(const PatchWeights& weights, const Barycentric& a, const Barycentric& b) {
    const auto linear = lowered<4>(to_linear, lowered<10>(to_quadratic, weights, a), b);
    return {linear[0], linear[1], linear[2], linear[3]};
}

}  // namespace

double patch_blossom(const PatchWeights& weights, const Barycentric& a, const Barycentric& b, const Barycentric& c) {
    return linear_part(weights, a, b).dot(c);
}

double patch_value(const PatchWeights& weights, const Barycentric& at) { return patch_blossom(weights, at, at, at); }

Eigen::Vector4d patch_derivatives(const PatchWeights& weights, const Barycentric& at) {
    return 3 * linear_part(weights, at, at);
}

PatchCell::PatchCell(const std::array<Vec3, 4>& corners, const PatchWeights& weights)
    : corners_(corners),
      weights_(&weights) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = corners[static_cast<std::size_t>(i)] - corners[3];
    const Eigen::Matrix3d inverse = edges.inverse();
    gradients_.leftCols<3>() = inverse.transpose();
    gradients_.col(3) = -gradients_.leftCols<3>().rowwise().sum();
}

PatchCell::PatchCell(const PatchComplex& patches, std::size_t tet)
    : PatchCell({patches.positions[patches.tets[tet][0]], patches.positions[patches.tets[tet][1]],
                 patches.positions[patches.tets[tet][2]], patches.positions[patches.tets[tet][3]]},
                patches.weights[tet]) {}

Barycentric PatchCell::coordinates(const Vec3& point) const {
    Barycentric at = gradients_.transpose() * (point - corners_[3]);
    at[3] = 1 - at[0] - at[1] - at[2];
    return at;
}

Vec3 PatchCell::point(const Barycentric& at) const {
    return at[0] * corners_[0] + at[1] * corners_[1] + at[2] * corners_[2] + at[3] * corners_[3];
}

Eigen::Matrix3d PatchCell::hessian(const Vec3& point) const {
    const auto quadratic = lowered<10>(to_quadratic, *weights_, coordinates(point));
    Eigen::Matrix4d second;
    for (int m = 0; m < 4; ++m)
        for (int n = 0; n < 4; ++n) {
            Barycentric a = Barycentric::Zero(), b = Barycentric::Zero();
            a[m] = b[n] = 1;
            const auto linear = lowered<4>(to_linear, quadratic, a);
            second(m, n) = 6 * Eigen::Vector4d(linear[0], linear[1], linear[2], linear[3]).dot(b);
        }
    return gradients_ * second * gradients_.transpose();
}

std::optional<double> zero_of_cubic(const std::array<double, 4>& c) {
    if (c[0] == 0) return 0;
    if (c[3] == 0) return 1;
    if ((c[0] < 0) == (c[3] < 0)) return std::nullopt;
    const double sign = c[0] < 0 ? 1 : -1;  // the polynomial times `sign` rises through its zero
    double low = 0, high = 1, t = c[0] / (c[0] - c[3]);
    for (int step = 0; step < 100; ++step) {
        const double s = 1 - t;
        const double a0 = s * c[0] + t * c[1], a1 = s * c[1] + t * c[2], a2 = s * c[2] + t * c[3];
        const double b0 = s * a0 + t * a1, b1 = s * a1 + t * a2;
        const double value = s * b0 + t * b1, slope = 3 * (b1 - b0);
        if (value == 0) return t;
        (sign * value < 0 ? low : high) = t;
        double next = t - value / slope;
        if (!(next > low && next < high)) next = low + (high - low) / 2;
        if (next == t || !(next > low && next < high)) return t;
        t = next;
    }
    return t;
}

std::optional<double> patch_hit(const PatchWeights& weights, const Barycentric& from, const Barycentric& to) {
    const Eigen::Vector4d first = linear_part(weights, from, from), last = linear_part(weights, to, to);
    return zero_of_cubic({first.dot(from), first.dot(to), last.dot(from), last.dot(to)});
}

}  // namespace scanmill
