// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Computes the default search radius of every point, from the voxels that the points were thinned with or from their
/// density.
///
/// Thinning keeps one point per voxel of edge B. A surface meets about 1.5 voxels per B². So the 12th neighbour of a
/// point is about 1.6 B away, and its distance gives an estimate of B. At the boundary of the surface, where half of
/// the neighbours are missing, the estimate is 1.4 times too large. It is therefore limited to 1.15 times the median of
/// the neighbours' estimates.
///
/// The column `bin-size` gives B itself. It is used where the density agrees, up to 1.15 times the median of the
/// neighbours' sizes. Scans thinned with different voxels may overlap, and the finer scan decides what is a hole.
/// Voxels are aligned with the axes, so a surface of normal n meets |n_x| + |n_y| + |n_z| of them per B², 1 to √3. With
/// this number, the median of the neighbours' estimates is 0.95 to 1.15 of B where the scan was dense, also at
/// boundaries and corners. It is down to 0.6 where the scan was noisy or overlaps another one, and less where more
/// thinned scans were merged. The column is used where this ratio is 0.55 to 1.15. Where points are sparser, the
/// scan itself was sparse, or points were lost. Where they are denser, the column does not describe them.
///
/// At tips and edges, the points of adjacent voxels lie on two sides, and empty circles are larger than on a face.
/// There, B is at least the estimate from the density.

#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

/// Ratio of the search radius to the voxel size: 2 √3, the largest distance between points in adjacent voxels.
inline constexpr double radius_in_voxels = 3.4641016151377544;

struct SearchRadii {
    /// Per point 2 √3 B.
    Array<double> radii;
    /// Per point the radius that follows from the density alone.
    Array<double> by_density;
    /// Number of points whose B is from the column.
    std::size_t known = 0;
    /// Per point the B that the density gives, where the points are too dense for the column; 0 elsewhere. Empty
    /// without a column.
    Array<double> too_dense;
};

/// Per point the spacing of a square grid that is as dense as the points around it: the estimate of the file comment.
/// Cost: linear. Pre: at least two points.
Array<double> local_spacings(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, unsigned threads);

/// `given_sizes`: per point the size in the column, finite, 0 if unknown; or empty. Cost: linear.
SearchRadii automatic_radii(const DistinctPoints& points, const Neighbourhoods& neighbourhoods,
                            std::span<const Vec3> normals, std::span<const float> variation,
                            std::span<const double> given_sizes, unsigned threads);

/// The voxel size whose thinning would leave points with the present median density.
double equivalent_voxel_size(const Surface& surface, unsigned threads);

/// Per point the size in the column `bin-size`, the smallest of its rows; 0 if none is finite and above 0. Empty
/// without the column. Also empty, with a warning, if the column is not one number per row.
Array<double> given_voxel_sizes(const PointCloud& cloud, const DistinctPoints& points, Context& context);

/// Warns if more than half of the points are too dense for the column. The column then describes other points, or has
/// another unit.
void warn_of_contradiction(std::span<const double> given_sizes, const SearchRadii& found, LengthUnit unit,
                           Context& context);

}  // namespace scanmill::growing
