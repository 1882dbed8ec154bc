// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/fit/quadric.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace scanmill {

namespace {

constexpr int most_unknowns = 5;
/// The least share of a diagonal entry that elimination may leave. The share is the squared sine of the angle between a
/// column and the span of the columns before it.
constexpr double least_pivot = 1e-9;

/// Normal equations: the lower half of the matrix, row by row, and the right-hand side.
struct Equations {
    std::array<std::array<double, most_unknowns>, most_unknowns> left{};
    std::array<double, most_unknowns> right{};
};

/// Sums the entries, weight * u^i v^j; each of these sums is computed once.
Equations equations_of(std::span<const QuadricSample> samples) {
    double uuuu = 0, uuuv = 0, uuvv = 0, uvvv = 0, vvvv = 0, uuu = 0, uuv = 0, uvv = 0, vvv = 0, uu = 0, uv = 0, vv = 0;
    std::array<double, most_unknowns> right{};
    for (const auto& [u, v, s, weight] : samples) {
        const double wu = weight * u, wv = weight * v, u2 = u * u, v2 = v * v, product = u * v;
        const double wu2 = wu * u, wuv = wu * v, wv2 = wv * v;
        uuuu += wu2 * u2;
        uuuv += wu2 * product;
        uuvv += wu2 * v2;
        uvvv += wuv * v2;
        vvvv += wv2 * v2;
        uuu += wu2 * u;
        uuv += wu2 * v;
        uvv += wv2 * u;
        vvv += wv2 * v;
        uu += wu2;
        uv += wuv;
        vv += wv2;
        right[0] += wu2 * s;
        right[1] += wuv * s;
        right[2] += wv2 * s;
        right[3] += wu * s;
        right[4] += wv * s;
    }
    Equations equations;
    equations.left[0] = {uuuu};
    equations.left[1] = {uuuv, uuvv};
    equations.left[2] = {uuvv, uvvv, vvvv};
    equations.left[3] = {uuu, uuv, uvv, uu};
    equations.left[4] = {uuv, uvv, vvv, uv, vv};
    equations.right = right;
    return equations;
}

/// Solves the first `unknowns` equations in place by an LDLᵀ factorisation. False if a pivot vanishes.
bool solve(Equations& equations, int unknowns) {
    auto& [left, right] = equations;
    for (int i = 0; i < unknowns; ++i) {
        const double whole = left[i][i];
        for (int j = 0; j < i; ++j) {
            double entry = left[i][j];
            for (int k = 0; k < j; ++k) entry -= left[i][k] * left[j][k];
            left[i][j] = entry;  // not yet divided by the pivot of j
        }
        for (int j = 0; j < i; ++j) {
            const double entry = left[i][j] / left[j][j];
            left[i][i] -= entry * left[i][j];
            right[i] -= entry * right[j];
            left[i][j] = entry;
        }
        if (!(left[i][i] > least_pivot * whole)) return false;
    }
    for (int i = unknowns - 1; i >= 0; --i) {
        right[i] /= left[i][i];
        for (int j = i + 1; j < unknowns; ++j) right[i] -= left[j][i] * right[j];
    }
    return true;
}

}  // namespace

std::optional<Quadric> fit_quadric(std::span<const QuadricSample> samples, Inclination inclination) {
    const int unknowns = inclination == Inclination::free ? 5 : 3;
    Equations equations = equations_of(samples);
    if (samples.size() < static_cast<std::size_t>(unknowns) || !solve(equations, unknowns)) return std::nullopt;
    const auto& [a, b, c, d, e] = equations.right;
    return unknowns == 5 ? Quadric{a, b, c, d, e} : Quadric{a, b, c, 0, 0};
}

PrincipalCurvatures principal_curvatures(const Quadric& quadric) {
    auto [a, b, c, d, e] = quadric;
    const double squared_slope = d * d + e * e, slope = std::sqrt(squared_slope);
    if (slope > 0) {  // turns the frame so that u points along the gradient
        const double x = d / slope, y = e / slope;
        const double along = (a * x + b * y) * x + c * y * y, across = (a * y - b * x) * y + c * x * x;
        b = 2 * (c - a) * x * y + b * (x - y) * (x + y);
        a = along;
        c = across;
    }
    // The map from the plane to the surface stretches lengths along the gradient by `stretch`. The numbers uu, uv and
    // vv are the entries of the shape operator in orthonormal directions.
    const double stretch = std::sqrt(1 + squared_slope);
    const double uu = 2 * a / (stretch * stretch * stretch), uv = b / (stretch * stretch), vv = 2 * c / stretch;
    const double mean = (uu + vv) / 2, half = (uu - vv) / 2, spread = std::sqrt(half * half + uv * uv);
    PrincipalCurvatures curvatures{mean + spread, mean - spread};
    if (std::abs(curvatures.first) < std::abs(curvatures.second)) std::swap(curvatures.first, curvatures.second);
    return curvatures;
}

}  // namespace scanmill
