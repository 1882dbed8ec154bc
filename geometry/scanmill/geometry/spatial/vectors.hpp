// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Small functions of positions: order, areas, and perpendicular directions.

#include <Eigen/Geometry>
#include <cmath>
#include <span>
#include <utility>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Compares by x, then y, then z.
inline bool is_lower(const Vec3& a, const Vec3& b) {
    if (a.x() != b.x()) return a.x() < b.x();
    return a.y() != b.y() ? a.y() < b.y() : a.z() < b.z();
}

/// A vector perpendicular to the triangle, on the side from which the triangle is counter-clockwise. Its length is
/// twice the area of the triangle.
inline Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }
inline Vec3 area_vector(std::span<const Vec3> positions, const Triangle& t) {
    return area_vector(positions[t[0]], positions[t[1]], positions[t[2]]);
}

/// A unit vector at a right angle to a unit vector.
inline Vec3 perpendicular(const Vec3& n) {
    Eigen::Index least;
    n.cwiseAbs().minCoeff(&least);
    return n.cross(Vec3::Unit(least)).normalized();
}

/// Two unit vectors, perpendicular to a unit normal and to each other.
inline std::pair<Vec3, Vec3> directions_across(const Vec3& normal) {
    const Vec3 u = normal.cross(std::abs(normal.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
    return {u, normal.cross(u)};
}

}  // namespace scanmill
