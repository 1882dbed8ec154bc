// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/size_limits.hpp"

#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill {

void require_finite_size(const BoundingBox& box) {
    if (std::isfinite(box.diagonal())) return;
    throw Error(
        "the corners of the box of coordinates from {:.6g} to {:.6g} lie farther apart than the largest number, {:.3g}",
        box.low.minCoeff(), box.high.maxCoeff(), std::numeric_limits<double>::max())
        .hint(
            "such coordinates are stray ones, or numbers whose bytes are in the wrong order: see how the file was "
            "written");
}

void require_squares(double size, std::string_view needing) {
    if (size > 1e-100 && size < 1e100) return;
    throw Error("{} between 1e-100 and 1e100 u in size, so that squares of lengths are numbers; it is {}", needing,
                std::isfinite(size) ? fmt::format("{:.3g} u", size)
                                    : fmt::format("beyond {:.3g} u", std::numeric_limits<double>::max()))
        .hint("remove stray points, or give it in another unit");
}

}  // namespace scanmill
