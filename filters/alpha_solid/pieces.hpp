// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which cells hang together: pieces of the solid, cavities in it, the points it covers.

#include <span>

#include "alpha_solid/labels.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill::alpha {

/// Keeps, of the solid cells, those of the piece (joined across facets) with the most points, of equals the one with
/// the lowest point (by x, then y, then z; then the one whose highest point is lower); labels the others `left_out`.
void keep_largest_piece(const TetMesh& tets, std::span<u8> labels);

/// Makes solid what the solid encloses: cells that are not solid and cannot be reached from outside the hull through
/// such.
void fill_cavities(const TetMesh& tets, std::span<u8> labels);

/// Per vertex 1 when it has a solid cell, else 0.
Array<u8> coverage(const TetMesh& tets, std::span<const u8> labels, unsigned threads);
std::size_t covered_points(const TetMesh& tets, std::span<const u8> labels);

}  // namespace scanmill::alpha
