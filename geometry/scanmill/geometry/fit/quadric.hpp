// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fits a quadric over a plane to samples; computes the curvature at its origin.

#include <optional>
#include <span>

namespace scanmill {

/// The height s = a u² + b u v + c v² + d u + e v over the plane of u and v; it passes through the origin.
struct Quadric {
    double a = 0, b = 0, c = 0, d = 0, e = 0;

    double at(double u, double v) const { return ((a * u + b * v) * u + c * v * v) + (d * u + e * v); }
};

struct QuadricSample {
    double u, v, s;
    double weight = 1;
};

/// Whether the quadric may be inclined to the plane of u and v at the origin. If not, d = e = 0.
enum class Inclination { free, none };

/// Fits the quadric with the least sum of weighted squared errors in s. Empty if the samples do not determine it: there
/// are fewer than 5 (3 without inclination), or all are near one conic through the origin, such as two straight lines.
/// Pre: finite samples, weights above 0. Cost: about 40 operations per sample, plus 150.
std::optional<Quadric> fit_quadric(std::span<const QuadricSample> samples, Inclination inclination = Inclination::free);

/// In 1 / unit; |first| >= |second|. Positive where the surface bends towards positive s.
struct PrincipalCurvatures {
    double first = 0, second = 0;
};

/// The curvatures at the origin, where the quadric may be inclined to the plane of u and v. If d = e = 0, they are (a +
/// c) ± sqrt((a - c)² + b²).
PrincipalCurvatures principal_curvatures(const Quadric& quadric);

}  // namespace scanmill
