// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/listed_changes.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "mesh_update/changes.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::updating {

namespace {

double area_of(const TriangleMesh& mesh, const Triangle& t) { return area_vector(mesh.positions.span(), t).norm() / 2; }

}  // namespace

void list_changes(const Model& model, const Rebuilt& rebuilt, const Difference& difference, MeshUpdateResult& result,
                  Context& context) {
    const TriangleMesh& mesh = result.mesh;
    const std::size_t model_vertices = model.mesh.positions.size();
    std::vector<Triangle> before, after;
    for (const u32 facet : difference.old_facets) before.push_back(model.mesh.triangles[facet]);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        if (difference.is_new[i] == 1) after.push_back(mesh.triangles[i]);
    std::vector<u32> common;
    for (const u32 row : rebuilt.rows) common.push_back(row < model_vertices ? row : no_common_vertex);
    const std::span<const u32> source = mesh.vertex_columns.find("source")->values<u32>();
    u32 hint = NearestTriangle::none;
    std::unordered_set<u32> seen;
    for (const Change& change :
         changes({model.mesh.positions.span(), before}, {mesh.positions.span(), after}, common, context)) {
        MeshChange listed;
        listed.volume_added = change.volume_added;
        listed.volume_removed = change.volume_removed;
        double squared = -1;
        for (const u32 triangle : change.new_triangles) {
            bool has_points = false;
            for (const u32 vertex : after[triangle]) {
                if (common[vertex] != no_common_vertex) continue;
                has_points = true;
                if (!seen.insert(vertex).second) continue;
                context.check_cancelled();
                const NearestTriangle nearest = model.tree.nearest(mesh.positions[vertex], hint);
                hint = nearest.slot;
                if (nearest.squared_distance <= squared) continue;
                squared = nearest.squared_distance;
                listed.position = mesh.positions[vertex];
                listed.cloud = source[vertex];
            }
            if (has_points)
                listed.area += area_of(mesh, after[triangle]);
            else
                ++result.remeshed;
        }
        listed.deviation = std::sqrt(std::max(squared, 0.0));
        if (listed.area > 0) result.changes.push_back(listed);
    }
}

double far_share(const Model& model, std::span<const u32> facets, std::span<const CloudSurface* const> clouds,
                 const TriangleMesh& mesh, std::span<const u8> is_new, double distance, Context& context) {
    Array<Vec3> positions;
    Array<Triangle> given;
    for (const CloudSurface* cloud : clouds) {
        const u32 first = static_cast<u32>(positions.size());
        positions.insert(positions.end(), cloud->mesh.positions.begin(), cloud->mesh.positions.end());
        for (const Triangle& t : cloud->mesh.triangles) given.push_back({first + t[0], first + t[1], first + t[2]});
    }
    for (const u32 facet : facets) {
        const u32 first = static_cast<u32>(positions.size());
        for (const Vec3& corner : model.corners(facet)) positions.push_back(corner);
        given.push_back({first, first + 1, first + 2});
    }
    const TriangleTree tree(positions, given, context.threads());
    double far = 0, all = 0;
    u32 hint = NearestTriangle::none;
    for (std::size_t i = 0; i < is_new.size(); ++i) {
        if (is_new[i] == 0) continue;
        context.check_cancelled();
        const Triangle& t = mesh.triangles[i];
        const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
        const std::array<Vec3, 4> points{(a + b + c) / 3, (a + b) / 2, (b + c) / 2, (c + a) / 2};
        const bool is_far = std::ranges::any_of(
            points, [&](const Vec3& point) { return !tree.is_within(point, distance * distance, hint); });
        const double area = area_of(mesh, t);
        all += area;
        if (is_far) far += area;
    }
    return all > 0 ? far / all : 0;
}

}  // namespace scanmill::updating
