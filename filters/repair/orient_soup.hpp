// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// CGAL's orientation of polygon soups, for triangles.

#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Orients neighbours equally. Copies vertices so that every edge has at most two triangles and every vertex one fan.
/// Corners stay in their slots, except that a reversed triangle has its second and third corner swapped or its corners
/// in reverse order. Returns the original of every copy: copy i is the vertex `vertices` + i.
/// Pre: no triangle has a repeated vertex; no two triangles have the same vertices.
std::vector<u32> orient_soup(std::size_t vertices, std::vector<Triangle>& triangles);

}  // namespace scanmill
