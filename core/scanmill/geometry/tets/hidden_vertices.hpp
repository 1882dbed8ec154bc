// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Points that weights hide: vertices of a tetrahedralisation that are in none of its cells.

#include "scanmill/data/tets.hpp"

namespace scanmill {

/// Ascending; none in what delaunay() makes without weights. Cost: linear.
Array<u32> hidden_vertices(const TetMesh& tets);

}  // namespace scanmill
