// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/thinned_bins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace scanmill::growing {

namespace {

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

Array<double> thinned_bins(const PointCloud& cloud, const Samples& samples, Context& context) {
    const Column* column = cloud.columns.find("bin-size");
    if (!column) return {};
    if (column->components() != 1 || column->rows() != cloud.size()) {
        context.warn("the column `bin-size` is not one number per point; the search radius follows from the density");
        return {};
    }
    Array<double> bins(samples.size());
    for (std::size_t place = 0; place < bins.size(); ++place) {
        const double size = column->number(samples.rows[place]);
        bins[place] = std::isfinite(size) && size > 0 ? size * samples.scale : 0;
    }
    return bins;
}

void tell_contradiction(const Samples& samples, std::span<const double> thinned, const SearchRadii& found,
                        Context& context) {
    std::vector<double> said, seen;
    for (std::size_t place = 0; place < thinned.size(); ++place) {
        const double bin = found.radii[place] / (2 * std::numbers::sqrt3);
        if (thinned[place] <= bin) continue;
        said.push_back(thinned[place] / samples.scale);
        seen.push_back(bin / samples.scale);
    }
    if (2 * said.size() <= thinned.size()) return;
    context.warn(
        fmt::format("{} of {} points lie too dense for what their column `bin-size` says: as after bins of {:.3g} u, "
                    "not {:.3g} u; their search radius follows from the density",
                    said.size(), thinned.size(), median(seen), median(said)));
}

}  // namespace scanmill::growing
