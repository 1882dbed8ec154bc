// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/thinned_bins.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "region_grow/median.hpp"

namespace scanmill::growing {

Array<double> thinned_bins(const PointCloud& cloud, const Samples& samples, Context& context) {
    const Column* column = cloud.columns.find("bin-size");
    if (!column) return {};
    if (column->components() != 1 || column->rows() != cloud.size()) {
        context.warn("the column `bin-size` is not one number per point; the search radius follows from the density");
        return {};
    }
    const auto bin = [&](u32 row) {
        const double size = column->number(row);
        return std::isfinite(size) && size > 0 ? size : 0;
    };
    Array<double> bins(samples.size());
    for (std::size_t place = 0; place < bins.size(); ++place) bins[place] = bin(samples.rows[place]);
    for (const auto& [place, row] : samples.repeats)
        if (const double size = bin(row); size > 0 && (bins[place] == 0 || size < bins[place])) bins[place] = size;
    return bins;
}

void tell_contradiction(std::span<const double> thinned, const SearchRadii& found, LengthUnit unit, Context& context) {
    std::vector<double> said, seen;
    for (std::size_t place = 0; place < thinned.size(); ++place) {
        if (found.too_dense[place] == 0) continue;
        said.push_back(thinned[place]);
        seen.push_back(found.too_dense[place]);
    }
    if (2 * said.size() <= thinned.size()) return;
    context.warn(
        fmt::format("{} of {} points lie too dense for what their column `bin-size` says: as after bins of {:.3g} {}, "
                    "not {:.3g}; their search radius follows from the density. Thin the points again, drop the column, "
                    "or check the scan's unit",
                    said.size(), thinned.size(), median(seen), symbol(unit), median(said)));
}

}  // namespace scanmill::growing
