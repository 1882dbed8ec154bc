// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How far a triangle may reach, where nobody said it: from the bins that the places were thinned with, or from how
/// dense they are.

#include "region_grow/distinct_points.hpp"
#include "region_grow/surface.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

struct SearchRadii {
    /// Per place 2 √3 B.
    Array<double> radii;
    /// Per place what the density alone makes of it.
    Array<double> by_density;
    /// Places whose B follows from the thinning.
    std::size_t known = 0;
    /// Per place the B that the density tells where points lie too dense for the bin that they were said to be from;
    /// 0 elsewhere. Empty where nothing was said.
    Array<double> too_dense;
};

/// Thinning keeps one point in every cube of edge B, and a surface meets about 1.5 cubes per B², so its 12th neighbour
/// is at about 1.6 B: the distance tells B. At the surface's rim, where half of the neighbours are missing, it would
/// be 1.4 times too large; so it counts at most 1.15 times the median of the neighbours'. This is B where nothing else
/// is known.
///
/// `thinned`: per place the bin that it was kept from, finite, 0 where nobody knows; or empty. This is B, up to 1.15
/// times the median of the neighbours' (scans thinned with different bins may lie over each other, and the finer one
/// tells what is a hole), where the density agrees. Cubes stand along the axes then, and a surface of normal n meets
/// |n_x| + |n_y| + |n_z| of them per B²: 1 along them, √3 at most. The median of what that makes of the neighbours'
/// densities is 0.95 to 1.15 of the bin where the scan was dense (at rims and corners, too), down to 0.6 of it where
/// the scan was noisy or lies there twice, less where more thinned scans were merged. From 0.55 to 1.15 they agree.
/// Where points are sparser the scan itself was, or some were lost; where they are denser the bins are not theirs. At
/// rough places, tips and edges, points of bins that touch lie round a corner and the empty circles are larger than on
/// a face; there B is no less than the density tells. Cost: linear.
SearchRadii automatic_radii(const Samples& samples, const Neighbourhoods& neighbourhoods, std::span<const Vec3> normals,
                            std::span<const float> roughness, std::span<const double> thinned, unsigned threads);

/// The bin size whose thinning would leave points as dense as they are at the middle place.
double bins_as_dense(const Surface& surface, unsigned threads);

// What a thinning says of its bins, in the column `bin-size` that voxel-thin makes.

/// Per place the size in the column, of several rows the least; 0 where none is finite and above 0. Empty without the
/// column, and, told, when it is not one number per row.
Array<double> thinned_bins(const PointCloud& cloud, const Samples& samples, Context& context);

/// Tells when at more than half of the places points lie too dense for the bins, as `found` says: then the column is
/// about other points, or in another unit.
void tell_contradiction(std::span<const double> thinned, const SearchRadii& found, LengthUnit unit, Context& context);

}  // namespace scanmill::growing
