// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Restores fixed edges that the growth did not form.

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

/// Makes fixed edges of the surface edges of its triangles, where possible, in the order of their points:
/// - An end in no triangle is joined to the surface. It is put into a triangle or replaces an edge between two
///   triangles; that with the nearest middle is tried first. The middle must be within `largest_circle` times the end's
///   search radius.
/// - Where a strip of at most eight triangles leads from one end to the other, both sides of the edge in the strip are
///   triangulated anew. Shorter strips are tried first, then those whose inner edges are nearer to the fixed edge. No
///   inner edge is a fixed edge.
/// - Where both ends are on one boundary loop, the edge divides the loop. A part of at most eight corners is closed, if
///   the enclosing radii of its triangles are at most `largest_circle` times the search radius of the ends.
/// New triangles intersect neither each other nor the surface near them, and have dihedral deviations of at most 172
/// degrees. Their pass is closing_pass.
///
/// Pre: every vertex has one fan. Post: the same. Returns the number of triangles that were replaced. Cost: linear, and
/// up to some thousand triangulations of at most ten corners per missing edge.
std::size_t restore_fixed_edges(Surface& surface, double largest_circle, const Execution& execution);

}  // namespace scanmill::growing
