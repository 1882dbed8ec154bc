// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// When does each facet appear as a wall while alpha grows? All values are squared radii.
///
/// A facet enters the alpha-shape at its own circumradius, unless it is attached: unless an opposite corner of its one
/// or two cells lies strictly inside its smallest circumsphere. Then it enters with the smaller of those cells
/// (Edelsbrunner, Mücke 1994). A corner lies inside exactly when the circumcentre of its cell lies beyond the facet; of
/// two cells whose circumcentres lie on the same side of their common facet the one beyond it is the smaller. So each
/// cell alone tells whether it attaches a facet, and then its own radius is the facet's value.
///
/// Values depend on the places of the corners alone, not on their numbers: arithmetic starts from corners sorted by
/// coordinates. Relative error below 1e-8 (thin shapes are computed exactly and then rounded); which facets are
/// attached is exact.

#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::alpha {

/// What the sweep over the cells needs of one, in one cache line.
struct alignas(64) SweepCell {
    /// values[i] is that of the facet opposite to corner i; both cells of a facet have the same.
    std::array<double, 4> values;
    Tetrahedron corners;
    std::array<u32, 4> neighbours;
};

/// With weights, the values of weighted_spheres.hpp. Throws Error when there are weights, but not one per vertex.
/// Cost: two parallel passes over the cells.
Array<SweepCell> sweep_cells(const TetMesh& tets, Context& context);

/// The squared circumradius of a triangle. Pre: not collinear.
double squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c);

/// A cell's part in the values of its facets.
struct CellSpheres {
    /// Per corner the squared circumradius of the facet opposite to it; where the corner attaches that facet, the
    /// cell's, if larger (rounding may say otherwise).
    std::array<double, 4> values;
    /// Bit i: corner i attaches the facet opposite to it. Exact.
    u8 attached;
};

/// Pre: not coplanar.
CellSpheres cell_spheres(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace scanmill::alpha
