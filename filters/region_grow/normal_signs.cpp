// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/normal_signs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace scanmill::growing {

namespace {

constexpr double opposed_cosine = -0.9;  // of 154 degrees
/// Of the distance, along the normal: a neighbour beside is no higher.
constexpr double most_height = 0.3;
/// What rounding and bends make of a height of nothing.
constexpr double least_height = 0.01;

bool are_opposed(const Vec3& one, const Vec3& other) { return one.dot(other) < opposed_cosine; }

}  // namespace

void OpposedNormals::add(const Vec3& normal, const Vec3& offset_of_other) {
    const double height = normal.dot(offset_of_other), distance = offset_of_other.norm();
    ++count;
    behind += height < -least_height * distance;
    in_front += height > least_height * distance;
    beside += std::abs(height) < most_height * distance;
}

OpposedNormals opposed_normals(const Samples& samples, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given) {
    OpposedNormals opposed;
    for (u32 place = 0; place < samples.size(); ++place) {
        if (!given[place]) continue;
        for (u32 other : neighbourhoods.of(place)) {
            if (!given[other]) continue;
            if (are_opposed(directions[place], directions[other]))
                opposed.add(directions[place], samples.positions[other] - samples.positions[place]);
            break;
        }
    }
    return opposed;
}

std::size_t places_at_seams(const Surface& surface) {
    constexpr std::size_t nearest = 6;
    OpposedNormals opposed;
    for (u32 place = 0; place < surface.states.size(); ++place) {
        if (surface.states[place] != PlaceState::front) continue;
        const std::span<const u32> others = surface.neighbourhoods.of(place);
        for (u32 other : others.first(std::min(nearest, others.size()))) {
            if (surface.states[other] != PlaceState::front ||
                !are_opposed(surface.normals[place], surface.normals[other]))
                continue;
            opposed.add(surface.normals[place], surface.positions[other] - surface.positions[place]);
            break;
        }
    }
    return opposed.are_on_one_side() ? 0 : opposed.beside;
}

void face_as_given(Surface& surface, const Pieces& pieces, const Array<Vec3>& given) {
    struct Votes {
        std::size_t along = 0, against = 0;
    };
    std::vector<Votes> votes(pieces.count);
    for (const Triangle& t : surface.triangles) {
        const Vec3 normal = surface.facet_normal(t[0], t[1], t[2]);
        for (u32 corner : t) {
            const double cosine = normal.dot(given[corner]);
            votes[pieces.of_place[corner]].along += cosine > 0;
            votes[pieces.of_place[corner]].against += cosine < 0;
        }
    }
    for (Triangle& t : surface.triangles) {
        const auto [along, against] = votes[pieces.of_place[t[0]]];
        if (against > 0 && against >= 3 * along) std::swap(t[1], t[2]);
    }
}

}  // namespace scanmill::growing
