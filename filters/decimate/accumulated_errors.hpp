// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Errors of a hole's triangulation, accumulated as in the paper: the error of an old triangle plus its distance to the
/// new triangle.
///
/// Old and new triangles are projected along `up`; none of them may face away from `up`. In each cell of their overlay,
/// the old and the new surface are planes, so their distance is largest at a corner of the cell. Only two kinds of
/// corners have a distance: crossings of an old inner edge with a new edge, and the removed vertex. Source: Bernardini,
/// Bajaj, Chen, Schikore 1997, section 4.

#include "decimate/hole.hpp"
#include "decimate/surface.hpp"

namespace scanmill::decimating {

/// An edge between two old triangles, which the edit removes. `triangles`: the indices of these two.
struct OldEdge {
    Vec3 from, to;
    std::array<u32, 2> triangles;
};

class AccumulatedErrors : public HoleErrors {
public:
    AccumulatedErrors(const Surface& surface, const Limits& limits) : surface_(surface), limits_(limits) {}

    /// Keeps the spans and `removed`. `up`: unit direction of the projection. `old_errors`: by old triangle.
    /// `ring_triangles`: for each corner, the old triangle at the polygon's edge from this corner to the next; any
    /// index from old_errors.size() on if that edge is new. `removed`: position of the removed vertex; null if there is
    /// none inside the hole. `line`: errors of the feature line, which apply to every triangle.
    void begin(std::span<const HoleCorner> corners, const Vec3& up, std::span<const SignedErrors> old_errors,
               std::span<const OldEdge> old_edges, std::span<const u32> ring_triangles, const Vec3* removed,
               const SignedErrors& line);
    bool add_edge(u32 i, u32 j, SignedErrors& errors) override;
    bool add_triangle(u32 i, u32 k, u32 j, const Vec3& normal, SignedErrors& errors) override;

private:
    const Surface& surface_;
    const Limits& limits_;
    std::span<const HoleCorner> corners_;
    Vec3 up_;
    std::span<const SignedErrors> old_errors_;
    std::span<const OldEdge> old_edges_;
    std::span<const u32> ring_triangles_;
    const Vec3* removed_ = nullptr;
    SignedErrors line_;
    std::vector<SignedErrors> deltas_;  ///< by old triangle
    std::vector<bool> overlaps_;
};

}  // namespace scanmill::decimating
