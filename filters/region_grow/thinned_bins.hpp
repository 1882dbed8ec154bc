// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a thinning says of its bins, in the column `bin-size` that voxel-thin makes.

#include "region_grow/samples.hpp"
#include "region_grow/search_radii.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

/// Per place the size in the column, of several rows the least; 0 where none is finite and above 0. Empty without the
/// column, and, told, when it is not one number per row.
Array<double> thinned_bins(const PointCloud& cloud, const Samples& samples, Context& context);

/// Tells when at more than half of the places points lie too dense for the bins, as `found` says: then the column is
/// about other points, or in another unit.
void tell_contradiction(std::span<const double> thinned, const SearchRadii& found, LengthUnit unit, Context& context);

}  // namespace scanmill::growing
