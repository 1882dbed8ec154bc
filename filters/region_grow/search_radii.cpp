// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/search_radii.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "scanmill/base/parallel.hpp"

namespace scanmill::growing {

namespace {

/// The upper one of two middles; reorders the values. Pre: at least one, none NaN. Cost: linear.
template <class Values>
double median(Values& values) {
    const auto middle = std::next(values.begin(), static_cast<std::ptrdiff_t>(values.size() / 2));
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

constexpr std::size_t counted_neighbours = 12;
/// On average over all directions of a surface.
constexpr double cubes_per_squared_bin = 1.5;
/// What the density may come to, of the bins of a thinning, where the two agree.
constexpr double least_share = 0.55, largest_share = 1.15;
/// Of the median of the neighbours' bins, what a place's bin counts at most, as told or as dense.
constexpr double largest_of_median = 1.15;
constexpr std::size_t chunk = 1 << 12;

/// The bin whose thinning would put the place's last counted neighbour where it is, of one cube per squared bin.
double bin_at(const Samples& samples, const Neighbourhoods& neighbourhoods, u32 place) {
    const auto neighbours = neighbourhoods.of(place);
    const std::size_t count = std::min(counted_neighbours, neighbours.size());
    const double distance = (samples.positions[neighbours[count - 1]] - samples.positions[place]).norm();
    return distance * std::sqrt(std::numbers::pi / static_cast<double>(count));
}

/// How many cubes per squared bin a surface of this normal meets.
double cubes_met(const Vec3& normal) { return normal.cwiseAbs().sum(); }

class Bins {
public:
    Bins(const Samples& samples, const Neighbourhoods& neighbourhoods, std::span<const Vec3> normals, unsigned threads)
        : neighbourhoods_(neighbourhoods),
          normals_(normals),
          bins_(samples.size()) {
        for_each_chunk(threads, bins_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place)
                bins_[place] = bin_at(samples, neighbourhoods, static_cast<u32>(place));
        });
    }

    double by_density(u32 place, std::vector<double>& room) const {
        room.clear();
        for (u32 other : neighbourhoods_.of(place)) room.push_back(bins_[other]);
        return std::sqrt(cubes_per_squared_bin) * std::min(bins_[place], largest_of_median * median(room));
    }
    /// The told one, no larger than those round it allow; 0 where nothing was told.
    double told(std::span<const double> thinned, u32 place, std::vector<double>& room) const {
        if (thinned.empty() || !(thinned[place] > 0)) return 0;
        room.clear();
        for (u32 other : neighbourhoods_.of(place))
            if (thinned[other] > 0) room.push_back(thinned[other]);
        return room.empty() ? thinned[place] : std::min(thinned[place], largest_of_median * median(room));
    }
    /// Of a surface that lies to the cubes as the normals say.
    double by_density_and_normals(u32 place, std::vector<double>& room) const {
        room.clear();
        for (u32 other : neighbourhoods_.of(place))
            room.push_back(bins_[other] * std::sqrt(cubes_met(normals_[other])));
        return median(room);
    }

private:
    const Neighbourhoods& neighbourhoods_;
    std::span<const Vec3> normals_;
    Array<double> bins_;
};

}  // namespace

SearchRadii automatic_radii(const Samples& samples, const Neighbourhoods& neighbourhoods, std::span<const Vec3> normals,
                            std::span<const float> roughness, std::span<const double> thinned, unsigned threads) {
    const Bins bins(samples, neighbourhoods, normals, threads);
    SearchRadii result;
    result.radii.resize(samples.size());
    result.by_density.resize(samples.size());
    result.too_dense = Array<double>(thinned.size(), 0);
    std::vector<std::size_t> known((samples.size() + chunk - 1) / chunk, 0);
    for_each_chunk(threads, samples.size(), chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<double> room;
        for (std::size_t i = begin; i < end; ++i) {
            const u32 place = static_cast<u32>(i);
            const double said = bins.told(thinned, place, room);
            const double seen = said > 0 ? bins.by_density_and_normals(place, room) : 0;
            const bool agree = said > 0 && seen >= least_share * said && seen <= largest_share * said;
            known[begin / chunk] += agree;
            const double dense = bins.by_density(place, room);
            const double bin = !agree ? dense : roughness[i] > rough ? std::max(said, dense) : said;
            result.radii[i] = 2 * std::numbers::sqrt3 * bin;
            result.by_density[i] = 2 * std::numbers::sqrt3 * dense;
            if (seen < least_share * said) result.too_dense[i] = bin;
        }
    });
    for (const std::size_t places : known) result.known += places;
    return result;
}

double bins_as_dense(const Surface& surface, unsigned threads) {
    Array<double> radii =
        automatic_radii(surface.samples, surface.neighbourhoods, surface.normals, surface.roughness, {}, threads).radii;
    return median(radii) / (2 * std::numbers::sqrt3);
}

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
