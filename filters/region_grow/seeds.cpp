// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/seeds.hpp"

#include <algorithm>
#include <numeric>

namespace scanmill::growing {

namespace {

/// Carries the surface's facing on to unused places.
class Facing {
public:
    Facing(Surface& surface, Array<u32>& groups) : surface_(surface), groups_(groups) {
        groups_.resize(surface.samples.size());
        std::ranges::fill(groups_, nobody);
    }

    /// From wherever the surface is near.
    void spread_to(std::span<const u32> unused) {
        std::vector<u32> turned;
        for (u32 place : unused)
            for (u32 other : surface_.neighbourhoods.of(place))
                if (surface_.is_used(other) && waits(place)) {
                    turn(other, place);
                    turned.push_back(place);
                }
        go_on(turned);
    }
    /// From the triangles from row `first` on.
    void spread_from(std::size_t first) {
        std::vector<u32> turned;
        for (std::size_t row = first; row < surface_.triangles.size(); ++row)
            for (u32 corner : surface_.triangles[row]) turned.push_back(corner);
        go_on(turned);
    }
    /// Gives the places that joined the surface since `first`, by triangle, the group of the piece's beginning.
    void name_group(std::size_t first, u32 seed) {
        const u32 group = groups_[seed] == nobody ? seed : groups_[seed];
        for (std::size_t row = first; row < surface_.triangles.size(); ++row)
            for (u32 corner : surface_.triangles[row])
                if (groups_[corner] == nobody) groups_[corner] = group;
    }

private:
    bool waits(u32 place) const { return surface_.states[place] == PlaceState::unused && groups_[place] == nobody; }

    void go_on(std::vector<u32>& turned) {
        for (std::size_t i = 0; i < turned.size(); ++i)  // grows on the way
            for (u32 other : surface_.neighbourhoods.of(turned[i]))
                if (waits(other)) {
                    turn(turned[i], other);
                    turned.push_back(other);
                }
    }

    void turn(u32 from, u32 to) {
        const Vec3 way = (surface_.positions[to] - surface_.positions[from]).normalized();
        const Vec3& facing = surface_.normals[from];
        const Vec3 mirrored = facing - 2 * facing.dot(way) * way;
        if (!surface_.oriented && mirrored.dot(surface_.normals[to]) < 0) surface_.normals[to] = -surface_.normals[to];
        groups_[to] = groups_[from];
    }

    Surface& surface_;
    Array<u32>& groups_;
};

}  // namespace

bool grow_all_pieces(Surface& surface, Growth& growth, std::optional<u32> start, Array<u32>& groups) {
    Facing facing(surface, groups);
    const auto begin = [&](u32 place) {
        const std::size_t before = surface.triangles.size();
        if (!growth.start(place)) return false;
        facing.name_group(before, place);
        return true;
    };
    const auto flatter = [&](u32 a, u32 b) {
        return surface.roughness[a] != surface.roughness[b] ? surface.roughness[a] < surface.roughness[b] : a < b;
    };
    Array<u32> places(surface.samples.size());
    std::iota(places.begin(), places.end(), 0);
    if (!begin(start ? *start : *std::ranges::min_element(places, flatter)) && start) return false;

    // The first piece usually is all there is; what it left is sorted, not everything.
    const auto used = [&](u32 place) { return surface.states[place] != PlaceState::unused; };
    places.erase(std::ranges::remove_if(places, used).begin(), places.end());
    std::ranges::sort(places, flatter);
    facing.spread_to(places);
    for (u32 place : places) {
        const std::size_t before = surface.triangles.size();
        if (begin(place)) facing.spread_from(before);
    }
    return true;
}

}  // namespace scanmill::growing
