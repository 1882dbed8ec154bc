// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// When does each facet appear as a wall while alpha grows? All values are squared radii.
///
/// A facet enters the alpha-shape at its own circumradius, unless it is attached: unless an opposite corner of its one
/// or two cells lies strictly inside its smallest circumsphere. Then it enters with the smaller of those cells
/// (Edelsbrunner, Mücke 1994). A corner lies inside exactly when the circumcentre of its cell lies beyond the facet, so
/// one look at a cell decides all four of its facets.
///
/// Values depend on the places of the corners alone, not on their numbers: arithmetic starts from corners sorted by
/// coordinates. Relative error below 1e-8 (thin shapes are computed exactly and then rounded); the attached test is exact.

#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::alpha {

/// #cells: [c][i] is the value of the facet opposite to corner i of cell c; both cells of a facet have the same.
using FacetValues = Array<std::array<double, 4>>;

/// Cost: two parallel passes over the cells; 32 bytes per cell for the result, 9 while it works.
FacetValues facet_values(const TetMesh& tets, Context& context);

/// The squared circumradius of a triangle. Pre: not collinear.
double squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c);

struct Circumsphere {
    double squared_radius;
    /// Bit i: corner i lies strictly inside the smallest sphere round the facet opposite to it. Exact.
    u8 attached;
};

/// Pre: not coplanar.
Circumsphere circumsphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace scanmill::alpha
