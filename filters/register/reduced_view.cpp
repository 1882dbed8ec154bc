// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/reduced_view.hpp"

#include <cmath>
#include <vector>

#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/registration/thinning.hpp"

namespace scanmill::registration {

namespace {

/// All in multiples of the resolution.
constexpr double normal_radius = 2, descriptor_radius = 5, sight_edge = 1.0 / 3;
/// Distance of the kept points for about as many points as there are occupied voxels with the resolution as edge.
constexpr double thinning = 0.8;
/// For a normal's plane (the point itself is one more), and for a descriptor.
constexpr std::size_t normal_neighbours = 29, descriptor_neighbours = 100;

/// Points on a line have no plane; the direction to the scanner then is the normal.
constexpr double least_flatness = 1e-3;

/// The normal at point i is on the side of outside(i).
template <class Outside>
Array<Vec3> normals_of(const PointTree& tree, double radius, const Outside& outside) {
    const std::span<const Vec3> points = tree.positions();
    Array<Vec3> normals(points.size()), around;
    NeighbourBuffer buffer;
    for (u32 i = 0; i < points.size(); ++i) {
        around.clear();
        around.push_back(Vec3::Zero());
        for (const Neighbour& n : tree.nearest(i, normal_neighbours, buffer))
            if (n.squared <= radius * radius) around.push_back(points[n.index] - points[i]);
        const Scatter scatter = scatter_of(around);
        if (scatter.flatness < least_flatness)
            normals[i] = outside(i);
        else
            normals[i] = scatter.normal.dot(outside(i)) < 0 ? Vec3(-scatter.normal) : scatter.normal;
    }
    return normals;
}

/// `outside` is one direction for all points, or one for each row of `points`.
ReducedView reduced(std::span<const Vec3> points, std::span<const Vec3> outside, double resolution, SightLines sight) {
    const Array<Vec3> means = thinned_means(points, thinning * resolution);
    const PointTree tree(means);
    const std::span<const Vec3> positions = tree.positions();
    Array<Vec3> sides(positions.size(), outside[0]);
    if (outside.size() > 1) {
        const Array<u32> rows = thinned_rows(points, thinning * resolution);
        for (std::size_t i = rows.size(); i-- > 0;) sides[tree.index_of_row()[i]] = outside[rows[i]];
    }
    const Array<Vec3> tree_normals = normals_of(tree, normal_radius * resolution, [&](u32 i) { return sides[i]; });
    const Array<Descriptor> tree_descriptors =
        point_descriptors(tree, tree_normals, descriptor_radius * resolution, descriptor_neighbours);
    // In the order of the rows and not of the tree: a turned view has the same order.
    Array<Vec3> kept, normals;
    Array<Descriptor> descriptors;
    std::vector<bool> is_used(positions.size(), false);
    for (const u32 index : tree.index_of_row()) {
        if (is_used[index]) continue;
        is_used[index] = true;
        kept.push_back(positions[index]);
        normals.push_back(tree_normals[index]);
        descriptors.push_back(tree_descriptors[index]);
    }
    NearestWithin nearest(kept, largest_reach * resolution);
    return {resolution,        std::move(kept),    std::move(normals), std::move(descriptors),
            extent_of(points), std::move(nearest), std::move(sight)};
}

}  // namespace

ViewExtent extent_of(std::span<const Vec3> points) {
    if (points.empty()) return {};
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : points) sum += p - points[0];
    const Vec3 centre = points[0] + sum / static_cast<double>(points.size());
    double squares = 0;
    for (const Vec3& p : points) squares += (p - centre).squaredNorm();
    return {centre, std::sqrt(squares / static_cast<double>(points.size()))};
}

ReducedView reduced_view(std::span<const Vec3> points, const Vec3& to_scanner, double resolution, bool sees_all) {
    Array<Vec3> rays;
    for (const u32 row : thinned_rows(points, thinning * sight_edge * resolution)) rays.push_back(points[row]);
    return reduced(points, {&to_scanner, 1}, resolution, SightLines(rays, to_scanner, resolution, sees_all));
}

ReducedView reduced_surface(std::span<const Vec3> points, std::span<const Vec3> outside, double resolution) {
    return reduced(points, outside, resolution, SightLines({}, Vec3::UnitZ(), resolution));
}

}  // namespace scanmill::registration
