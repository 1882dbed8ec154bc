// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/colour/colour_scale.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace scanmill {

namespace {

/// Colours at equal steps from the neutral centre to the end of one half.
using Half = std::array<Colour, 6>;
constexpr Half below = {
    {{246, 244, 240}, {196, 220, 238}, {124, 178, 220}, {62, 128, 190}, {26, 82, 146}, {10, 44, 92}}};
constexpr Half above = {
    {{246, 244, 240}, {250, 216, 178}, {244, 162, 98}, {222, 102, 52}, {178, 46, 30}, {112, 12, 28}}};

/// End of the tolerance band as a share of a half. The first step of the control colours is the band's.
constexpr double band_end = 0.2;

/// The colour at `share` of a half; 0 is neutral.
Colour colour_in(const Half& half, double share) {
    const double at = share * static_cast<double>(half.size() - 1);
    const std::size_t step = std::min(static_cast<std::size_t>(at), half.size() - 2);
    const double rest = at - static_cast<double>(step);
    Colour colour;
    for (std::size_t channel = 0; channel < colour.size(); ++channel)
        colour[channel] = static_cast<u8>((1 - rest) * half[step][channel] + rest * half[step + 1][channel] + 0.5);
    return colour;
}

/// Share of a half for a value at `distance` from its neutral end. The tolerance ends at the distance `band`, the half
/// at `length`.
double share_of(double distance, double band, double length) {
    if (!(distance > 0)) return 0;
    if (distance >= length) return 1;
    if (!(band > 0 && band < length)) return distance / length;
    if (distance <= band) return band_end * (distance / band);
    return band_end + (1 - band_end) * ((distance - band) / (length - band));
}

}  // namespace

ColourScale scale_of_tolerance(double low, double high) {
    return {low < 0 ? 2 * low : -2 * high, high > 0 ? 2 * high : -2 * low, low, high};
}

Colour colour_of(const ColourScale& scale, double value) {
    assert(scale.low <= scale.high);
    if (std::isnan(value)) return no_data;
    const bool is_out = scale.has_tolerance() && (value < scale.tolerance_low || value > scale.tolerance_high);
    const double neutral = std::clamp(0.0, scale.low, scale.high);
    value = std::clamp(value, scale.low, scale.high);
    const bool is_below = value < neutral;
    double share = is_below ? share_of(neutral - value, neutral - scale.tolerance_low, neutral - scale.low)
                            : share_of(value - neutral, scale.tolerance_high - neutral, scale.high - neutral);
    if (is_out) share = std::max(share, band_end);
    return colour_in(is_below ? below : above, share);
}

}  // namespace scanmill
