// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Errors of a hole's triangulation, measured to the original surface and the data points.
///
/// Every new edge has a path on the original surface, and every point lies on one side of it. So a triangulation cuts
/// the original surface along the paths, into one region per triangle. A region consists of original triangles and
/// parts of them. Their corners are points of the region, near the triangle, or points of the paths, near its edges.
/// The distance to a convex set is convex, so no point between the corners is farther. The boundary of the region
/// follows the edges of the triangle, so every point of the triangle has a point of the region as near.

#include "decimate/hole.hpp"
#include "decimate/surface.hpp"

namespace scanmill::decimating {

class DirectErrors : public HoleErrors {
public:
    DirectErrors(const Surface& surface, const Limits& limits) : surface_(surface), limits_(limits) {}

    /// Pre: unit `up`; all points are of the hole.
    void begin(std::span<const HoleCorner> corners, const Vec3& up, std::span<const u32> points);
    bool add_edge(u32 i, u32 j, SignedErrors& errors) override;
    bool add_triangle(u32 i, u32 k, u32 j, const Vec3& normal, SignedErrors& errors) override;
    /// Assigns every point to its triangle, by number from `first` on, and adds the distances to the triangles, which
    /// may be above those to their planes. False beyond the limits.
    bool assign(std::vector<HoleTriangle>& triangles, u32 first, std::vector<u32>& owners) const;

private:
    /// Calls action(p) for the points whose region the triangle represents.
    template <class Action>
    void for_each_point(u32 i, u32 k, u32 j, Action&& action) const;
    std::size_t index(u32 i, u32 j) const { return (i * corners_.size() + j) * words_; }

    const Surface& surface_;
    const Limits& limits_;
    std::span<const HoleCorner> corners_;
    Vec3 up_;
    std::vector<Vec3> points_;
    std::size_t words_ = 0;
    std::vector<u64> left_;  ///< by chord: one bit per point, whether it is on the left
};

}  // namespace scanmill::decimating
