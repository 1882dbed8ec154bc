// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closing what growth left open where it should not have: loops of a few edges.

#include "region_grow/surface.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

/// The pass of triangles that close a hole.
inline constexpr Pass closing_pass = 4;

/// Fills every loop of at most `most_edges` border edges with the triangles of least total area, unless one would fold
/// back on a joined triangle by more than 150 degrees (so a lone triangle keeps its rim), repeat an edge, or pass
/// through others. Where several fans meet in a vertex a loop goes on to the next one round it. How many loops were
/// filled. Cost: linear in the triangles, most_edges² per border edge, and most_edges³ per loop, which is solved once
/// whether it can be filled or not.
std::size_t close_small_holes(Surface& surface, std::size_t most_edges, const Context& context);

}  // namespace scanmill::growing
