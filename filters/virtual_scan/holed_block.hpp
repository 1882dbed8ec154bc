// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A block with holes drilled through it: a part whose holes are known.

#include <array>
#include <optional>

#include "virtual_scan/ray.hpp"

namespace scanmill::scan {

struct HoledBlock {
    struct Hole {
        double x, y, radius;
    };
    BoundingBox box;
    std::array<Hole, 5> holes;  ///< along z; they neither meet each other nor the block's sides
};

/// Around the origin: the large hole in the middle, the small ones at (± 0.35 x, ± 0.35 y). Throws Error when holes
/// would touch each other or the block's sides. Pre: sizes above 0.
HoledBlock holed_block(const Vec3& size, double large_radius, double small_radius);

/// The walls of the holes belong to the surface.
std::optional<Hit> first_hit(const Ray& ray, const HoledBlock& block);

}  // namespace scanmill::scan
