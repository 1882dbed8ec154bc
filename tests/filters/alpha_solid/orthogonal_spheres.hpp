// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Spheres orthogonal to weighted points in exact arithmetic, as a reference for those of the filter.

#include <CGAL/Exact_rational.h>

#include <array>
#include <vector>

#include "scanmill/geometry/tets/circumspheres.hpp"
#include "scanmill/geometry/tets/sphere_polynomials.hpp"

namespace scanmill::test {

using spheres::dot;
using spheres::minus;
using Number = CGAL::Exact_rational;
using Vector = spheres::Offset<Number>;

struct Ball {
    Vector centre;
    Number squared;
};

inline Vector vector(const Vec3& p) { return {Number(p.x()), Number(p.y()), Number(p.z())}; }
inline Number power(const Ball& ball, const WeightedPoint& p) {
    const Vector to = minus(vector(*p.position), ball.centre);
    return Number(dot(to, to) - Number(p.weight) - ball.squared);
}

/// The smallest sphere orthogonal to the points: its centre is the first plus a combination of the edges, found by
/// Cramer's rule. Weights are not lowered, so `squared` may be negative.
inline Ball orthogonal_sphere(const std::vector<WeightedPoint>& points) {
    const std::size_t n = points.size() - 1;
    const Vector origin = vector(*points[0].position);
    std::vector<Vector> edges;
    std::vector<Number> right;
    for (std::size_t i = 1; i <= n; ++i) {
        edges.push_back(minus(vector(*points[i].position), origin));
        right.push_back((dot(edges.back(), edges.back()) + Number(points[0].weight) - Number(points[i].weight)) / 2);
    }
    const auto determinant = [&](std::size_t replaced) {
        std::array<std::array<Number, 3>, 3> m;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                m[i][j] = i >= n || j >= n ? Number(i == j) : j == replaced ? right[i] : dot(edges[i], edges[j]);
        return Number(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                      m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                      m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
    };
    const Number whole = determinant(9);
    Vector offset{0, 0, 0}, centre = origin;
    for (std::size_t j = 0; j < n; ++j) {
        const Number share = determinant(j) / whole;
        for (std::size_t axis = 0; axis < 3; ++axis) offset[axis] += share * edges[j][axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] += offset[axis];
    return {centre, Number(dot(offset, offset) - Number(points[0].weight))};
}

}  // namespace scanmill::test
