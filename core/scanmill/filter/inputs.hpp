// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What filters do with their inputs: refuse those without elements, and add columns to a copy.

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// Throws Error for 0 points and for more than 32 bits can number. `need` ends the first message: "the cloud has 0
/// points; smoothing needs at least 6".
void require_points(std::size_t points, std::string_view need);
/// The same, and require_finite().
void require_points(const PointCloud& cloud, std::string_view need);

/// Throws Error without triangles ("the mesh has no triangles; repair needs at least one"), then does what
/// require_consistent() and require_finite() do.
void require_triangles(const TriangleMesh& mesh, std::string_view need);

/// Appends the column. An older column of its name is removed, with a warning.
void add_column(ColumnTable& columns, Column column, Context& context);

/// Warns that columns, if there are any, are dropped: "edge columns are dropped, because the edges are new: 'a', 'b'".
void warn_of_dropped(const ColumnTable& columns, std::string_view what, std::string_view because, Context& context);

}  // namespace scanmill
