// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Vertices where the border passes more than once: several fans of triangles that meet in nothing but the vertex.

#include "region_grow/surface.hpp"

namespace scanmill::growing {

/// Removes triangles until the triangles of every vertex form one fan, open or closed: of several the one of most
/// triangles stays, of equal ones that of the lowest vertex. How many were removed. Cost: linear.
std::size_t remove_pinches(Surface& surface);

}  // namespace scanmill::growing
