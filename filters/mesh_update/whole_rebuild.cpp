// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/whole_rebuild.hpp"

#include <numeric>

#include "delaunay/delaunay.hpp"

namespace scanmill::updating {

namespace {

const std::string row_column = "row";

ContextOptions nested_options(const Context& outer) {
    ContextOptions options;
    options.threads = outer.threads();
    options.is_cancelled = [&outer] { return outer.cancelled(); };
    return options;
}

}  // namespace

NestedContext::NestedContext(const Context& outer) : Context(nested_options(outer)) {}

Rebuilt rebuild_whole(std::span<const Vec3> positions, const Frame& frame, std::span<const u32> rows,
                      std::size_t facets, const TightCoconeParams& params, Context& context) {
    PointCloud points;
    points.frame = frame;
    Array<Vec3> chosen;
    chosen.reserve(rows.size());
    for (const u32 row : rows) chosen.push_back(positions[row]);
    points.positions = std::move(chosen);
    points.columns.add(Column(row_column, 1, Buffer<u32>(Array<u32>(rows.begin(), rows.end()))));
    NestedContext nested(context);
    const DelaunayResult tets = delaunay(points, {}, nested);
    const TightCoconeResult solid = tight_cocone(tets.tets, params, nested);
    for (const std::string& warning : nested.warnings()) context.warn(warning);
    Rebuilt result;
    const std::span<const u32> row_of = solid.mesh.vertex_columns.find(row_column)->values<u32>();
    result.rows.assign(row_of.begin(), row_of.end());
    result.triangles.assign(solid.mesh.triangles.begin(), solid.mesh.triangles.end());
    result.replaced.resize(facets);
    std::iota(result.replaced.begin(), result.replaced.end(), u32(0));
    return result;
}

}  // namespace scanmill::updating
