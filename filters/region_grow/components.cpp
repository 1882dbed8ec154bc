// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/components.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/base/disjoint_sets.hpp"

namespace scanmill::growing {

namespace {

struct Bulk {
    Vec3 area = Vec3::Zero();  ///< sum of the triangles' normals times their areas
    Vec3 moment = Vec3::Zero();
    double size = 0, volume = 0;
    bool open = false;

    bool faces_inwards() const {
        // About the centre of the area; `volume` is about the origin.
        const double about_centre = size > 0 ? volume - area.dot(moment / size) / 3 : volume;
        if (!open) return volume < 0;
        if (std::abs(about_centre) > 0.01 * size * std::sqrt(size)) return about_centre < 0;
        int axis = 2;
        for (int other : {1, 0})
            if (std::abs(area[other]) > std::abs(area[axis]) * (1 + 1e-9)) axis = other;
        return area[axis] < 0;
    }
};

}  // namespace

Pieces find_pieces(const Surface& surface) {
    DisjointSets sets(surface.states.size());
    for (const Triangle& t : surface.triangles) {
        sets.unite(t[0], t[1]);
        sets.unite(t[1], t[2]);
    }
    Pieces pieces;
    pieces.of_place.resize(surface.states.size());
    for (u32 place = 0; place < pieces.of_place.size(); ++place) {
        const u32 root = sets.find(place);  // the lowest of its set
        pieces.of_place[place] = surface.fans.empty(place) ? nobody
                                 : root == place           ? static_cast<u32>(pieces.count++)
                                                           : pieces.of_place[root];
    }
    return pieces;
}

void face_outwards(Surface& surface, const Pieces& pieces, std::span<const u32> groups) {
    std::vector<bool> open(pieces.count, false);
    for (u32 place = 0; place < groups.size(); ++place)
        if (surface.states[place] == PlaceState::front) open[pieces.of_place[place]] = true;
    DisjointSets sets(groups.size() + pieces.count);  // groups by their number, then pieces
    const auto set_of = [&](u32 place) { return sets.find(static_cast<u32>(groups.size()) + pieces.of_place[place]); };
    for (u32 place = 0; place < groups.size(); ++place)
        if (pieces.of_place[place] != nobody && open[pieces.of_place[place]] && groups[place] != nobody)
            sets.unite(groups[place], static_cast<u32>(groups.size()) + pieces.of_place[place]);

    std::vector<Bulk> bulks(groups.size() + pieces.count);
    const Vec3 origin = surface.positions.front();
    for (const Triangle& t : surface.triangles) {
        Bulk& bulk = bulks[set_of(t[0])];
        const Vec3 a = surface.positions[t[0]] - origin, b = surface.positions[t[1]] - origin,
                   c = surface.positions[t[2]] - origin;
        const Vec3 area = (b - a).cross(c - a) / 2;
        const double size = area.norm();
        bulk.area += area;
        bulk.size += size;
        bulk.moment += size / 3 * (a + b + c);
        bulk.volume += a.dot(b.cross(c)) / 6;
        bulk.open = open[pieces.of_place[t[0]]];
    }
    for (Triangle& t : surface.triangles)
        if (bulks[set_of(t[0])].faces_inwards()) std::swap(t[1], t[2]);
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
