// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals that came with the points.

#include "region_grow/point_normals.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

struct GivenNormals {
    /// They tell the sides: a triangle must agree with their sign.
    bool signs_count = false;
    /// Where the signs do not count: per place the given normal, zero where there is none. Else empty.
    Array<Vec3> doubtful;
};

/// Replaces the principal normals by those of the column `normal`, where there is one. Of rows in one place the normal
/// first by x, y, z counts. A place without one that is finite and not zero keeps its principal one, turned to the
/// given ones near it; how many such places there were is warned of. Signs do not count where more than half of the
/// places have none, and when they are mixed as opposed_normals() tells; a warning says so. Throws Error when the
/// column is not three numbers per row, and when more than three quarters of the normals are more than 60 degrees from
/// the principal ones, along directions in which their neighbours lie; of more than a quarter it warns. Cost: linear.
GivenNormals take_given_normals(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                                PointNormals& normals, Context& context);

}  // namespace scanmill::growing
