// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/replacement.hpp"

#include <cmath>
#include <unordered_set>

namespace scanmill::updating {

namespace {

constexpr std::size_t spacing_neighbours = 6;
/// Vertices whose foot on the cloud's surface is at most this many spacings from its loops are beside the cloud.
constexpr double border = 0.5;

TriangleTree loop_tree(const CloudSurface& surface, unsigned threads) {
    Array<Triangle> segments;
    for (const CloudLoop& loop : surface.loops)
        for (const u32 h : loop.half_edges) {
            const u32 end = half_edges::end(surface.mesh, h);
            segments.push_back({half_edges::start(surface.mesh, h), end, end});
        }
    return {surface.mesh.positions.span(), segments, threads};
}

}  // namespace

Array<u8> vertices_of_groups(const Model& model, const Groups& groups, const std::vector<bool>& replaced) {
    const std::span<const Triangle> triangles = model.mesh.triangles.span();
    Array<u8> discarded(model.mesh.positions.size(), u8(0));
    for (std::size_t facet = 0; facet < triangles.size(); ++facet)
        if (const std::int32_t group = groups.of_facet[facet];
            group != Groups::overlap && replaced[static_cast<std::size_t>(group)])
            for (const u32 vertex : triangles[facet]) discarded[vertex] = 1;
    for (std::size_t facet = 0; facet < triangles.size(); ++facet)
        if (groups.of_facet[facet] == Groups::overlap)
            for (const u32 vertex : triangles[facet]) discarded[vertex] = 0;
    return discarded;
}

void discard_under(const Model& model, std::span<const u32> overlap, const CloudSurface& surface,
                   const PointTree& cloud, double trim, std::span<const u8> before, std::span<u8> discarded,
                   Context& context) {
    const TriangleMesh& mesh = model.mesh;
    const TriangleTree tree(surface.mesh.positions.span(), surface.mesh.triangles.span(), context.threads());
    const TriangleTree loops = loop_tree(surface, context.threads());
    const double near = border * surface.spacing;
    NeighbourBuffer buffer;
    const auto is_beside_point = [&](const Vec3& position) {
        const Neighbour nearest = cloud.nearest_to(position, 1, buffer)[0];
        double sum = 0;
        const std::span<const Neighbour> around = cloud.nearest(nearest.index, spacing_neighbours, buffer);
        for (const Neighbour& neighbour : around) sum += std::sqrt(neighbour.squared);
        return std::sqrt(nearest.squared) < trim * sum / static_cast<double>(around.size());
    };
    u32 hint = NearestTriangle::none;
    std::unordered_set<u32> seen;
    std::vector<u32> corners;
    for (const u32 facet : overlap)
        for (u32 h = 3 * facet; h < 3 * facet + 3; ++h)
            if (seen.insert(model.start(h)).second) corners.push_back(h);
    const std::size_t on_overlap = corners.size();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if ((i & 0x3ff) == 0) context.check_cancelled();
        const u32 vertex = model.start(corners[i]);
        const Vec3& position = mesh.positions[vertex];
        if (before[vertex] == 1) continue;
        bool goes = false;
        if (i < on_overlap) {
            const NearestTriangle nearest = tree.nearest(position, hint);
            hint = nearest.slot;
            const Vec3 foot = tree.nearest_point(position, nearest.slot);
            goes = loops.nearest(foot).squared_distance > near * near;
        }
        if (!goes && !is_beside_point(position)) continue;
        discarded[vertex] = 1;
        model.for_each_around(corners[i], [&](u32 around) {
            const u32 next = half_edges::after(around);
            if (seen.insert(model.start(next)).second) corners.push_back(next);
        });
    }
}

}  // namespace scanmill::updating
