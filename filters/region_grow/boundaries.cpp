// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/boundaries.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "region_grow/given_normals.hpp"
#include "region_grow/search_radii.hpp"

namespace scanmill::growing {

namespace {

constexpr double opposite_cosine = -0.5;  // cosine of 120 degrees
/// Least share of the distance to the opposite sheet that is along the normal: the sheet is across, not beside.
constexpr double least_across = 0.7;

struct OppositeSheet {
    double distance, voxel;
    bool operator<(const OppositeSheet& other) const {
        return distance != other.distance ? distance < other.distance : voxel < other.voxel;
    }
};

class OppositeSheets {
public:
    OppositeSheets(const Surface& surface, const Components& components) : surface_(surface), components_(components) {}

    /// Returns the nearest opposite sheet. If there is none, its distance is the search range.
    OppositeSheet nearest(u32 point) {
        const double voxel = surface_.search_radius[point] / radius_in_voxels;
        OppositeSheet best{thin_in_voxels * voxel, voxel};
        found_.clear();
        surface_.neighbourhoods.within(point, best.distance * best.distance, buffer_, found_);
        const Vec3& p = surface_.positions[point];
        for (u32 other : found_) {
            if (!surface_.is_used(other) || !are_opposite(point, other)) continue;
            const Vec3 offset = surface_.positions[other] - p;
            const double distance = offset.norm();
            if (std::abs(offset.dot(surface_.normals[point])) < least_across * distance) continue;
            best.distance = std::min(best.distance, distance);
            break;  // found_ is sorted by distance
        }
        return best;
    }

private:
    bool are_opposite(u32 point, u32 other) const {
        const double cosine = surface_.normals[point].dot(surface_.normals[other]);
        const bool same_component = components_.of_point[point] == components_.of_point[other];
        return (same_component ? cosine : -std::abs(cosine)) < opposite_cosine;
    }

    const Surface& surface_;
    const Components& components_;
    NeighbourBuffer buffer_;
    std::vector<u32> found_;
};

}  // namespace

ThinParts find_thin_parts(const Surface& surface, const Components& components, const Context& context) {
    ThinParts parts;
    if (surface.oriented) return parts;
    OppositeSheets sheets(surface, components);
    OppositeSheet least{std::numeric_limits<double>::infinity(), 0};
    surface.for_each_boundary_loop([&](const std::vector<u32>& loop) {
        context.check_cancelled();
        bool is_thin = false;
        for (const u32 vertex : loop) {
            const OppositeSheet sheet = sheets.nearest(vertex);
            if (!(sheet.distance < thin_in_voxels * sheet.voxel)) continue;
            is_thin = true;
            least = std::min(least, sheet);
        }
        parts.loops += is_thin;
    });
    if (parts.loops > 0) parts.least = least.distance, parts.voxel = least.voxel;
    return parts;
}

std::size_t points_at_seams(const Surface& surface) {
    constexpr std::size_t nearest = 6;
    OpposedNormals opposed;
    for (u32 point = 0; point < surface.states.size(); ++point) {
        if (surface.states[point] != PointState::front) continue;
        const std::span<const u32> others = surface.neighbourhoods.of(point);
        for (u32 other : others.first(std::min(nearest, others.size()))) {
            if (surface.states[other] != PointState::front ||
                !are_opposed(surface.normals[point], surface.normals[other]))
                continue;
            opposed.add(surface.normals[point], surface.positions[other] - surface.positions[point]);
            break;
        }
    }
    return opposed.are_on_one_side() ? 0 : opposed.beside;
}

}  // namespace scanmill::growing
