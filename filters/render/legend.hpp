// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The legend of a colour scale: a bar with numbers and words.

#include <string>
#include <vector>

#include "render/canvas.hpp"
#include "scanmill/geometry/colour/colour_scale.hpp"

namespace scanmill {

struct DrawnColumn;

/// A number beside the bar. `place` is 0 at the lower end of the bar and 1 at the upper end.
struct LegendTick {
    double place;
    std::string text;
};

struct Legend {
    std::string title;  ///< the column, with the unit of its numbers
    ColourScale scale;
    std::vector<LegendTick> ticks;
    /// Words at the ends. Programs disagree on which colour is outside, so the legend says it.
    std::string upper_word, lower_word;
    bool shows_no_data = false;
};

/// Ticks are at the ends, at 0 if it is inside, and at the limits of a tolerance, or halfway without one. Lengths with
/// both signs have the words *outside* and *inside*.
Legend legend_of(const DrawnColumn& column);

/// "-0.05": the value with four digits, and with its sign if `is_signed`.
std::string scale_text(double value, bool is_signed);

/// Columns of pixels that the legend needs beside a picture with this text size.
u32 width_of(const Legend& legend, Font& font, double size);
void draw(const Legend& legend, Canvas& canvas, Font& font, const Rectangle& part, double size);

}  // namespace scanmill
