// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Moves the points of a noisy scan onto the surface that their neighbours form.
///
/// Source: Cazals, Pouget 2005, "Estimating differential quantities using polynomial fitting of osculating jets", for
/// the jet; Alexa et al. 2003, "Computing and rendering point set surfaces", for the weights. With Method::jet the
/// result is that of CGAL's jet_smooth_point_set, with fixed ties.

#include <optional>

#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct SmoothParams {
    enum class Method {
        jet,  ///< all neighbours have the same weight
        mls   ///< near neighbours have more weight: moving least squares
    };
    Method method = Method::jet;
    /// Number of nearest other positions, from 5 to 1000; all others if there are fewer. The point itself counts in
    /// addition; its duplicates do not count.
    u32 neighbours = 24;
    /// If given, the neighbours are all other positions nearer than this, however many, and `neighbours` has no effect;
    /// above 0.
    std::optional<Length> radius;
};

struct SmoothResult {
    /// The input's rows and columns at new positions, with the column `moved` (1 × float32, a length).
    PointCloud points;
    /// Root of the mean square, and maximum, of the distances that points moved.
    double moved_rms = 0, moved_max = 0;
    /// Number of points whose neighbours do not determine a polynomial. They moved onto the plane of their neighbours.
    std::size_t flat = 0;
};

/// Fits a plane to every point and its neighbours, then a polynomial of degree two over that plane (see jet.hpp). Moves
/// the point onto the polynomial along the normal of the plane. All points use the positions of the input. Duplicates
/// move together.
///
/// Weights of Method::mls are 1 / (1 + (d / h)²)², where d is the distance to the point. With `radius`, h is half of
/// it; otherwise h is half of the distance to the farthest neighbour. Among equally near positions, the lower by x,
/// then y, then z counts as nearer. Positions at exactly `radius` are not neighbours.
///
/// A point whose neighbours do not determine a polynomial (fewer than 5, or all near one conic) moves onto the plane. A
/// point with fewer than 3 neighbours stays where it is.
///
/// An older column `moved` is replaced, with a warning. A column `normal` stays as it was, with a warning.
///
/// Throws Error for an empty cloud, a NaN or infinite coordinate, a parameter out of range, and if no point has
/// neighbours that determine a polynomial. Doubts its result if the median error of the polynomials is above a quarter
/// of the distance of the neighbours (see Jet::error). The neighbourhoods then hold no surface, or are wider than
/// details of the surface.
///
/// Deterministic: the same bytes for any number of threads and any processor; the same positions for any order of the
/// points. Cost: O(n log n) time for a fixed number of neighbours; about 100 bytes per point beside the result.
/// Metrics: `moved-rms`, `moved-max`, `flat`.
SmoothResult smooth(const PointCloud& cloud, const SmoothParams& params, Context& context);

}  // namespace scanmill
