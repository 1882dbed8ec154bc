// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Colours of values, for heat maps and their legends.
///
/// The scale is diverging: blue below 0, nearly white at 0, orange and red above. Both halves become darker away from
/// 0, so the magnitude is visible in grey. Red-green colour blindness does not mix blue and orange. The control colours
/// are our own; colours between them are interpolated linearly in sRGB.

#include "scanmill/data/picture.hpp"

namespace scanmill {

struct ColourScale {
    /// The values with the darkest colours. Values outside have these colours, too.
    double low = 0, high = 1;
    /// The values in tolerance, if the two are not both 0. Values in tolerance have the lightest fifth of a half; no
    /// other value has a lighter colour than the end of this fifth. So values out of tolerance are clearly coloured.
    /// A limit beyond the range has no effect.
    double tolerance_low = 0, tolerance_high = 0;

    bool has_tolerance() const { return tolerance_low != 0 || tolerance_high != 0; }
};

/// The scale for deviations with this tolerance: [2 low, 2 high]. A tolerance without a negative end begins at -2 high,
/// one without a positive end ends at -2 low, so that deviations to the other side have colours, too.
/// Pre: low ≤ high, not both 0.
ColourScale scale_of_tolerance(double low, double high);

/// The colour of values without data, such as NaN.
inline constexpr Colour no_data = {160, 160, 160};

/// The colour of a value; no_data for NaN.
///
/// If low < 0 < high, 0 is neutral, and the two halves are scaled separately: `low` has the darkest blue and `high` the
/// darkest red. If low ≥ 0, only the upper half is used, with `low` neutral. If high ≤ 0, only the lower half is used,
/// with `high` neutral.
/// Pre:  finite bounds, low ≤ high. If both are equal, this value is neutral.
/// Post: continuous in the value, except at a limit of a tolerance that does not contain 0. Bytes do not depend on the
///       processor.
Colour colour_of(const ColourScale& scale, double value);

}  // namespace scanmill
