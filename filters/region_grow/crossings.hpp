// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a new triangle would pass through what is there, decided in space.
///
/// Growth decides in the plane that the surface faces along, which is cheap and right where the surface is near a
/// plane. Where it is not, at tips and folds, only space tells.

#include <span>
#include <vector>

#include "region_grow/surface.hpp"

namespace scanmill::growing {

/// Whether the triangles have a point in common beyond their common corners and edge: a corner of one on the other, and
/// one folded flat onto the other, count. Exact for the coordinates as they are. Triangles without area meet nothing.
bool meet(std::span<const Vec3> positions, const Triangle& one, const Triangle& other);

/// The surface's triangles round somewhere, gathered once.
class NearTriangles {
public:
    /// All that may meet a filling between these corners.
    void gather_round(const Surface& surface, std::span<const u32> corners);
    /// Those at the triangle's corners and at the nearest places of each.
    void gather_near(const Surface& surface, const Triangle& triangle);
    /// Whether the triangle meets one of those gathered, another than itself.
    bool meet(const Surface& surface, const Triangle& triangle) const;

private:
    struct Boxed {
        Triangle corners;
        Vec3 low, high;
    };
    void gather_at_places(const Surface& surface);
    void add(const Surface& surface, const Triangle& triangle);

    std::vector<Boxed> triangles_;
    std::vector<u32> places_;
    NeighbourBuffer buffer_;
};

}  // namespace scanmill::growing
