// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/scale.hpp"

#include "scanmill/base/statistics.hpp"

namespace scanmill::registration {

namespace {

constexpr double largest_deviation = 1.2;
constexpr UnitRatio known_ratios[] = {
    {10, "millimetres and centimetres"}, {25.4, "millimetres and inches"}, {1000, "millimetres and metres"}};

}  // namespace

std::optional<UnitRatio> unit_ratio(double size, double other) {
    if (!(size > 0 && other > 0)) return std::nullopt;
    const double ratio = size > other ? size / other : other / size;
    for (const UnitRatio& known : known_ratios)
        if (ratio < known.ratio * largest_deviation && ratio > known.ratio / largest_deviation)
            return UnitRatio{size / other, known.units};
    return std::nullopt;
}

void name_scales(std::span<RegisteredView> views, std::span<const double> sizes) {
    for (std::size_t view = 0; view < views.size(); ++view) {
        if (views[view].refusal != ViewRefusal::no_overlap && views[view].refusal != ViewRefusal::small) continue;
        std::vector<double> placed, others;
        for (std::size_t other = 0; other < views.size(); ++other) {
            if (views[other].pose) placed.push_back(sizes[other]);
            if (other != view) others.push_back(sizes[other]);
        }
        if (others.empty()) continue;
        const double size = median(placed.empty() ? others : placed);
        if (const auto found = unit_ratio(sizes[view], size)) {
            views[view].scale = found->ratio;
            views[view].units = found->units;
        }
    }
}

}  // namespace scanmill::registration
