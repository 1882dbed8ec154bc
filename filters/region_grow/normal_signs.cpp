// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/normal_signs.hpp"

namespace scanmill::growing {

OpposedNormals opposed_normals(const Samples& samples, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given) {
    constexpr double cosine = -0.5;
    // Of the distance: below it a neighbour lies in the place's plane, whatever rounding and bends make of that.
    constexpr double least_height = 0.01;
    OpposedNormals opposed;
    for (u32 place = 0; place < samples.size(); ++place) {
        if (!given[place]) continue;
        for (u32 other : neighbourhoods.of(place)) {
            if (!given[other]) continue;
            if (directions[place].dot(directions[other]) < cosine) {
                ++opposed.count;
                const Vec3 offset = samples.positions[other] - samples.positions[place];
                const double height = directions[place].dot(offset), least = least_height * offset.norm();
                opposed.behind += height < -least;
                opposed.in_front += height > least;
            }
            break;
        }
    }
    return opposed;
}

}  // namespace scanmill::growing
