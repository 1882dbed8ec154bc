// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Uses the normals that are given with the cloud.

#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/growing/point_normals.hpp"

namespace scanmill::growing {

struct GivenNormals {
    /// Whether a triangle must agree with the signs of its points' normals.
    bool signs_count = false;
    /// If signs do not count: per point the given normal, zero if there is none. Otherwise empty.
    Array<Vec3> doubtful;
};

/// Replaces the principal normals by those of the column `normal`, if there is one. If several rows have one position,
/// the first normal by x, y, z is used. A point without a finite non-zero normal keeps its principal one, with the sign
/// of the given ones near it. A warning gives the number of such points. Signs are ignored, with a warning, if more
/// than half of the points have no normal, or if signs are mixed (see OpposedNormals). Throws Error if the column is
/// not three numbers wide. A normal lies in the surface if it is more than 60 degrees from the principal one, in a
/// direction in which the neighbours lie. Throws Error if more than three quarters of the normals do, and warns above a
/// quarter. Cost: linear.
GivenNormals take_given_normals(const PointCloud& cloud, const DistinctPoints& points,
                                const Neighbourhoods& neighbourhoods, PointNormals& normals, Context& context);

/// Whether the normals of two neighbours differ by more than 154 degrees. Ridges and grooves of more than 26 degrees
/// have no such neighbours.
bool are_opposed(const Vec3& one, const Vec3& other);

/// Counts points whose normal is opposed to that of their nearest neighbour, by the position of this neighbour.
struct OpposedNormals {
    std::size_t count = 0;
    /// Numbers of points whose neighbour is behind, as on the other side of a sheet; in front, as across a slit; and
    /// nearly in the point's plane (within 17 degrees), as on the same surface.
    std::size_t behind = 0, in_front = 0, beside = 0;

    /// Nearly all neighbours are behind, or nearly all in front: they belong to the other side of a thin sheet or slit.
    bool are_on_one_side() const { return 4 * (behind > in_front ? behind : in_front) > 3 * count; }
    /// More than one point in a hundred is opposed to a neighbour beside it, and not because the object is thin.
    bool are_mixed(std::size_t points) const { return 100 * beside > points && !are_on_one_side(); }

    /// Pre: the point's normal and the other's are opposed.
    void add(const Vec3& normal, const Vec3& offset_of_other);
};

/// `given`: which points have a normal. Neighbours without one are skipped. Cost: linear.
OpposedNormals opposed_normals(const DistinctPoints& points, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given);

}  // namespace scanmill::growing
