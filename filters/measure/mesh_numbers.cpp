// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/mesh_numbers.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "measure/distance_numbers.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

namespace measuring {

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    // The smallest angle is opposite the shortest edge.
    const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
    const Vec3& apex = ab <= bc && ab <= ca ? c : bc <= ca ? a : b;
    const Vec3& left = &apex == &a ? b : a;
    const Vec3& right = &apex == &c ? b : c;
    return angle_between(left - apex, right - apex);
}

}  // namespace measuring

namespace {

using namespace measuring;

struct TriangleShape {
    double area, angle, aspect, six_volumes;
    bool collinear;
};

/// `origin`: a point near the mesh. Volumes relative to it stay accurate for a mesh that is far from 0.
TriangleShape shape_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& origin) {
    const double doubled_area = (b - a).cross(c - a).norm();
    const std::array<double, 3> edges{(b - a).norm(), (c - b).norm(), (a - c).norm()};
    const double longest = std::ranges::max(edges);
    TriangleShape shape;
    shape.area = doubled_area / 2;
    shape.collinear = collinear(a, b, c);
    shape.angle = shape.collinear ? 0 : smallest_angle(a, b, c);
    shape.aspect = longest * (edges[0] + edges[1] + edges[2]) / (2 * std::numbers::sqrt3 * doubled_area);
    shape.six_volumes = (a - origin).dot((b - origin).cross(c - origin));
    return shape;
}

Array<TriangleShape> shapes_of(const TriangleMesh& mesh, unsigned threads) {
    const BoundingBox box = surface_box(mesh);
    const Vec3 origin = box.low + (box.high - box.low) / 2;
    Array<TriangleShape> shapes(mesh.triangles.size());
    for_each_chunk(threads, shapes.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const auto& [a, b, c] = mesh.triangles[row];
            shapes[row] = shape_of(mesh.positions[a], mesh.positions[b], mesh.positions[c], origin);
        }
    });
    return shapes;
}

}  // namespace

MeshNumbers mesh_numbers(const TriangleMesh& mesh, unsigned threads) {
    MeshNumbers numbers;
    numbers.topology = topology(mesh);
    if (mesh.triangles.empty()) return numbers;
    CompensatedSum area, six_volumes;
    Array<double> angles, aspects;
    for (const TriangleShape& shape : shapes_of(mesh, threads)) {
        area.add(shape.area);
        six_volumes.add(shape.six_volumes);
        numbers.collinear_triangles += shape.collinear;
        angles.push_back(shape.angle);
        if (!shape.collinear && std::isfinite(shape.aspect)) aspects.push_back(shape.aspect);
    }
    numbers.area = area.value();
    if (numbers.topology.closed) numbers.volume = six_volumes.value() / 6;
    std::ranges::sort(angles);
    numbers.least_angle = angles.front();
    numbers.angle_p5 = quantile(angles, 0.05);
    numbers.angle_p50 = quantile(angles, 0.5);
    if (aspects.empty()) return numbers;
    std::ranges::sort(aspects);
    numbers.aspect_p50 = quantile(aspects, 0.5);
    numbers.aspect_p95 = quantile(aspects, 0.95);
    numbers.largest_aspect = aspects.back();
    return numbers;
}

}  // namespace scanmill
