// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What cell_spheres() is without weights: when the facets of a cell become walls, for weighted points.
///
/// A point p of weight w acts like a ball: the smallest sphere orthogonal to weighted points is the smallest (c, r²)
/// with |c - p|² - w_p = r² for all of them. Weights are lowered by the largest of all, which changes no cell, so that
/// r² = |c - p|² + (largest - w_p) is never negative: r is alpha where the sampling is coarsest, and a finer place with
/// weight w lets a ball of radius sqrt(r² - (largest - w)) through.
///
/// As without weights, a corner attaches the facet opposite to it (has a negative power with regard to the facet's
/// sphere) exactly when the centre of its cell's sphere lies beyond the facet; so the rule in facet_values.hpp holds.

#include "alpha_solid/facet_values.hpp"

namespace scanmill::alpha {

struct WeightedPoint {
    const Vec3* position;
    double weight;
};

/// Pre: not coplanar; weights finite, from 0 to `largest`. Values as in CellSpheres, squared radii with weights lowered
/// by `largest`; relative error below 1e-8. Attachment is exact. Neither depends on the order of the corners.
/// Facets that are not in the mask `facets` (bit i: opposite to corner i) have the cell's part alone: its own squared
/// radius where the corner attaches them, else 0.
CellSpheres weighted_cell_spheres(const std::array<WeightedPoint, 4>& corners, double largest, unsigned facets = 15);

}  // namespace scanmill::alpha
