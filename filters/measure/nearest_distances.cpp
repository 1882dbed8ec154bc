// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/nearest_distances.hpp"

#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill::measuring {

NearestDistances nearest_distances(std::span<const Vec3> points, const TriangleTree& surface, double rounding,
                                   Context& context) {
    const Array<u32> order = spatial_order(points);
    NearestDistances result;
    result.distances.resize(points.size());
    result.triangles.resize(points.size());
    for_each_chunk(context.threads(), order.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            const NearestTriangle found = surface.nearest(points[order[i]], hint);
            const double distance = std::sqrt(found.squared_distance);
            result.distances[order[i]] = distance > rounding ? distance : 0;
            result.triangles[order[i]] = found.triangle;
            hint = found.place;
        }
    });
    return result;
}

}  // namespace scanmill::measuring
