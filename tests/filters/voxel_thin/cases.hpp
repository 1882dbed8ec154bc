// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers to call voxel-thin.

#include "voxel_thin/local_sizes.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::test {

/// Voxels of this edge.
inline VoxelThinParams voxels_of(double size) {
    VoxelThinParams params;
    params.bin_size = size;
    return params;
}

/// A voxel size derived from a tolerance in the scan's unit.
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

/// The voxel size that a surface with this M1 + 2 M2 + M3 allows.
inline double size_for(double derivatives, double tolerance,
                       VoxelThinParams::Guarantee guarantee = VoxelThinParams::Guarantee::centres) {
    return voxel::size_for_edge(voxel::longest_edge(derivatives, tolerance), guarantee);
}

}  // namespace scanmill::test
