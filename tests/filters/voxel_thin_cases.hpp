// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call voxel-thin.

#include "voxel_thin/local_bins.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::test {

inline VoxelThinParams bins_of(double size) {
    VoxelThinParams params;
    params.bin_size = size;
    return params;
}

/// The bin size derived from a tolerance in the scan's unit.
inline VoxelThinParams within(double tolerance, VoxelThinParams::Rule rule = VoxelThinParams::Rule::quantile) {
    VoxelThinParams params;
    params.tolerance = tolerance;
    params.rule = rule;
    return params;
}

inline VoxelThinResult thin(const PointCloud& cloud, const VoxelThinParams& params, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return voxel_thin(cloud, params, context);
}

template <class T>
std::span<const T> column(const VoxelThinResult& result, std::string_view name) {
    return result.points.columns.find(name)->values<T>();
}

/// The bin that a surface with this M1 + 2 M2 + M3 is thinned by.
inline double bin_for(double derivatives, double tolerance,
                      VoxelThinParams::Guarantee guarantee = VoxelThinParams::Guarantee::centres) {
    return voxel::bin_for_edge(voxel::longest_edge(derivatives, tolerance), guarantee);
}

}  // namespace scanmill::test
