// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Computes the voxel size that the tolerance allows at every point, from the curvature of the scanned surface.
///
/// Over a triangle with edges of at most Ω, a surface with principal curvatures k1 and k2 departs from the triangle by
/// at most Ω²/8 (|k1| + |k2|). The height over a chord is the sum of the heights that k1 and k2 give over its two
/// components, each at most Ω long. The bound is Wang's M1 + 2 M2 + M3 (equation 3.2) in the principal directions,
/// where M2 is 0 and the sum is smallest.

#include "scanmill/geometry/fit/local_surface.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::voxel {

/// The longest edge that `tolerance` allows if M1 + 2 M2 + M3 is `derivatives`: equation 3.6; infinite for 0.
double longest_edge(double derivatives, double tolerance);

/// The voxel size that keeps edges within `edge`. If voxels share a corner, their centres are √3 voxel edges apart, and
/// their points at most 2 √3.
double size_for_edge(double edge, VoxelThinParams::Guarantee guarantee);

/// M1 + 2 M2 + M3 of a surface with these curvatures. The thesis uses the coefficients a, c of a u² + b u v + c v² as
/// second derivatives; the true ones are twice as large.
double derivatives_of(const LocalSurface& surface, VoxelThinParams::Derivatives derivatives);

struct LocalSizes {
    /// Per row of the input the index of its distinct point; per distinct point its surface.
    Array<u32> point_of_row;
    Array<LocalSurface> surfaces;
    /// The voxel size that each distinct point allows, between `least` and `largest`. `least` is a voxel that cannot
    /// hold both of the two closest points (or the smallest that a grid supports). `largest` is a tenth of the robust
    /// box's longest side. It is also the size of points whose surface is not determined.
    Array<double> sizes;
    double least = 0, largest = 0;
    /// The size that the rule chooses. With the adaptive rule, it is the size of the basic voxels, which the quantile
    /// chooses.
    double chosen = 0;
    /// Number of points whose neighbours determine no surface (ignored in the choice), and number of points so flat
    /// that they allow `largest`.
    std::size_t undetermined = 0, flat = 0;
};

/// Throws Error for a tolerance not above 0 or not below the diagonal, a quantile outside of [0, 1], fewer than 6 or
/// more than 1000 neighbours, fewer distinct points than neighbours + 1, and if no point determines a surface. Stray
/// points do not affect the choice. Pre: the positions are finite, and `box` is theirs.
LocalSizes local_sizes(std::span<const Vec3> positions, const RobustBox& box, const VoxelThinParams& params,
                       Context& context);

}  // namespace scanmill::voxel
