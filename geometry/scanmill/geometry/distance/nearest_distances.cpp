// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/nearest_distances.hpp"

#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill {

NearestDistances nearest_distances(std::span<const Vec3> points, const TriangleTree& surface, double rounding,
                                   Execution& execution) {
    const Array<u32> order = spatial_order(points);
    NearestDistances result;
    result.distances.resize(points.size());
    result.triangles.resize(points.size());
    result.slots.resize(points.size());
    for_each_chunk(execution.threads(), order.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            const NearestTriangle found = surface.nearest(points[order[i]], hint);
            const double distance = std::sqrt(found.squared_distance);
            result.distances[order[i]] = distance > rounding ? distance : 0;
            result.triangles[order[i]] = found.triangle;
            result.slots[order[i]] = hint = found.slot;
        }
    });
    return result;
}

NearestDistances nearest_of_vertices(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                     const TriangleTree& surface, double rounding, Execution& execution) {
    Array<u8> is_used(positions.size(), u8(0));
    for (const Triangle& triangle : triangles)
        for (const u32 vertex : triangle) is_used[vertex] = 1;
    Array<u32> vertices;
    Array<Vec3> used;
    for (u32 vertex = 0; vertex < positions.size(); ++vertex)
        if (is_used[vertex]) {
            vertices.push_back(vertex);
            used.push_back(positions[vertex]);
        }
    NearestDistances found = nearest_distances(used, surface, rounding, execution);
    if (used.size() == positions.size()) return found;
    NearestDistances result{Array<double>(positions.size(), 0.0), Array<u32>(positions.size(), NearestTriangle::none),
                            Array<u32>(positions.size(), NearestTriangle::none)};
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        result.distances[vertices[i]] = found.distances[i];
        result.triangles[vertices[i]] = found.triangles[i];
        result.slots[vertices[i]] = found.slots[i];
    }
    return result;
}

}  // namespace scanmill
