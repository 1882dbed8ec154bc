// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/overlap.hpp"

#include <algorithm>
#include <numeric>

#include "merge/source_grid.hpp"

namespace scanmill::merging {

Array<u32> without_overlap(std::span<const Vec3> positions, std::span<const u32> source,
                           std::span<const double> preference, double within, Context& context) {
    Array<u32> rows(positions.size());
    std::iota(rows.begin(), rows.end(), u32(0));
    if (within == 0) {
        if (!preference.empty()) context.warn("lower-uncertainty changes nothing while `within` is 0");
        return rows;
    }
    if (!preference.empty()) std::ranges::stable_sort(rows, {}, [&](u32 row) { return preference[row]; });

    SourceGrid kept(positions, source, within);
    constexpr std::size_t stretch = 1 << 16;
    std::size_t looked_at = 0;
    std::erase_if(rows, [&](u32 row) {
        if (looked_at++ % stretch == 0) {
            context.check_cancelled();
            context.progress(static_cast<double>(looked_at) / static_cast<double>(positions.size()));
        }
        if (kept.has_foreign_neighbour(row)) return true;
        kept.insert(row);
        return false;
    });
    std::ranges::sort(rows);
    return rows;
}

}  // namespace scanmill::merging
