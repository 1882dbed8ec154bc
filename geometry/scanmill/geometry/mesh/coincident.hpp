// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Vertices and edges at one position.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// For each vertex, the lowest vertex with exactly the same position. Pre: no NaN. Cost: O(n).
Array<u32> lowest_at_position(std::span<const Vec3> positions);

/// The half-edges in `boundary` whose two end positions are also the end positions of another half-edge in `boundary`.
/// The surface is cut there. The result has the order of `boundary`. Cost: O(n log n).
std::vector<u32> coincident_edges(const TriangleMesh& mesh, std::span<const u32> boundary);

}  // namespace scanmill
