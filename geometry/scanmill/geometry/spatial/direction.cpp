// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/direction.hpp"

#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

Vec3 direction_of(std::span<const double> numbers, std::string_view name) {
    if (numbers.size() != 3)
        throw Error("{} has {}; it needs 3", name, count_text(numbers.size(), "number", "numbers"))
            .hint("give x, y, z");
    const Vec3 direction(numbers[0], numbers[1], numbers[2]);
    if (!direction.allFinite() || direction.isZero(0))
        throw Error("{} is ({}, {}, {}); it must be finite and not zero", name, numbers[0], numbers[1], numbers[2])
            .hint("give a direction, for example 0, 0, 1");
    return direction.stableNormalized();
}

Vec3 position_of(std::span<const Length> lengths, std::string_view name) {
    if (lengths.size() != 3)
        throw Error("{} has {}; it needs 3", name, count_text(lengths.size(), "length", "lengths"))
            .hint("give x, y, z");
    for (const Length& length : lengths)
        if (!std::isfinite(length.value()))
            throw Error("a length of {} is {} u; it must be finite", name, length.value())
                .hint("give x, y, z as finite lengths");
    return {lengths[0].value(), lengths[1].value(), lengths[2].value()};
}

}  // namespace scanmill
