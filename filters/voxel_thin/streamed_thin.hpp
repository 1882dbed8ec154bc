// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thinning a file of any size, in memory for what is kept.

#include "scanmill/data/point_stream.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {

/// voxel_thin() with a given bin size, of a scan that is read piece by piece and never in memory as a whole: the same
/// result, bit for bit, the same metrics and refusals. A bin size that follows from a tolerance is refused. The grid
/// begins at the bounding box's low corner, so the file is passed over once for its bounds (when the stream is opened),
/// once for the bins, and once more at the rows that are kept.
///
/// Lengths are resolved against scan.bounds(). Cost: beside the result 24 to 72 bytes per occupied bin, an eighth of a
/// byte per point, 56 bytes (72 where the grid has 2^32 bins or more) per point of 16 pieces, thus at most 76 MB, and
/// for each thread pages of the file: of a piece, or 4 MB while the kept rows are picked.
VoxelThinResult voxel_thin(const PointStream& scan, const VoxelThinParams& params, Context& context);

}  // namespace scanmill
