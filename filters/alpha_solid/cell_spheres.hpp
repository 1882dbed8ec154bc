// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The radii at which the facets of one cell become walls while alpha grows. All values are squared radii.
///
/// A facet enters the alpha-shape at its own circumradius, unless it is attached: unless an opposite corner of its one
/// or two cells lies strictly inside its smallest circumsphere. Then it enters with the smaller of those cells
/// (Edelsbrunner, Mücke 1994). A corner lies inside exactly when the circumcentre of its cell lies beyond the facet. Of
/// two cells whose circumcentres lie on the same side of their common facet, the one beyond it is the smaller. So each
/// cell alone determines whether it attaches a facet, and then its own radius is the facet's value.
///
/// Weighted points: the smallest sphere orthogonal to points p of weight w_p is the smallest (c, r²) with
/// |c - p|² - w_p = r² for all of them. All weights are lowered by the largest one, which changes no cell, so that
/// r² = |c - p|² + (largest - w_p) is never negative. A corner attaches its facet when it has a negative power to the
/// facet's sphere; that again holds exactly when the centre of its cell's sphere lies beyond the facet.
///
/// Values depend on the positions and weights of the corners alone, not on their numbers: arithmetic starts from
/// corners sorted by coordinates. Relative error below 1e-8 (thin shapes are computed exactly and then rounded; a value
/// beyond the range of double becomes the largest double). Which facets are attached is exact.

#include <array>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill::alpha {

/// The squared circumradius of a triangle. Pre: not collinear.
double squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c);

/// The contribution of a cell to the values of its facets.
struct CellSpheres {
    /// Per corner the squared circumradius of the facet opposite to it; where the corner attaches that facet, the
    /// cell's, if that is larger (rounding can make it smaller).
    std::array<double, 4> values;
    /// Bit i: corner i attaches the facet opposite to it. Exact.
    u8 attached;
};

/// Pre: not coplanar.
CellSpheres cell_spheres(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

struct WeightedPoint {
    const Vec3* position;
    double weight;
};

/// The same for weighted points. Pre: not coplanar; weights finite, from 0 to `largest`, by which they are lowered.
/// Facets outside the mask `facets` (bit i: opposite to corner i) get the cell's contribution alone: the cell's squared
/// radius where the corner attaches them, else 0.
CellSpheres weighted_cell_spheres(const std::array<WeightedPoint, 4>& corners, double largest, unsigned facets = 15);

}  // namespace scanmill::alpha
