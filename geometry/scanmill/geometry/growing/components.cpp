// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/components.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "scanmill/base/disjoint_sets.hpp"

namespace scanmill::growing {

namespace {

/// Sums of areas and volumes over the triangles of a component or a group.
struct Sums {
    Vec3 area = Vec3::Zero();    ///< normals times areas
    Vec3 moment = Vec3::Zero();  ///< centroids times areas
    double size = 0, volume = 0;
    bool open = false;

    bool faces_inwards(const std::optional<Vec3>& up) const {
        // `volume` is about the origin; this volume is about the centroid of the area.
        const double about_centroid = size > 0 ? volume - area.dot(moment / size) / 3 : volume;
        if (!open) return volume < 0;
        if (std::abs(about_centroid) > 0.01 * size * std::sqrt(size)) return about_centroid < 0;
        if (up) return area.dot(*up) < 0;
        int axis = 2;
        for (int other : {1, 0})
            if (std::abs(area[other]) > std::abs(area[axis]) * (1 + 1e-9)) axis = other;
        return area[axis] < 0;
    }
};

}  // namespace

Components find_components(const Surface& surface) {
    DisjointSets sets(surface.states.size());
    for (const Triangle& t : surface.triangles) {
        sets.unite(t[0], t[1]);
        sets.unite(t[1], t[2]);
    }
    Components components;
    components.of_point.resize(surface.states.size());
    for (u32 point = 0; point < components.of_point.size(); ++point) {
        const u32 root = sets.find(point);  // the lowest of its set
        components.of_point[point] = surface.fans.empty(point) ? invalid_index
                                     : root == point           ? static_cast<u32>(components.count++)
                                                               : components.of_point[root];
    }
    return components;
}

void orient_outwards(Surface& surface, const Components& components, std::span<const u32> groups,
                     const std::optional<Vec3>& up) {
    std::vector<bool> open(components.count, false);
    for (u32 point = 0; point < groups.size(); ++point)
        if (surface.states[point] == PointState::front) open[components.of_point[point]] = true;
    // The sets contain first the numbers of the groups, then the components.
    DisjointSets sets(groups.size() + components.count);
    const auto node_of = [&](u32 point) { return static_cast<u32>(groups.size()) + components.of_point[point]; };
    for (u32 point = 0; point < groups.size(); ++point)
        if (components.of_point[point] != invalid_index && open[components.of_point[point]] &&
            groups[point] != invalid_index)
            sets.unite(groups[point], node_of(point));

    std::vector<Sums> sums(groups.size() + components.count);
    const Vec3 origin = surface.positions.front();
    for (const Triangle& t : surface.triangles) {
        Sums& sum = sums[sets.find(node_of(t[0]))];
        const Vec3 a = surface.positions[t[0]] - origin, b = surface.positions[t[1]] - origin,
                   c = surface.positions[t[2]] - origin;
        const Vec3 area = (b - a).cross(c - a) / 2;
        const double size = area.norm();
        sum.area += area;
        sum.size += size;
        sum.moment += size / 3 * (a + b + c);
        sum.volume += a.dot(b.cross(c)) / 6;
        sum.open = open[components.of_point[t[0]]];
    }
    for (Triangle& t : surface.triangles)
        if (sums[sets.find(node_of(t[0]))].faces_inwards(up)) std::swap(t[1], t[2]);
}

void orient_like_normals(Surface& surface, const Components& components, const Array<Vec3>& given) {
    struct Votes {
        std::size_t along = 0, against = 0;
    };
    std::vector<Votes> votes(components.count);
    for (const Triangle& t : surface.triangles) {
        const Vec3 normal = surface.facet_normal(t[0], t[1], t[2]);
        for (u32 corner : t) {
            const double cosine = normal.dot(given[corner]);
            votes[components.of_point[corner]].along += cosine > 0;
            votes[components.of_point[corner]].against += cosine < 0;
        }
    }
    for (Triangle& t : surface.triangles) {
        const auto [along, against] = votes[components.of_point[t[0]]];
        if (against > 0 && against >= 3 * along) std::swap(t[1], t[2]);
    }
}

}  // namespace scanmill::growing
