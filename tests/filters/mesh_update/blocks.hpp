// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A block with pads and pockets, and clouds on their surfaces, whose volumes are known in closed form.

#include <memory>
#include <vector>

#include "mesh_update/mesh_update.hpp"

namespace scanmill::test {

/// [0, x] × [0, y] × [0, z]: 8 vertices, 12 triangles.
inline TriangleMesh block(double x = 60, double y = 40, double z = 20) {
    TriangleMesh mesh;
    Array<Vec3> positions;
    for (int i = 0; i < 8; ++i)
        positions.emplace_back((i & 1) != 0 ? x : 0, (i & 2) != 0 ? y : 0, (i & 4) != 0 ? z : 0);
    mesh.positions = std::move(positions);
    mesh.triangles = Array<Triangle>{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// A rectangle parallel to the axes, [low, high] in the plane z = level.
struct Rectangle {
    double x0, y0, x1, y1;
};

/// Points of a grid with this spacing on the plane z = `level` around `step`, `border` wide; on the walls of `step`
/// from `level` to `level + height`; and on its top or bottom at `level + height`. A pad for a positive height, a
/// pocket for a negative one. The sides of the rectangle and the height are multiples of the spacing.
inline std::shared_ptr<const PointCloud> step_cloud(const Rectangle& step, double level, double height, double border,
                                                    double spacing) {
    Array<Vec3> points;
    const auto steps = [&](double length) { return static_cast<int>(length / spacing + 0.5); };
    const int across = steps(step.x1 - step.x0), along = steps(step.y1 - step.y0), ring = steps(border),
              up = steps(height > 0 ? height : -height);
    for (int i = -ring; i <= across + ring; ++i)
        for (int j = -ring; j <= along + ring; ++j) {
            const bool is_inside = i >= 0 && i <= across && j >= 0 && j <= along;
            const bool is_border = i == 0 || i == across || j == 0 || j == along;
            const Vec3 base(step.x0 + i * spacing, step.y0 + j * spacing, level);
            if (!is_inside || is_border) points.push_back(base);
            if (is_inside && height != 0) points.push_back(base + Vec3(0, 0, height));
            if (is_inside && height == 0 && !is_border) points.push_back(base);
            if (is_inside && is_border)
                for (int k = 1; k < up; ++k)
                    points.push_back(base + Vec3(0, 0, height > 0 ? k * spacing : -k * spacing));
        }
    PointCloud cloud;
    cloud.positions = std::move(points);
    return std::make_shared<const PointCloud>(std::move(cloud));
}

}  // namespace scanmill::test
