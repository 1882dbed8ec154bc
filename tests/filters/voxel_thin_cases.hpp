// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call voxel-thin.

#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::test {

inline VoxelThinParams bins_of(double size) {
    VoxelThinParams params;
    params.bin_size = size;
    return params;
}

inline VoxelThinResult thin(const PointCloud& cloud, const VoxelThinParams& params, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return voxel_thin(cloud, params, context);
}

}  // namespace scanmill::test
