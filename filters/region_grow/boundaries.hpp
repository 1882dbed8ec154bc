// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Boundaries where the surface may continue: at parts too thin for the points' spacing, and at seams of given normals.

#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/growing/components.hpp"

namespace scanmill::growing {

/// Sheets nearer than this many voxels may be taken for one.
inline constexpr double thin_in_voxels = 3;

struct ThinParts {
    /// Loops with a point whose opposite sheet is nearer than `thin_in_voxels` voxels: the surface may continue there.
    std::size_t loops = 0;
    /// The smallest such distance, and the voxel size there.
    double least = 0, voxel = 0;
};

/// Finds loops at thin parts. The opposite sheet of a boundary point is the nearest surface point that meets two
/// conditions. Its normal differs by more than 120 degrees, and it lies across the surface rather than beside the
/// point. Beyond a sharp fold, it may be near along the surface, too. The relative orientation of two components is not
/// known, so between components equal normals count as well. The voxel size follows from the search radius; ties: the
/// smaller one. If given normals have signs that count, no loop is counted.
///
/// Pre: every vertex has one fan; search radii follow from voxel sizes. Cost: a radius search per boundary point.
ThinParts find_thin_parts(const Surface& surface, const Components& components, const Context& context);

/// Counts the boundary points beside a boundary point with an opposed normal in the same plane. The surface ends there
/// only because of the given normals. Returns 0 if nearly all opposed neighbours are behind, or nearly all in front.
/// Pre: the signs of the normals count. Cost: linear.
std::size_t points_at_seams(const Surface& surface);

}  // namespace scanmill::growing
