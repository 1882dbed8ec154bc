// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A quadric over a plane, fitted to samples, and the curvature at its origin.

#include <optional>
#include <span>

namespace scanmill {

/// The height s = a u² + b u v + c v² + d u + e v over the plane of u and v; it goes through the origin.
struct Quadric {
    double a = 0, b = 0, c = 0, d = 0, e = 0;

    double at(double u, double v) const { return ((a * u + b * v) * u + c * v * v) + (d * u + e * v); }
};

struct QuadricSample {
    double u, v, s;
    double weight = 1;
};

/// Whether the quadric may be inclined to the plane of u and v at the origin; else d = e = 0.
enum class Inclination { free, none };

/// The quadric with the least sum of weighted squared errors in s. Nothing when the samples do not determine it: fewer
/// than 5 (3 without inclination), or all near one conic through the origin, as two straight lines are.
/// Pre: finite, weights above 0; |u| and |v| at most 1, or near it: so no power of them overflows.
/// Cost: some 40 operations per sample and 150 more.
std::optional<Quadric> fit_quadric(std::span<const QuadricSample> samples, Inclination inclination = Inclination::free);

/// In 1 / unit; |first| >= |second|. Positive where the surface bends towards positive s.
struct PrincipalCurvatures {
    double first = 0, second = 0;
};

/// At the origin, where the plane of u and v need not be tangent. Without a gradient
/// (a + c) ± sqrt((a - c)² + b²).
PrincipalCurvatures principal_curvatures(const Quadric& quadric);

}  // namespace scanmill
