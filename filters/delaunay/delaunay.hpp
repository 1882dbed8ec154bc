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
    /// Absent: no weights. `spacing`: weights from the local spacing. Any other text: the name of a column of squared
    /// lengths in the scan's unit.
    std::optional<std::string> weights;
    /// Multiplies the squared local spacing, or the numbers in the column. 0 or more; at most 4 with `spacing`.
    double factor = 1;
};

struct DelaunayResult {
    TetMesh tets;
    /// Number of input points that were merged into an earlier point at exactly the same position.
    std::size_t duplicates = 0;
    /// Number of distinct points that weights hide: nowhere in space is their power distance the least, so they are in
    /// no cell. They are kept as vertices. 0 without weights.
    std::size_t hidden = 0;
};

/// Tetrahedralises the distinct points so that no point lies inside the circumsphere of any cell.
///
/// Pre:  finite coordinates; at least 4 distinct points; not all points on one plane, within the rounding of their
///       coordinates. Throws Error with numbers if one of these fails. Points are duplicates if all three coordinates
///       are equal; the first one in input order is kept with its columns.
/// Post: cells and neighbours are in the canonical order of tets.hpp. Every cell begins with its smallest vertex and is
///       the smallest even permutation of itself; the cells ascend. Predicates are exact. Five or more points can share
///       an empty sphere, as on any grid. A symbolic perturbation that depends on the coordinates alone breaks such
///       ties. So the cells, as sets of points, depend on neither the order of the input nor the number of threads. The
///       bytes depend on the input alone.
/// Cost: O(n log n) time for scanned surfaces. From 10,000 points on, all threads of the budget insert points; all
///       threads sort the cells. Two threads do not halve the time, because cells inside a scanned object reach from
///       one side to the other. Memory is proportional to the cells (`make bench` prints both).
/// Metrics: cells, duplicates, hidden.
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 3; the triangulation is CGAL's.
///
/// With weights, the cells are those of the regular triangulation (see TetMesh::weights): the distance of x to a point
/// p counts as |x - p|² - w_p. `spacing` gives every point the weight factor · s², where s is the mean distance to its
/// six nearest neighbours. The weight is lowered where a neighbour would be hidden (see point_weights.hpp). So
/// alpha-solid's ball is small where the sampling is dense.
///
/// All of the above holds with weights, except for the following:
///  - Of points at one position, the first is kept, with the largest of their weights. A warning gives the number of
///    positions where the weights differed.
///  - One thread inserts the points.
///  - If points are hidden, a warning gives their number, and a column `hidden` (uint8, at the vertices) marks them. An
///    input column of that name is renamed `hidden-of-points`.
///  - Throws Error for a missing or unsuitable column, weights that are not numbers from 0 to 1e18, and a factor out of
///    range.
/// Without weights, a factor other than 1 has no effect, with a warning.
DelaunayResult delaunay(const PointCloud& cloud, const DelaunayParams& params, Context& context);

}  // namespace scanmill
