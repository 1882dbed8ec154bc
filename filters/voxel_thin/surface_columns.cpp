// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/surface_columns.hpp"

#include "voxel_thin/added_columns.hpp"

namespace scanmill::voxel {

void add_surface_columns(PointCloud& thinned, const LocalBins& bins, std::span<const u32> kept,
                         std::span<const u32> members, Context& context) {
    Array<double> first(kept.size()), second(kept.size()), error(kept.size()), size(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const u32 place = bins.place_of_row[kept[i]];
        const LocalSurface& surface = bins.surfaces[place];
        // Which side is outside is not known: the larger curvature is positive, the other negative on saddles.
        const double sign = surface.first_curvature < 0 ? -1 : 1;
        first[i] = sign * surface.first_curvature;
        second[i] = sign * surface.second_curvature;
        error[i] = surface.fit_error;
        size[i] = bins.sizes[place];
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
