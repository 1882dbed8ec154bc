// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals that came with the points.

#include "region_grow/point_normals.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

/// Replaces the principal normals by those of the column `normal`, where there is one; whether their signs count, too.
/// They do not, with a warning, when they are mixed as opposed_normals() tells. Of rows in one place the normal first
/// by x, y, z counts. A place without one that is finite and not zero keeps its principal one, turned to its
/// neighbours' given ones; how many such places there were is warned of. Throws Error when the column is not three
/// numbers per row, and when more than three quarters of the normals are more than 60 degrees from the principal ones,
/// along directions in which their neighbours lie; of more than a quarter it warns.
bool take_given_normals(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                        PointNormals& normals, Context& context);

}  // namespace scanmill::growing
