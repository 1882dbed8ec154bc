// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/rebuilt.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "delaunay/delaunay.hpp"
#include "mesh_update/local_rebuild.hpp"
#include "mesh_update/nested_context.hpp"
#include "scanmill/base/disjoint_sets.hpp"

namespace scanmill::updating {

namespace {

const std::string row_column = "row";
constexpr u32 none = ~u32(0);

std::vector<u32> removed_facets(const Model& model, std::span<const u32> discarded, const Groups& groups) {
    std::vector<bool> is_discarded(model.mesh.positions.size());
    for (const u32 vertex : discarded) is_discarded[vertex] = true;
    std::vector<u32> removed;
    for (u32 facet = 0; facet < groups.of_facet.size(); ++facet)
        if (groups.of_facet[facet] == Groups::overlap ||
            std::ranges::any_of(model.mesh.triangles[facet], [&](u32 vertex) { return bool(is_discarded[vertex]); }))
            removed.push_back(facet);
    return removed;
}

/// The facets that go, divided among the clouds. Points that are not among the rows are left out.
std::vector<LocalChange> local_changes(const Model& model, std::span<const u32> removed,
                                       std::span<const CloudPart> clouds, std::span<const u32> rows) {
    const auto index_of = [&](u32 facet) {
        const auto found = std::ranges::lower_bound(removed, facet);
        return found != removed.end() && *found == facet ? static_cast<u32>(found - removed.begin()) : none;
    };
    DisjointSets connected(removed.size()), together(clouds.size());
    for (u32 i = 0; i < removed.size(); ++i)
        for (u32 h = 3 * removed[i]; h < 3 * removed[i] + 3; ++h)
            if (const u32 beside = index_of(model.opposite[h] / 3); beside != none) connected.unite(i, beside);
    std::vector<u32> cloud_of(removed.size(), none);  // by the lowest index of connected facets
    for (u32 c = 0; c < clouds.size(); ++c)
        for (const LoopOverlap& loop : clouds[c].loops)
            for (const u32 facet : loop.facets) {
                u32& cloud = cloud_of[connected.find(index_of(facet))];
                if (cloud == none) cloud = c;
                together.unite(cloud, c);
            }
    std::vector<LocalChange> changes(clouds.size());
    for (u32 i = 0; i < removed.size(); ++i) {
        const u32 cloud = cloud_of[connected.find(i)];
        changes[together.find(cloud == none ? 0 : cloud)].removed.push_back(removed[i]);
    }
    for (u32 c = 0; c < clouds.size(); ++c) {
        LocalChange& change = changes[together.find(c)];
        for (const u32 point : clouds[c].points)
            if (std::ranges::binary_search(rows, static_cast<u32>(model.mesh.positions.size()) + point))
                change.points.push_back(point);
        change.spacing = std::max(change.spacing, clouds[c].spacing);
    }
    std::erase_if(changes, [](const LocalChange& change) { return change.points.empty(); });
    return changes;
}

/// The model with its exchanged facets. `points`: number of all positions.
Rebuilt assembled(const Model& model, const LocalRebuild& part, std::span<const u32> rows, std::size_t positions) {
    const u32 model_vertices = static_cast<u32>(model.mesh.positions.size());
    std::vector<bool> is_left_out(positions);
    for (const u32 vertex : part.dropped) is_left_out[vertex] = true;
    for (u32 row = model_vertices; row < positions; ++row) is_left_out[row] = true;
    for (const Triangle& t : part.triangles)
        for (const u32 vertex : t)
            if (vertex >= model_vertices) is_left_out[vertex] = false;
    Rebuilt result;
    std::vector<u32> number(positions, none);
    for (const u32 row : rows) {
        if (is_left_out[row]) continue;
        number[row] = static_cast<u32>(result.rows.size());
        result.rows.push_back(row);
    }
    const auto add = [&](const Triangle& t) {
        assert(std::ranges::all_of(t, [&](u32 row) { return number[row] != none; }));
        result.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    };
    result.replaced.assign(part.replaced.begin(), part.replaced.end());
    result.triangles.reserve(model.mesh.triangles.size() - part.replaced.size() + part.triangles.size());
    auto replaced = part.replaced.begin();
    for (u32 facet = 0; facet < model.mesh.triangles.size(); ++facet)
        if (replaced != part.replaced.end() && *replaced == facet)
            ++replaced;
        else
            add(model.mesh.triangles[facet]);
    result.fixed = result.triangles.size();
    for (const Triangle& t : part.triangles) add(t);
    return result;
}

}  // namespace

Rebuilt rebuild_whole(const Model& model, std::span<const Vec3> positions, std::span<const u32> rows,
                      std::span<const u32> discarded, const Groups& groups, const TightCoconeParams& params,
                      Context& context) {
    PointCloud points;
    points.frame = model.mesh.frame;
    Array<Vec3> chosen;
    chosen.reserve(rows.size());
    for (const u32 row : rows) chosen.push_back(positions[row]);
    points.positions = std::move(chosen);
    points.columns.add(Column(row_column, 1, Buffer<u32>(Array<u32>(rows.begin(), rows.end()))));
    NestedContext first(context, 0.4, 0.6), second(context, 0.6, 0.85);
    const DelaunayResult tets = delaunay(points, {}, first);
    const TightCoconeResult solid = tight_cocone(tets.tets, params, second);
    const std::span<const u32> row_of = solid.mesh.vertex_columns.find(row_column)->values<u32>();
    std::vector<Triangle> surface(solid.mesh.triangles.begin(), solid.mesh.triangles.end());
    for (Triangle& t : surface)
        for (u32& vertex : t) vertex = row_of[vertex];
    Rebuilt result;
    if (const std::optional<LocalRebuild> part =
            exchanged(model.mesh, model.opposite, model.tree, positions.subspan(model.mesh.positions.size()),
                      removed_facets(model, discarded, groups), surface, context)) {
        result = assembled(model, *part, rows, positions.size());
    } else {
        result.rows.assign(row_of.begin(), row_of.end());
        result.triangles.assign(solid.mesh.triangles.begin(), solid.mesh.triangles.end());
        result.replaced.resize(model.mesh.triangles.size());
        std::iota(result.replaced.begin(), result.replaced.end(), u32(0));
    }
    for (const Context* nested : {static_cast<const Context*>(&first), static_cast<const Context*>(&second)})
        result.warnings.insert(result.warnings.end(), nested->warnings().begin(), nested->warnings().end());
    return result;
}

Rebuilt rebuild_around(const Model& model, std::span<const Vec3> positions, std::span<const u32> rows,
                       std::span<const u32> discarded, const Groups& groups, std::span<const CloudPart> clouds,
                       const CoconeParams& params, Context& context) {
    const std::vector<u32> removed = removed_facets(model, discarded, groups);
    const LocalRebuild part =
        rebuild_locally(model.mesh, model.opposite, model.tree, positions.subspan(model.mesh.positions.size()),
                        local_changes(model, removed, clouds, rows), discarded, params, context);
    return assembled(model, part, rows, positions.size());
}

}  // namespace scanmill::updating
