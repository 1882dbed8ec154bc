// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/added_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scanmill/base/text.hpp"

namespace scanmill::voxel {

namespace {

/// One number per row, all finite and above 0.
bool are_sizes(const Column& column, std::size_t rows) {
    if (column.components() != 1 || column.rows() != rows) return false;
    for (std::size_t row = 0; row < rows; ++row)
        if (const double size = column.number(row); !(size > 0 && std::isfinite(size))) return false;
    return true;
}

}  // namespace

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

void add_bin_sizes(PointCloud& thinned, std::span<const double> edges, double grid_edge, Context& context) {
    Array<double> sizes(thinned.size());
    if (edges.empty())
        std::ranges::fill(sizes, grid_edge);
    else
        std::ranges::copy(edges, sizes.begin());
    std::size_t older = 0;
    if (const Column* before = thinned.columns.find("bin-size"); before && are_sizes(*before, sizes.size()))
        for (std::size_t row = 0; row < sizes.size(); ++row)
            if (const double size = before->number(row); size > sizes[row]) {
                sizes[row] = size;
                ++older;
            }
    if (older > 0)
        context.warn(fmt::format("{} of {} {} thinned with larger bins before; {} `bin-size` stays", older,
                                 counted(sizes.size(), "kept point", "kept points"), by_count(older, "was", "were"),
                                 by_count(older, "its", "their")));
    add_columns(thinned, {Column("bin-size", 1, Buffer<double>(std::move(sizes))).with_length_exponent(1)}, context);
}

}  // namespace scanmill::voxel
