// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Labels cells inside or outside by a surface that may have holes.

#include "cocone/surface.hpp"

namespace scanmill::cocones {

struct Peeling {
    /// By cell: 1 inside, 0 outside. Every outside cell is reached from outside the hull through outside cells.
    Array<u8> labels;
    std::size_t good = 0;
    /// Components of good points that the outside does not reach.
    std::size_t enclosed = 0;
};

/// Labels the cells around most points by the surface, beginning at the hull. Then the outside spreads from the hull
/// from cell to cell: into cells that the surface labels outside, and into a cell whose four points are all poor unless
/// it comes through the cell's smallest facet (by circumradius). A point is good if its triangles form exactly one
/// closed fan, and no two of them meet at an edge of the point with a cosine between their normals of -0.9 or less (of
/// less than 0 at a point that is not flat).
///
/// Good points that triangles connect are labelled together, by the first cell at one of them that the outside reaches:
/// this cell is outside. Where the inside is known from elsewhere, `inside` lists cells of it, each with its corner
/// opposite to a facet of the surface; then the first of them at the component decides. If the good points of a cell
/// disagree, most of them decide, and on a tie the cell is inside. Face-connected parts of the solid without a good
/// point are dropped, unless no point is good. Cost: linear.
Peeling peel(const Diagram& diagram, const Surface& surface, const SurfaceMesh& mesh, std::span<const u8> flat,
             Context& context, std::span<const Side> inside = {});

}  // namespace scanmill::cocones
