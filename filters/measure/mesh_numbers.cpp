// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/mesh_numbers.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "measure/distance_numbers.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

namespace measuring {

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    // Opposite the shortest edge.
    const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
    const Vec3& apex = ab <= bc && ab <= ca ? c : bc <= ca ? a : b;
    const Vec3& left = &apex == &a ? b : a;
    const Vec3& right = &apex == &c ? b : c;
    return angle_between(left - apex, right - apex);
}

}  // namespace measuring

namespace {

using namespace measuring;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 exact_point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

struct TriangleShape {
    double area, angle, aspect, six_volumes;
    bool collinear;
};

/// `origin` is near the mesh, so that volumes far from 0 are not differences of large numbers.
TriangleShape shape_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& origin) {
    const double doubled_area = (b - a).cross(c - a).norm();
    const std::array<double, 3> edges{(b - a).norm(), (c - b).norm(), (a - c).norm()};
    const double longest = std::ranges::max(edges);
    TriangleShape shape;
    shape.area = doubled_area / 2;
    shape.collinear = CGAL::collinear(exact_point(a), exact_point(b), exact_point(c));
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

/// For every vertex the smallest row among those at its position.
Array<u32> merged_vertices(std::span<const Vec3> positions) {
    Array<u32> order(positions.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, [&](u32 a, u32 b) {
        for (int axis = 0; axis < 3; ++axis)
            if (positions[a][axis] != positions[b][axis]) return positions[a][axis] < positions[b][axis];
        return a < b;
    });
    Array<u32> merged(positions.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        merged[order[i]] = i > 0 && positions[order[i]] == positions[order[i - 1]] ? merged[order[i - 1]] : order[i];
    return merged;
}

class PairTest {
public:
    explicit PairTest(const TriangleMesh& mesh) : mesh_(mesh), vertices_(merged_vertices(mesh.positions.span())) {}

    bool is_collinear(u32 row) const {
        const Triangle corners = merged(row);
        return CGAL::collinear(point(corners[0]), point(corners[1]), point(corners[2]));
    }

    /// Pre: neither is collinear.
    bool meet(u32 row, u32 other_row) const {
        Triangle one = merged(row), other = merged(other_row);
        switch (bring_common_first(one, other)) {
            case 0: return CGAL::do_intersect(triangle(one), triangle(other));
            case 1:
                // Any other common point implies one on the edge opposite to the common vertex.
                return CGAL::do_intersect(triangle(one), segment(other[1], other[2])) ||
                       CGAL::do_intersect(triangle(other), segment(one[1], one[2]));
            case 2: return folded(one, other);
            default: return true;  // the same triangle twice
        }
    }

private:
    Triangle merged(u32 row) const {
        const Triangle& corners = mesh_.triangles[row];
        return {vertices_[corners[0]], vertices_[corners[1]], vertices_[corners[2]]};
    }

    /// Reorders both so that their common vertices lead, in the same order; returns how many there are.
    static std::size_t bring_common_first(Triangle& one, Triangle& other) {
        std::size_t common = 0;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = common; j < 3; ++j)
                if (one[i] == other[j]) {
                    std::swap(one[common], one[i]);
                    std::swap(other[common], other[j]);
                    ++common;
                    break;
                }
        return common;
    }

    /// Triangles that share the edge of their first two vertices overlap when one is folded flat onto the other.
    bool folded(const Triangle& one, const Triangle& other) const {
        const Kernel::Point_3 a = point(one[0]), b = point(one[1]), c = point(one[2]), d = point(other[2]);
        return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
    }

    Kernel::Point_3 point(u32 vertex) const { return exact_point(mesh_.positions[vertex]); }
    Kernel::Triangle_3 triangle(const Triangle& t) const { return {point(t[0]), point(t[1]), point(t[2])}; }
    Kernel::Segment_3 segment(u32 a, u32 b) const { return {point(a), point(b)}; }

    const TriangleMesh& mesh_;
    Array<u32> vertices_;
};

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

std::size_t count_self_intersections(const TriangleMesh& mesh, const TriangleTree& tree, Context& context) {
    const PairTest test(mesh);
    const std::size_t count = mesh.triangles.size();
    Array<u8> collinear(count);
    constexpr std::size_t chunk = 1 << 10;
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) collinear[row] = test.is_collinear(static_cast<u32>(row));
    });
    Array<u64> pairs((count + chunk - 1) / chunk, 0);
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        Array<u32> near;
        for (std::size_t row = begin; row < end; ++row) {
            if (collinear[row]) continue;
            BoundingBox box;
            for (u32 vertex : mesh.triangles[row]) {
                box.low = box.low.cwiseMin(mesh.positions[vertex]);
                box.high = box.high.cwiseMax(mesh.positions[vertex]);
            }
            near.clear();
            tree.meeting(box, near);
            for (u32 other : near)
                if (other > row && !collinear[other]) pairs[begin / chunk] += test.meet(static_cast<u32>(row), other);
        }
    });
    return std::accumulate(pairs.begin(), pairs.end(), std::size_t(0));
}

}  // namespace scanmill
