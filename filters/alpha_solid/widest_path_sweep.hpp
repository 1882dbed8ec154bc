// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the order in which cells leave the solid as alpha shrinks; one sweep serves every alpha.
///
/// out(c) is the largest value such that a path from outside the hull to cell c crosses only facets of at least that
/// value (a widest path). The value of a facet is the squared alpha at which it becomes a wall. A cell is outside at
/// alpha exactly when out(c) > alpha².
///
/// The sweep is Prim's algorithm from outside: cells come in order of descending out. Therefore it can stop as soon as
/// the rest is known to be solid, and it never visits the facets between solid cells.

#include <limits>
#include <span>

#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::alpha {

/// The data of a cell that the sweep over the cells needs, in one cache line.
struct alignas(64) SweepCell {
    /// values[i] is the value of the facet opposite to corner i. Both cells of a facet store the same value.
    std::array<double, 4> values;
    Tetrahedron corners;
    std::array<u32, 4> neighbours;
};

/// The cells with the values of their facets. The value of a facet is the larger of its two cells' contributions (see
/// cell_spheres.hpp). Weights count unless all are equal. Throws Error if there are weights, but not one per vertex.
/// Cost: two parallel passes over the cells.
Array<SweepCell> sweep_cells(const TetMesh& tets, Context& context);

struct SweepResult {
    /// Cells in order of descending out, and their out. All cells whose out is at least the last value are contained.
    Array<u32> cells;
    Array<double> values;
    /// alpha_cover²: the least value at which at least `needed` points are in or on the solid.
    double cover = 0;
    /// The least value at which all points are in or on the solid; not below `cover`.
    double cover_all = 0;
    /// Number of points that have a cell, and the requested share of that number, rounded up.
    std::size_t points = 0, needed = 0;

    /// Number of cells with out > value.
    std::size_t outside_above(double value) const;
    /// Index of the first cell that has the same out as cells[index].
    std::size_t group_begin(std::size_t index) const;
};

struct SweepLimits {
    /// The sweep continues at least until it is below this value.
    double value = std::numeric_limits<double>::infinity();
    /// The sweep continues at least until it is below alpha_cover² for this share of the points, in (0, 1].
    double coverage = 1;
};

/// The number of points in the share `coverage` of `points`, rounded up; at least 1. Pre: coverage in (0, 1].
std::size_t needed_points(double coverage, std::size_t points);

/// Sweeps the cells. Every group of equal values in the result is complete. Pre: corners are below `points`. Cost: O(m
/// log m) time in theory for m swept cells, nearly linear in practice; 12 bytes per swept cell, and 1 per cell.
SweepResult sweep_from_outside(std::span<const SweepCell> cells, std::size_t points, const SweepLimits& limits,
                               Context& context);

}  // namespace scanmill::alpha
