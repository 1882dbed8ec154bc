// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call crop.

#include <initializer_list>

#include "crop/crop.hpp"

namespace scanmill::test {

inline CropParams in_box(const Vec3& low, const Vec3& high) {
    CropParams params;
    params.box = {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()};
    return params;
}

inline CropParams in_ball(const Vec3& centre, double radius) {
    CropParams params;
    params.centre = {centre.x(), centre.y(), centre.z()};
    params.radius = radius;
    return params;
}

inline CropParams in_reach(double within) {
    CropParams params;
    params.within = within;
    return params;
}

struct Cropped : CropResult {
    Metrics metrics;
};

/// `near`: nothing, a cloud or a mesh.
template <class... Near>
Cropped cropped(const PointCloud& cloud, const CropParams& params, unsigned threads, const Near&... near) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    CropResult result = crop(cloud, near..., params, context);
    return {std::move(result), context.metrics()};
}

inline Cropped cropped(const PointCloud& cloud, const CropParams& params) { return cropped(cloud, params, 1); }

inline std::vector<u32> rows(const CropResult& result) { return {result.kept.begin(), result.kept.end()}; }

}  // namespace scanmill::test
