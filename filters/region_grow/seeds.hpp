// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where pieces of the surface begin, and which way each begins to face.

#include <optional>

#include "region_grow/growth.hpp"

namespace scanmill::growing {

/// Grows one piece after the other until no unused place starts one: first from `start`, or else from the flattest
/// place (least roughness, then lowest number), then from the unused ones in that same order. False when `start` starts
/// nothing.
///
/// Before a further piece is begun, the unused places near the surface are turned to face as it does, and those near
/// them likewise: normals are carried over edges as over a mirror (n' is turned like n less twice its part along the
/// way from one to the other), so that they go right round corners. `groups` tells per place which pieces' facing
/// depends on each other in this way.
bool grow_all_pieces(Surface& surface, Growth& growth, std::optional<u32> start, Array<u32>& groups);

}  // namespace scanmill::growing
