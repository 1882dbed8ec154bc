// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Errors of a hole's triangulation as the paper accumulates them: the errors of the old triangles, and the distance
/// between the old and the new ones.
///
/// Old and new triangles are projected along `up`, so none of them may face away from it. Over each cell of their
/// overlay both are planes, so their distance is largest at a corner of a cell: where an old inner edge crosses a new
/// edge, or at the removed vertex. Source: Bernardini, Bajaj, Chen, Schikore 1997, section 4.

#include "decimate/hole.hpp"
#include "decimate/surface.hpp"

namespace scanmill::decimating {

/// An edge that the edit removes, with the old triangles on both sides by their index; equal on the boundary of the
/// hole's side.
struct OldEdge {
    Vec3 from, to;
    std::array<u32, 2> triangles;
};

class AccumulatedErrors : public HoleErrors {
public:
    AccumulatedErrors(const Surface& surface, const Limits& limits) : surface_(surface), limits_(limits) {}

    /// `old_errors` by old triangle; `old_edges` the removed ones; `ring_triangles`: of every corner the old triangle
    /// at the polygon's edge from it to the next corner (any beyond the number of old triangles if that edge is new).
    /// `removed`: the removed vertex, if it is inside. `line`: errors of the feature line, which all triangles get.
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
