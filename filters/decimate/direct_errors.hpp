// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Errors of a hole's triangulation, measured to the original surface and the data points.
///
/// Every new edge has a path on the original surface. Every point lies on one side of each path. The paths cut the
/// original surface into one region per new triangle.
///
/// A region consists of original triangles and parts of original triangles. Their corners are points of the region,
/// which are near the new triangle, or points of the paths, which are near its edges. The distance to a convex set is
/// convex, so no other point of the region is farther from the new triangle. The boundary of the region follows the
/// edges of the new triangle. So each point of the new triangle has a point of the region within the same distance.

#include "decimate/hole.hpp"
#include "decimate/surface.hpp"

namespace scanmill::decimating {

class DirectErrors : public HoleErrors {
public:
    DirectErrors(const Surface& surface, const Limits& limits) : surface_(surface), limits_(limits) {}

    /// `points`: numbers of the points that the old triangles of the hole represent. Pre: `up` is a unit vector.
    void begin(std::span<const HoleCorner> corners, const Vec3& up, std::span<const u32> points);
    bool add_edge(u32 i, u32 j, SignedErrors& errors) override;
    bool add_triangle(u32 i, u32 k, u32 j, const Vec3& normal, SignedErrors& errors) override;
    /// Appends to `owners` the triangle of every point; triangles are numbered from `first` on. Adds the distance of
    /// each point to its triangle, which may exceed its distance to the triangle's plane. Returns false if an error
    /// exceeds its limit.
    bool assign(std::vector<HoleTriangle>& triangles, u32 first, std::vector<u32>& owners) const;

private:
    /// Calls action(p) for every point p that the triangle (i, k, j) represents.
    template <class Action>
    void for_each_point(u32 i, u32 k, u32 j, Action&& action) const;
    std::size_t index(u32 i, u32 j) const { return (i * corners_.size() + j) * words_; }

    const Surface& surface_;
    const Limits& limits_;
    std::span<const HoleCorner> corners_;
    Vec3 up_;
    std::vector<Vec3> points_;
    std::size_t words_ = 0;
    std::vector<u64> left_;  ///< by chord (i, j): one bit per point, 1 if the point is on its left
};

}  // namespace scanmill::decimating
