// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Distances between the original surface and the new one, separately for the two sides of the new surface.

#include <algorithm>

namespace scanmill::decimating {

struct SignedErrors {
    /// `outside`: largest height of the original surface above the new one, on the side of the new normals. `inside`:
    /// largest depth of the original surface below the new one.
    double outside = 0, inside = 0;

    void add(double distance, bool is_outside) {
        double& error = is_outside ? outside : inside;
        error = std::max(error, distance);
    }
    void add(const SignedErrors& other) {
        outside = std::max(outside, other.outside);
        inside = std::max(inside, other.inside);
    }
    bool is_within(const SignedErrors& limits) const { return outside <= limits.outside && inside <= limits.inside; }
    /// The larger of the two errors, each as a share of its limit. Pre: limits above 0.
    double share_of(const SignedErrors& limits) const {
        return std::max(outside / limits.outside, inside / limits.inside);
    }
};

/// Limits for a removal or a flip.
struct Limits {
    SignedErrors error;
    /// Cosine of the largest angle between a new triangle's normal and the mean normal of those it replaces.
    double normal_cosine = 0.5;
    /// Sine of the least angle of a new triangle.
    double angle_sine = 0;
    /// Replaces angle_sine where the surface is flat. There the shape of a triangle does not change its normal, and
    /// large faces need slim triangles.
    double flat_angle_sine = 0;
    unsigned max_valence = 25;
};

}  // namespace scanmill::decimating
