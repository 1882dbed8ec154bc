// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The Delaunay tetrahedralisation of a scan's points, from which alpha-solid and sculpt extract surfaces.

#include <optional>
#include <string>

#include "scanmill/data/points.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct DelaunayParams {
    /// Absent; `spacing`; or the name of a column of squared lengths in the scan's unit.
    std::optional<std::string> weights;
    /// The weights are this times the squared local spacing, or times the column; 0 or more, with `spacing` at most 4.
    double factor = 1;
};

struct DelaunayResult {
    TetMesh tets;
    /// Input points that lie exactly on an earlier one and were merged into it.
    std::size_t duplicates = 0;
    /// Distinct points in no cell, because weights hide them: their power distance is nowhere the least. They are kept
    /// as vertices. 0 without weights.
    std::size_t hidden = 0;
};

/// Tetrahedralises the distinct points so that no point lies inside the circumsphere of any cell.
///
/// Pre:  finite coordinates, at least 4 distinct points, not all within the rounding of their coordinates of one plane.
///       Throws Error with numbers when one of these fails. Points count as one when all three coordinates are equal;
///       the first in input order is kept with its columns.
/// Post: cells and neighbours in the canonical order of tets.hpp: every cell begins with its smallest vertex and is the
///       smallest even permutation of itself, and cells ascend. Predicates are exact; where five or more points share
///       an empty sphere, as on any grid, ties are broken by a symbolic perturbation that depends on the coordinates
///       alone. So the cells, as sets of points, depend on neither the order of the input nor the number of threads,
///       and the bytes only on the input.
/// Cost: O(n log n) time for scanned surfaces. All threads of the budget insert from 10,000 points on, and sort the
///       cells. Cells inside a scanned object reach from one side to the other, so two threads do not halve the time.
///       Memory is proportional to the cells (`make bench` prints both).
/// Metrics: cells, duplicates, hidden.
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 3; the triangulation is CGAL's.
///
/// With weights the cells are those of the regular triangulation (see TetMesh::weights): distances to a point p count
/// as |x - p|² - w_p. `spacing` weighs every point with factor · s², s being the mean distance to its six nearest
/// neighbours, lowered where a neighbour would be hidden (see point_weights.hpp), so that alpha-solid's ball is small
/// where the sampling is dense. All of the above holds, with these differences: of points at one position the first is
/// kept, with the largest of their weights (a warning gives the number of positions where they differed); insertion is
/// on one thread; a warning gives the number of hidden points, and a column `hidden` (uint8, at the vertices) marks
/// them. When no point is hidden there is no such column; else an input column of that name becomes `hidden-of-points`.
/// Throws Error for a missing or unsuitable column, weights that are not numbers from 0 to 1e18, and a factor out of
/// range. A factor other than 1 without weights has no effect, with a warning.
DelaunayResult delaunay(const PointCloud& cloud, const DelaunayParams& params, Context& context);

}  // namespace scanmill
