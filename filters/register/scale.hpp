// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Recognises views in another unit of length by their size.

#include <span>

#include "register/register_views.hpp"

namespace scanmill::registration {

struct UnitRatio {
    double ratio;  ///< first size divided by the second
    std::string_view units;  ///< which units would explain it
};

/// The units that explain the ratio of two sizes, if it is within 20 % of 10, 25.4, 1000, or an inverse of them.
std::optional<UnitRatio> unit_ratio(double size, double other);

/// Adds the ratio to every refused view that overlaps with nothing or is small, if another unit explains its size.
/// `sizes` are the root mean square distances of the views' points from their centroids; the others' size is the median
/// of the placed views, or of all others without any.
void name_scales(std::span<RegisteredView> views, std::span<const double> sizes);

}  // namespace scanmill::registration
