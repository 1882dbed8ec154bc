// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scanmill/base/text.hpp"

namespace scanmill::voxel {

namespace {

/// Whether the column has one number per row, all finite and above 0.
bool are_sizes(const Column& column, std::size_t rows) {
    if (column.components() != 1 || column.rows() != rows) return false;
    for (std::size_t row = 0; row < rows; ++row)
        if (const double size = column.number(row); !(size > 0 && std::isfinite(size))) return false;
    return true;
}

/// Appends the columns and removes older ones of the same names, with a warning.
void add_columns(PointCloud& thinned, std::vector<Column> added, Context& context) {
    ColumnTable columns;
    for (const Column& column : thinned.columns) {
        if (std::ranges::find(added, column.name(), &Column::name) == added.end())
            columns.add(column);
        else
            context.warn(fmt::format("the scan's column `{}` is replaced", column.name()));
    }
    for (Column& column : added) columns.add(std::move(column));
    thinned.columns = std::move(columns);
}

}  // namespace

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
        context.warn(fmt::format("{} of {} {} thinned with larger voxels before; {} `bin-size` stays", older,
                                 counted(sizes.size(), "kept point", "kept points"), by_count(older, "was", "were"),
                                 by_count(older, "its", "their")));
    add_columns(thinned, {Column("bin-size", 1, Buffer<double>(std::move(sizes))).with_length_exponent(1)}, context);
}

void add_surface_columns(PointCloud& thinned, const LocalSizes& local, std::span<const u32> kept,
                         std::span<const u32> members, Context& context) {
    Array<double> first(kept.size()), second(kept.size()), error(kept.size()), size(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const u32 point = local.point_of_row[kept[i]];
        const LocalSurface& surface = local.surfaces[point];
        // The outward direction is not known: the larger curvature is positive, the other one negative on saddles.
        const double sign = surface.first_curvature < 0 ? -1 : 1;
        first[i] = sign * surface.first_curvature;
        second[i] = sign * surface.second_curvature;
        error[i] = surface.fit_error;
        size[i] = local.sizes[point];
    }
    add_columns(thinned,
                {Column("curvature-1", 1, Buffer<double>(std::move(first))).with_length_exponent(-1),
                 Column("curvature-2", 1, Buffer<double>(std::move(second))).with_length_exponent(-1),
                 Column("fit-error", 1, Buffer<double>(std::move(error))).with_length_exponent(1),
                 Column("local-bin-size", 1, Buffer<double>(std::move(size))).with_length_exponent(1),
                 Column("stands-for", 1, Buffer<u32>(Array<u32>(members.begin(), members.end())))},
                context);
}

}  // namespace scanmill::voxel
