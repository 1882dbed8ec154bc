// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/direction.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

Vec3 direction_of(std::span<const double> numbers, std::string_view name) {
    if (numbers.size() != 3)
        throw Error("{} has {}; it needs 3", name, count_text(numbers.size(), "number", "numbers"))
            .hint("give x, y, z");
    const Vec3 direction(numbers[0], numbers[1], numbers[2]);
    if (!direction.allFinite() || direction.isZero(0))
        throw Error("{} is ({}, {}, {}); it must have a length", name, numbers[0], numbers[1], numbers[2])
            .hint("give a direction, as 0, 0, 1");
    return direction.stableNormalized();
}

}  // namespace scanmill
