// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One sweep answers every question about alpha: in which order do cells fall out of the solid as alpha shrinks?
///
/// out(c) is the largest value such that a path from outside the hull to cell c crosses only facets of at least that
/// value (a widest path). A cell is outside at alpha exactly when out(c) > alpha². The sweep is Prim's algorithm from
/// outside: cells come in order of descending out, so it may stop as soon as the rest is known to be solid, and never
/// looks at the facets between solid cells.

#include <limits>
#include <span>

#include "alpha_solid/facet_values.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::alpha {

struct Flood {
    /// Cells by descending out, and their out. All cells with out ≥ the last value are there.
    Array<u32> cells;
    Array<double> values;
    /// alpha_cover²: the least value at which at least `needed` points are in or on the solid.
    double cover = 0;
    /// The same for all points; not below `cover`.
    double cover_all = 0;
    /// Points that have a cell, and the share of them that was asked for, rounded up.
    std::size_t points = 0, needed = 0;

    /// Number of cells with out > value.
    std::size_t outside_above(double value) const;
    /// The first of the cells that share the out of cells[index].
    std::size_t group_begin(std::size_t index) const;
};

struct FloodLimits {
    /// The sweep goes on until it has passed below this value …
    double value = std::numeric_limits<double>::infinity();
    /// … and below alpha_cover² for this share of the points, in (0, 1].
    double coverage = 1;
};

/// How many of so many points a share of them is, rounded up; 1 at least. Pre: coverage in (0, 1].
std::size_t needed_points(double coverage, std::size_t points);

/// Every group of equal values is complete. Corners are below `points`. Cost: O(m log m) time in theory for m cells
/// swept, nearly linear in practice; 12 bytes per cell swept and 1 per cell.
Flood flood_from_outside(std::span<const SweepCell> cells, std::size_t points, const FloodLimits& limits,
                         Context& context);

}  // namespace scanmill::alpha
