// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// View directions, and the grid of rays of one direction.

#include <span>
#include <vector>

#include "scanmill/data/points.hpp"

namespace scanmill::scan {

/// Returns unit vectors from the object to the sensor. One number n ≥ 1 gives the n points of the Fibonacci sphere
/// (González 2010), with equal steps in height and turns by the golden angle. 3 k numbers give k directions,
/// normalised. Throws Error for anything else.
std::vector<Vec3> view_directions(std::span<const double> views);

/// Parallel rays in a regular grid. Ray (column i, row j) runs along `forward` through centre + (left + i + 1/2)
/// resolution right + (bottom + j + 1/2) resolution up. Depths count from that point.
struct View {
    Vec3 right, up, forward;  // orthonormal; right × up = −forward points to the sensor
    Vec3 centre;
    double resolution = 0;
    double left = 0, bottom = 0;  // whole numbers
    std::size_t width = 0, height = 0;

    double across(std::size_t column) const { return (left + static_cast<double>(column) + 0.5) * resolution; }
    double along(std::size_t row) const { return (bottom + static_cast<double>(row) + 0.5) * resolution; }
    /// (across, along, depth) of a point relative to the centre.
    Vec3 project(const Vec3& point) const {
        const Vec3 offset = point - centre;
        return {offset.dot(right), offset.dot(up), offset.dot(forward)};
    }
    Vec3 point(double across, double along, double depth) const {
        return centre + across * right + along * up + depth * forward;
    }
};

/// The view from a direction, without rays yet: `width` and `height` are 0.
View view_from(const Vec3& direction, const Vec3& centre, double resolution);
/// Number of rays that cover the projections of the points.
double rays_over(const View& view, std::span<const Vec3> points);
/// The view with just the rays of rays_over(). Pre: rays_over() is small enough to hold.
View covering(View view, std::span<const Vec3> points);

}  // namespace scanmill::scan
