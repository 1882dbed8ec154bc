// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Circumspheres of cells and facets: their centres, their squared radii, and the radii at which the facets of a cell
/// enter the alpha-shape.
///
/// A facet enters the alpha-shape at its own circumradius, unless it is attached. It is attached if an opposite corner
/// of one of its cells lies strictly inside its smallest circumsphere. Then it enters with the smaller circumsphere of
/// its cells (Edelsbrunner, Mücke 1994). A corner lies inside exactly when the circumcentre of its cell lies beyond the
/// facet. If the circumcentres of both cells lie on one side of the facet, the cell on the other side has the smaller
/// circumsphere. So each cell alone determines whether it attaches a facet; if it does, its own radius is the facet's
/// value.
///
/// For weighted points, a sphere with centre c and squared radius r² is orthogonal to points p of weight w_p if |c -
/// p|² - w_p = r² for all of them. The largest weight is subtracted from all weights, which changes no cell. Then r² =
/// |c - p|² + (largest - w_p) is never negative. A corner attaches its facet if it has a negative power with regard to
/// the facet's smallest orthogonal sphere. Again this holds exactly when the centre of its cell's sphere lies beyond
/// the facet.
///
/// Values depend on the positions and weights of the corners alone, not on their numbers, because arithmetic starts
/// from corners sorted by coordinates. The relative error is below 1e-8. Values of thin shapes are computed exactly and
/// then rounded. A value beyond the range of double becomes the largest double. The decision which facets are attached
/// is exact.

#include <array>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill {

/// The squared circumradius of a triangle. Pre: the points are not collinear.
double squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c);

/// The centre of the sphere through the points. Its error is below 1e-8 times the radius of that sphere, plus the
/// rounding of the coordinates. Flat cells are computed exactly and then rounded. The order of the points does not
/// matter. Pre: the points are not coplanar.
Vec3 circumcentre(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// The circumcentre of each cell. Without weights, these are the vertices of the Voronoi diagram. Cost: linear.
Array<Vec3> circumcentres(const TetMesh& tets, Execution& execution);

/// The contribution of a cell to the values of its facets.
struct CellSpheres {
    /// Per corner: the squared circumradius of the facet opposite to it. If the corner attaches that facet, the squared
    /// circumradius of the cell, unless rounding made that smaller.
    std::array<double, 4> values;
    /// Bit i is set if corner i attaches the facet opposite to it. Exact.
    u8 attached;
};

/// Pre: the points are not coplanar.
CellSpheres cell_spheres(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

struct WeightedPoint {
    const Vec3* position;
    double weight;
};

/// The contribution of a cell with weighted corners. `largest` is subtracted from their weights. For facets outside the
/// mask `facets` (bit i: opposite to corner i), the facet's own sphere does not count: the value is the cell's squared
/// radius if the corner attaches the facet, else 0. Pre: the points are not coplanar; weights are finite and from 0 to
/// `largest`.
CellSpheres weighted_cell_spheres(const std::array<WeightedPoint, 4>& corners, double largest, unsigned facets = 15);

}  // namespace scanmill
