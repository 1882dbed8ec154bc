// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks that filters make on their inputs, and helpers for the columns of outputs.

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// Throws Error for 0 points and for more than 32 bits can number. `need` ends the message for 0 points: "the cloud has
/// 0 points; smoothing needs at least 6".
void require_points(std::size_t points, std::string_view need);
/// Checks the number of points like the function above, then calls require_finite().
void require_points(const PointCloud& cloud, std::string_view need);

/// Throws Error for a mesh without triangles ("the mesh has no triangles; repair needs at least one"). Then calls
/// require_consistent() and require_finite().
void require_triangles(const TriangleMesh& mesh, std::string_view need);

/// Appends the column. Removes an older column of the same name, with a warning.
void add_column(ColumnTable& columns, Column column, Context& context);

/// Warns that the columns, if there are any, are dropped: "edge columns are dropped, because the edges are new: 'a',
/// 'b'".
void warn_of_dropped(const ColumnTable& columns, std::string_view what, std::string_view because, Context& context);

}  // namespace scanmill
