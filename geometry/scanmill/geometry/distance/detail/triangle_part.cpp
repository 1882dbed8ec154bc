// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/detail/triangle_part.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanmill::triangle_parts {

namespace {

/// A part is not cut at an edge that it crosses by less than the larger of two limits. The first is a share of the
/// part's distance, because the distance hardly grows over it. The second is a share of the part's size, so that cuts
/// leave no slivers.
constexpr double harmless_of_distance = 0.05;
constexpr double harmless_of_size = 1e-3;

/// The distance to one triangle is convex. So on no point of the part is it larger than at one of the corners.
void try_triangle(TrianglePart& part, u32 slot) {
    if (slot == NearestTriangle::none) return;
    const double least = part.upper * part.upper;
    double farthest = 0;
    for (const PartCorner& corner : part.corners) {
        farthest = std::max(farthest, part.other->squared_distance(corner.position, slot));
        if (farthest > least) return;
    }
    if (std::sqrt(farthest) >= part.upper) return;
    part.upper = std::sqrt(farthest);
    part.bounding = slot;
}

Vec3 centre_of(const TrianglePart& part) {
    return (part.corners[0].position + part.corners[1].position + part.corners[2].position) / 3;
}

std::size_t longest_edge(const TrianglePart& part) {
    std::size_t longest = 0;
    double length = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double edge = (part.corners[(i + 1) % 3].position - part.corners[i].position).squaredNorm();
        if (edge > length) {
            length = edge;
            longest = i;
        }
    }
    return longest;
}

/// Signed distances of a part's corners to a plane: positive outside.
using PlaneDistances = std::array<double, 3>;

double overhang(const PlaneDistances& distances) {
    return std::min(std::ranges::max(distances), -std::ranges::min(distances));
}

/// Distances of the corners to one of the planes through edges of the triangle below: the plane that the part crosses
/// farthest.
PlaneDistances farthest_crossed(const TrianglePart& part) {
    const std::array<Vec3, 3> below = part.other->corners(part.below);
    const Vec3 normal = (below[1] - below[0]).cross(below[2] - below[0]);
    PlaneDistances best{};
    for (std::size_t edge = 0; edge < 3; ++edge) {
        const Vec3 outwards = (below[(edge + 1) % 3] - below[edge]).cross(normal);
        const double length = outwards.norm();
        if (!(length > 0)) continue;
        PlaneDistances distances;
        for (std::size_t i = 0; i < 3; ++i)
            distances[i] = outwards.dot(part.corners[i].position - below[edge]) / length;
        if (overhang(distances) > overhang(best)) best = distances;
    }
    return best;
}

PartCorner between(const PartCorner& from, const PartCorner& to, double share) {
    return {from.position + share * (to.position - from.position)};
}

TrianglePart with_corners(const TrianglePart& part, const PartCorner& a, const PartCorner& b, const PartCorner& c) {
    TrianglePart result = part;
    result.corners = {a, b, c};
    result.seen = 0;
    return result;
}

/// Cuts along the plane to which the corners have these distances. Pre: corners on both sides of it.
Cut cut_along(const TrianglePart& part, const PlaneDistances& distances) {
    // Finds the corner that is alone on its side. A corner on the plane belongs to the side of the other two.
    std::size_t alone = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double next = distances[(i + 1) % 3], last = distances[(i + 2) % 3];
        if ((distances[i] > 0 && next <= 0 && last <= 0) || (distances[i] < 0 && next >= 0 && last >= 0)) alone = i;
    }
    const PartCorner& a = part.corners[alone];
    const PartCorner& b = part.corners[(alone + 1) % 3];
    const PartCorner& c = part.corners[(alone + 2) % 3];
    const auto share = [&](std::size_t to) { return distances[alone] / (distances[alone] - distances[to]); };
    const PartCorner on_ab = between(a, b, share((alone + 1) % 3)), on_ac = between(a, c, share((alone + 2) % 3));
    return {{with_corners(part, a, on_ab, on_ac), with_corners(part, on_ab, b, c), with_corners(part, on_ab, c, on_ac)},
            3};
}

Cut cut_across_longest_edge(const TrianglePart& part) {
    const std::size_t longest = longest_edge(part);
    const PartCorner& a = part.corners[longest];
    const PartCorner& b = part.corners[(longest + 1) % 3];
    const PartCorner& c = part.corners[(longest + 2) % 3];
    const PartCorner middle = between(a, b, 0.5);
    return {{with_corners(part, a, middle, c), with_corners(part, middle, b, c)}, 2};
}

}  // namespace

void bound_by_known(TrianglePart& part, double enough) {
    for (const u32 slot :
         {part.below, part.bounding, part.corners[0].nearest, part.corners[1].nearest, part.corners[2].nearest}) {
        try_triangle(part, slot);
        if (part.upper <= enough) return;
    }
}

void bound(TrianglePart& part, double enough) {
    bound_by_known(part, enough);
    if (part.upper <= enough) return;
    const Vec3 centre = centre_of(part);
    const NearestTriangle at_centre = part.other->nearest(centre, part.below);
    double radius = 0;
    for (const PartCorner& corner : part.corners) radius = std::max(radius, (corner.position - centre).norm());
    const double distance = std::sqrt(at_centre.squared_distance);
    part.seen = std::max(part.seen, distance);
    part.upper = std::min(part.upper, distance + radius);
    part.below = at_centre.slot;
    try_triangle(part, part.below);
    for (PartCorner& corner : part.corners) {
        if (corner.nearest != NearestTriangle::none || part.upper <= enough) continue;
        const NearestTriangle found = part.other->nearest(corner.position, part.below);
        corner.nearest = found.slot;
        part.seen = std::max(part.seen, std::sqrt(found.squared_distance));
        try_triangle(part, corner.nearest);
    }
}

Cut cut(const TrianglePart& part, double enough) {
    assert(part.below != NearestTriangle::none);
    const std::size_t longest = longest_edge(part);
    const double size = (part.corners[(longest + 1) % 3].position - part.corners[longest].position).norm();
    const double harmless = std::max(harmless_of_distance * part.seen, harmless_of_size * size);
    const PlaneDistances distances = farthest_crossed(part);
    Cut result = overhang(distances) > harmless ? cut_along(part, distances) : cut_across_longest_edge(part);
    for (std::size_t i = 0; i < result.count; ++i) bound(result.parts[i], enough);
    return result;
}

}  // namespace scanmill::triangle_parts
