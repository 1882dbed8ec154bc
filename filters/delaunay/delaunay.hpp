// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The Delaunay tetrahedralisation of a scan's points: the frame that alpha-solid, sculpt and cocone carve surfaces
/// from.

#include "scanmill/data/points.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct DelaunayParams {};

struct DelaunayResult {
    TetMesh tets;
    /// Input points that lie exactly on an earlier one and were merged into it.
    std::size_t duplicates = 0;
    /// Points that are no vertex of the tetrahedralisation though distinct; none without weights.
    std::size_t hidden = 0;
};

/// Tetrahedralises the distinct points so that no point lies inside the circumsphere of any cell.
///
/// Pre:  finite coordinates, at least 4 distinct points, not all within the rounding of their coordinates of one plane.
///       Throws Error that says which of these failed, with numbers. Points count as one when all three coordinates are
///       equal; the first in input order is kept with its columns.
/// Post: cells and neighbours in the canonical order of tets.hpp. Predicates are exact; where five or more points share
///       an empty sphere, ties are broken by a symbolic perturbation that depends on the coordinates alone. So the
///       cells, as sets of points, depend on neither the order of the input nor the number of threads, and the bytes
///       only on the input.
/// Cost: O(n log n) time for scanned surfaces. All threads of the budget insert from 10,000 points on, and sort the
///       cells; memory is proportional to the cells (`make bench` prints both).
/// Metrics: cells, duplicates, hidden.
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 3; the triangulation is CGAL's.
DelaunayResult delaunay(const PointCloud& cloud, const DelaunayParams& params, Context& context);

}  // namespace scanmill
