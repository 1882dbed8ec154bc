// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/added_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill::voxel {

void add_columns(PointCloud& thinned, std::vector<Column> added, Context& context) {
    ColumnTable columns;
    for (const Column& column : thinned.columns) {
        if (std::ranges::find(added, column.name(), &Column::name) == added.end())
            columns.add(column);
        else
            context.warn(
                fmt::format("column `{}` of the scan gives way to the one that thinning makes", column.name()));
    }
    for (Column& column : added) columns.add(std::move(column));
    thinned.columns = std::move(columns);
}

Column bin_sizes(std::size_t points, std::span<const double> edges, double grid_edge) {
    Array<double> sizes(points);
    if (edges.empty())
        std::ranges::fill(sizes, grid_edge);
    else
        std::ranges::copy(edges, sizes.begin());
    return Column("bin-size", 1, Buffer<double>(std::move(sizes)));
}

}  // namespace scanmill::voxel
