// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/swept_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill {

namespace {

using Segment = std::array<Vec3, 2>;
using Corners = std::array<Vec3, 3>;

double squared(const Vec3& point, const Segment& segment) {
    return (nearest_on_segment(point, segment[0], segment[1]) - point).squaredNorm();
}
double squared(const Vec3& point, const Corners& triangle) {
    return (nearest_on_triangle(point, triangle[0], triangle[1], triangle[2]) - point).squaredNorm();
}

/// Whether the segment passes through the inside of the triangle, and not along its plane. The ends must be on
/// different sides of the plane, and the segment's line must pass the three edges on the same side.
bool passes_through(const Segment& segment, const Corners& triangle) {
    const auto& [a, b, c] = triangle;
    const Vec3 normal = (b - a).cross(c - a);
    const double first = normal.dot(segment[0] - a), last = normal.dot(segment[1] - a);
    if (!((first <= 0 && last >= 0) || (first >= 0 && last <= 0)) || first == last) return false;
    const Vec3 along = segment[1] - segment[0];
    const Vec3 pa = a - segment[0], pb = b - segment[0], pc = c - segment[0];
    const double u = along.dot(pc.cross(pb)), v = along.dot(pa.cross(pc)), w = along.dot(pb.cross(pa));
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

Segment edge(const Corners& triangle, std::size_t i) { return {triangle[i], triangle[(i + 1) % 3]}; }

template <class Body>
bool any_nearer(const TriangleTree& mesh, const Body& body, double distance, const CountsTriangle& counts) {
    const double limit = distance * distance;
    return mesh.any_near(body, distance, [&](u32 slot) {
        return (!counts || counts(slot)) && squared_distance(body, mesh.corners(slot)) < limit;
    });
}

}  // namespace

double squared_distance_of_segments(const Segment& one, const Segment& other) {
    double least =
        std::min({squared(one[0], other), squared(one[1], other), squared(other[0], one), squared(other[1], one)});
    const Vec3 d1 = one[1] - one[0], d2 = other[1] - other[0], from = one[0] - other[0];
    const double a = d1.squaredNorm(), e = d2.squaredNorm(), b = d1.dot(d2);
    // Equals a e - b², computed without cancellation.
    const double denominator = d1.cross(d2).squaredNorm();
    if (!(denominator > 0)) return least;
    const double c = d1.dot(from), f = d2.dot(from);
    const double s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
    const double t = std::clamp((b * s + f) / e, 0.0, 1.0);
    const double again = std::clamp((b * t - c) / a, 0.0, 1.0);
    return std::min(least, (from + again * d1 - t * d2).squaredNorm());
}

double squared_distance(const Segment& segment, const Corners& triangle) {
    if (passes_through(segment, triangle)) return 0;
    double least = std::min(squared(segment[0], triangle), squared(segment[1], triangle));
    for (std::size_t i = 0; i < 3; ++i)
        least = std::min(least, squared_distance_of_segments(segment, edge(triangle, i)));
    return least;
}

double squared_distance(const Corners& one, const Corners& other) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3 && least > 0; ++i)
        least = std::min({least, squared_distance(edge(one, i), other), squared_distance(edge(other, i), one)});
    return least;
}

bool is_nearer(const TriangleTree& mesh, const Segment& segment, double distance, const CountsTriangle& counts) {
    return any_nearer(mesh, segment, distance, counts);
}

bool is_nearer(const TriangleTree& mesh, const Corners& triangle, double distance, const CountsTriangle& counts) {
    return any_nearer(mesh, triangle, distance, counts);
}

bool is_nearer_when_moved(const TriangleTree& mesh, const Segment& segment, const Vec3& motion, double distance,
                          const CountsTriangle& counts) {
    const Vec3 p = segment[0], q = segment[1];
    return is_nearer(mesh, Corners{p, q, p + motion}, distance, counts) ||
           is_nearer(mesh, Corners{q, p + motion, q + motion}, distance, counts);
}

}  // namespace scanmill
