// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Calls of virtual-scan for its tests.

#include <numbers>

#include "virtual_scan/virtual_scan.hpp"

namespace scanmill::test {

using Shape = VirtualScanParams::Shape;
inline constexpr double pi = std::numbers::pi;

inline VirtualScanParams sphere(double resolution) {
    VirtualScanParams params;
    params.shape = Shape::sphere;
    params.resolution = resolution;
    return params;
}

inline VirtualScanResult scan(const VirtualScanParams& params, std::uint64_t seed = 0, unsigned threads = 1) {
    ContextOptions options;
    options.seed = seed;
    options.threads = threads;
    Context context(options);
    return virtual_scan(nullptr, params, context);
}

inline Vec3 normal_of(const PointCloud& cloud, std::size_t i) {
    const auto values = cloud.columns.find("normal")->values<double>();
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

}  // namespace scanmill::test
