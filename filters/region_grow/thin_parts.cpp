// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/thin_parts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace scanmill::growing {

namespace {

constexpr double facing_cosine = -0.5;  // of 120 degrees
/// Of the distance, along the normal: another side is across, not beside.
constexpr double least_across = 0.7;

struct OtherSide {
    double distance, bin;
    bool operator<(const OtherSide& other) const {
        return distance != other.distance ? distance < other.distance : bin < other.bin;
    }
};

class OtherSides {
public:
    OtherSides(const Surface& surface, const Pieces& pieces) : surface_(surface), pieces_(pieces) {}

    /// As far off as the search goes when there is none.
    OtherSide nearest(u32 place) {
        const double bin = surface_.search_radius[place] / (2 * std::numbers::sqrt3);
        OtherSide best{thin_in_bins * bin, bin};
        found_.clear();
        surface_.neighbourhoods.within(place, best.distance * best.distance, buffer_, found_);
        const Vec3& p = surface_.positions[place];
        for (u32 other : found_) {
            if (!surface_.is_used(other) || !face_apart(place, other)) continue;
            const Vec3 offset = surface_.positions[other] - p;
            const double distance = offset.norm();
            if (std::abs(offset.dot(surface_.normals[place])) < least_across * distance) continue;
            best.distance = std::min(best.distance, distance);
            break;  // they come by distance
        }
        return best;
    }

private:
    bool face_apart(u32 place, u32 other) const {
        const double cosine = surface_.normals[place].dot(surface_.normals[other]);
        const bool is_one_piece = pieces_.of_place[place] == pieces_.of_place[other];
        return (is_one_piece ? cosine : -std::abs(cosine)) < facing_cosine;
    }

    const Surface& surface_;
    const Pieces& pieces_;
    NeighbourBuffer buffer_;
    std::vector<u32> found_;
};

}  // namespace

ThinParts find_thin_parts(const Surface& surface, const Pieces& pieces, const Context& context) {
    ThinParts parts;
    if (surface.oriented) return parts;
    OtherSides sides(surface, pieces);
    OtherSide least{std::numeric_limits<double>::infinity(), 0};
    std::vector<bool> passed(surface.states.size(), false);
    for (u32 begin = 0; begin < passed.size(); ++begin) {
        if (surface.states[begin] != PlaceState::front || passed[begin]) continue;
        context.check_cancelled();
        bool is_thin = false;
        for (u32 vertex = begin; !passed[vertex]; vertex = surface.next_on_border(vertex)) {
            passed[vertex] = true;
            const OtherSide side = sides.nearest(vertex);
            if (!(side.distance < thin_in_bins * side.bin)) continue;
            is_thin = true;
            least = std::min(least, side);
        }
        parts.loops += is_thin;
    }
    if (parts.loops > 0) parts.least = least.distance, parts.bin = least.bin;
    return parts;
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

}  // namespace scanmill::growing
