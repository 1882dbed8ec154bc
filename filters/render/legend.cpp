// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/legend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/scene.hpp"

namespace scanmill {

namespace {

constexpr Colour ink = {40, 40, 40};
constexpr double bar_width = 1.4, gap = 0.6;  // in text sizes

}  // namespace

std::string scale_text(double value, bool is_signed) {
    const std::string text = fmt::format(fmt::runtime(is_signed ? "{:+.4g}" : "{:.4g}"), value);
    return value == 0 ? "0" : text;
}

Legend legend_of(const DrawnColumn& column) {
    Legend legend;
    legend.title = column.unit.empty() ? column.name : fmt::format("{} [{}]", column.name, column.unit);
    legend.scale = column.scale;
    legend.shows_no_data = column.has_gaps;
    const double low = column.scale.low, high = column.scale.high;
    if (low == high) {
        legend.ticks = {{0.5, scale_text(low, false)}};
        return legend;
    }
    const bool has_both_signs = low < 0 && high > 0;
    std::vector<double> values{low, (low + high) / 2, high};
    if (has_both_signs) values = {low, low / 2, 0, high / 2, high};
    if (column.scale.has_tolerance()) {
        values = {low, column.scale.tolerance_low, 0, column.scale.tolerance_high, high};
        std::ranges::sort(values);
        values.erase(std::ranges::unique(values).begin(), values.end());
        std::erase_if(values, [&](double value) { return value < low || value > high; });
    }
    for (const double value : values)
        legend.ticks.push_back({(value - low) / (high - low), scale_text(value, has_both_signs)});
    if (has_both_signs && !column.unit.empty()) {
        legend.upper_word = "outside";
        legend.lower_word = "inside";
    }
    return legend;
}

u32 width_of(const Legend& legend, Font& font, double size) {
    double widest = std::max({font.width(legend.title, size), font.width(legend.upper_word, size),
                              legend.shows_no_data ? (bar_width + gap) * size + font.width("no data", size) : 0.0});
    for (const LegendTick& tick : legend.ticks)
        widest = std::max(widest, (bar_width + gap) * size + font.width(tick.text, size));
    return static_cast<u32>(std::ceil(widest + 2 * gap * size));
}

void draw(const Legend& legend, Canvas& canvas, Font& font, const Rectangle& part, double size) {
    const double left = part.x + gap * size;
    const auto bar = static_cast<u32>(std::lround(bar_width * size));
    const auto line = static_cast<u32>(std::lround(1.5 * size));
    const u32 x = static_cast<u32>(std::lround(left));
    const u32 above = 4 * line, below = (legend.shows_no_data ? 5 : 2) * line;
    if (part.height <= above + below) return;  // a picture of a few rows has room for the scene only
    const Rectangle box{x, part.y + above, bar, part.height - above - below};
    font.draw(canvas, legend.title, left, part.y + 1.5 * line, size, ink);
    font.draw(canvas, legend.upper_word, left, box.y - 0.6 * line, size, ink);
    font.draw(canvas, legend.lower_word, left, box.y + box.height + 1.2 * line, size, ink);
    for (u32 row = 0; row < box.height; ++row) {
        const double place = 1 - (row + 0.5) / box.height;
        const double value = legend.scale.low + place * (legend.scale.high - legend.scale.low);
        canvas.fill({box.x, box.y + row, box.width, 1}, colour_of(legend.scale, value));
    }
    // The ends first, then the others from below; a number that would cover another one is left out.
    std::vector<double> taken;
    const auto mark = [&](const LegendTick& tick) {
        const double y = box.y + (1 - tick.place) * box.height;
        const auto row = static_cast<u32>(std::clamp(y, double(box.y), box.y + box.height - 1.0));
        canvas.fill({box.x + box.width - bar / 4, row, bar / 4 + bar / 5, 1}, ink);
        if (std::ranges::any_of(taken, [&](double other) { return std::abs(other - y) < 1.1 * size; })) return;
        taken.push_back(y);
        font.draw(canvas, tick.text, box.x + box.width + gap * size, y + 0.35 * size, size, ink);
    };
    mark(legend.ticks.back());
    for (const LegendTick& tick : legend.ticks)
        if (&tick != &legend.ticks.back()) mark(tick);
    if (!legend.shows_no_data) return;
    const u32 y = box.y + box.height + 2 * line + line / 2;
    canvas.fill({box.x, y, bar, bar / 2}, no_data);
    font.draw(canvas, "no data", box.x + box.width + gap * size, y + 0.5 * bar / 2 + 0.35 * size, size, ink);
}

}  // namespace scanmill
