// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How large a bin may be where: from a tolerance, through the curvature of the scan's surface.
///
/// Over a triangle whose edges are at most Ω long, a surface with principal curvatures k1 and k2 departs from the
/// triangle by at most Ω²/8 (|k1| + |k2|): the height over a chord is that of k1 and k2 over its two components, each
/// at most Ω long. That is Wang's M1 + 2 M2 + M3 (equation 3.2) in the directions where M2 vanishes and the sum is
/// least.

#include "scanmill/geometry/fit/local_surface.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::voxel {

/// The edge that `tolerance` allows where the derivatives M1 + 2 M2 + M3 have this sum: equation 3.6; infinite for 0.
double longest_edge(double derivatives, double tolerance);

/// The bin that allows edges of this length. In bins that touch at a corner the centres are √3 bins apart, the points
/// at most 2 √3.
double bin_for_edge(double edge, VoxelThinParams::Guarantee guarantee);

/// M1 + 2 M2 + M3 of a surface with these curvatures; the thesis takes the coefficients a, c of a u² + b u v + c v² for
/// its second derivatives, which are twice as large.
double derivatives_of(const LocalSurface& surface, VoxelThinParams::Derivatives derivatives);

struct LocalBins {
    /// Per row of the input, the number of its place; per place what is there.
    Array<u32> place_of_row;
    Array<LocalSurface> surfaces;
    /// The bin size that each place allows, between `least` and `largest`: a bin in which the two nearest places cannot
    /// both lie (or what a grid can number), and a tenth of the box's longest edge. `largest` where nothing is known.
    Array<double> sizes;
    double least = 0, largest = 0;
    /// By the rule; of the adaptive one the size that the quantile gives.
    double chosen = 0;
    /// Places that show no surface (they took no part in the choice), and such as are so flat that `largest` counts.
    std::size_t undetermined = 0, flat = 0;
};

/// Throws Error for a tolerance not above 0 or not below the diagonal, a quantile outside of [0, 1], fewer than 6
/// neighbours or more than 1000 asked for, fewer distinct places than neighbours + 1, and when no place shows a
/// surface. `box` bounds the positions, which are finite.
LocalBins local_bins(std::span<const Vec3> positions, const BoundingBox& box, const VoxelThinParams& params,
                     Context& context);

}  // namespace scanmill::voxel
