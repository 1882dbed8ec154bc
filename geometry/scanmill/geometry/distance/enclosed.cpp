// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/enclosed.hpp"

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/distance/detail/exact_intersection.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill {

namespace {

/// A ray from a point along an axis to a side of the surface's bounding box.
struct Ray {
    int axis = 0;
    bool is_upward = true;
    double length = std::numeric_limits<double>::infinity();
};

Ray to_nearest_side(const Vec3& point, const BoundingBox& box) {
    Ray nearest;
    for (int axis = 0; axis < 3; ++axis) {
        const double up = box.high[axis] - point[axis], down = point[axis] - box.low[axis];
        if (up < nearest.length) nearest = {axis, true, up};
        if (down < nearest.length) nearest = {axis, false, down};
    }
    return nearest;
}

bool is_strictly_in(const Vec3& point, const BoundingBox& box) {
    return (point.array() > box.low.array()).all() && (point.array() < box.high.array()).all();
}

}  // namespace

Array<u8> enclosed(std::span<const Vec3> points, std::span<const Vec3> positions, std::span<const Triangle> triangles,
                   const TriangleTree& tree, Execution& execution) {
    BoundingBox box;
    for (const Triangle& triangle : triangles)
        for (const u32 vertex : triangle) box.add(positions[vertex]);
    const Array<u32> order = spatial_order(points);
    Array<u8> result(points.size(), u8(0));
    for_each_chunk(execution.threads(), order.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        Array<u32> rows;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& point = points[order[i]];
            if (!is_strictly_in(point, box)) continue;
            const Ray ray = to_nearest_side(point, box);
            BoundingBox along{point, point};
            (ray.is_upward ? along.high : along.low)[ray.axis] = (ray.is_upward ? box.high : box.low)[ray.axis];
            rows.clear();
            tree.meeting(along, rows);
            long winding = 0;
            for (const u32 row : rows) {
                const auto& [a, b, c] = triangles[row];
                winding +=
                    exact::crossing(point, ray.axis, ray.is_upward, {&positions[a], &positions[b], &positions[c]});
            }
            result[order[i]] = winding != 0;
        }
    });
    return result;
}

}  // namespace scanmill
