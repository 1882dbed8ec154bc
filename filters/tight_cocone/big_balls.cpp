// SPDX-License-Identifier: GPL-3.0-or-later
#include "tight_cocone/big_balls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delaunay/triangulate.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/tets/canonical_cells.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"
#include "scanmill/geometry/tets/voronoi.hpp"

namespace scanmill::cocones {

namespace {

/// If fewer big cells are left inside than this share, the walk has entered the object.
constexpr double least_inside = 0.01;

/// By vertex: the distance to its k-th nearest other point, or to the farthest of fewer.
Array<double> neighbour_distances(std::span<const Vec3> positions, u32 neighbours, Context& context) {
    const PointTree tree(positions, context.threads());
    Array<u32> row_of(positions.size());
    for (u32 row = 0; row < positions.size(); ++row) row_of[tree.index_of_row()[row]] = row;
    Array<double> distances(positions.size());
    tree.for_each_nearest(neighbours, context.threads(), [&](const NeighbourBatch& batch) {
        context.check_cancelled();
        for (std::size_t i = 0; i < batch.indices.size(); ++i)
            distances[row_of[batch.indices[i]]] = std::sqrt(batch.of(i).back().squared);
    });
    return distances;
}

}  // namespace

Array<u32> outer_points(const TetMesh& tets, u32 neighbours, double factor, Context& context) {
    const Array<double> distances = neighbour_distances(tets.positions.span(), neighbours, context);
    const Array<Vec3> centres = circumcentres(tets, context);
    const std::size_t count = tets.cells.size();
    Array<double> radii(count);  // 0 for cells that are not big
    std::size_t big = 0, outer = 0;
    for (u32 cell = 0; cell < count; ++cell) {
        double largest = 0;
        for (const u32 vertex : tets.cells[cell]) largest = std::max(largest, distances[vertex]);
        const double radius = (centres[cell] - tets.positions[tets.cells[cell][0]]).norm();
        radii[cell] = radius > factor * largest ? radius : 0;
        big += radii[cell] > 0;
    }

    Array<u8> is_outer(count, u8(0)), is_kept(tets.positions.size(), u8(0));
    std::vector<u32> queue;
    const auto reach = [&](u32 cell) {
        if (radii[cell] > 0 && is_outer[cell] == 0) {
            is_outer[cell] = 1;
            queue.push_back(cell);
        }
    };
    for (u32 cell = 0; cell < count; ++cell)
        for (int corner = 0; corner < 4; ++corner) {
            if (tets.neighbours[cell][static_cast<std::size_t>(corner)] != TetMesh::outside_hull) continue;
            for (int k = 0; k < 4; ++k)
                if (k != corner) is_kept[tets.cells[cell][static_cast<std::size_t>(k)]] = 1;
            if (dual_edge(tets, centres, cell, corner).from > 0) reach(cell);
        }
    for (; outer < queue.size(); ++outer) {
        if ((outer & 0xffff) == 0) context.check_cancelled();
        const u32 cell = queue[outer];
        for (const u32 vertex : tets.cells[cell]) is_kept[vertex] = 1;
        for (const u32 across : tets.neighbours[cell])
            if (across != TetMesh::outside_hull && (centres[cell] - centres[across]).squaredNorm() <
                                                       radii[cell] * radii[cell] + radii[across] * radii[across])
                reach(across);
    }
    if (big == 0)
        throw Error(
            "noise-factor {}: none of {} cells is large compared with the distance to nearest neighbour number {}",
            factor, count, neighbours)
            .hint("fewer noise-neighbours or a smaller noise-factor make more cells large");
    if (static_cast<double>(big - outer) < least_inside * static_cast<double>(big))
        throw Error("noise-factor {}: the outside reaches {} of {} large cells, so it has entered the object", factor,
                    outer, big)
            .hint(fmt::format(
                "a larger noise-factor, such as {:.2g}, makes fewer cells large; the noise mode needs a scan "
                "without holes",
                1.5 * factor));

    Array<u32> kept;
    for (u32 vertex = 0; vertex < is_kept.size(); ++vertex)
        if (is_kept[vertex] == 1) kept.push_back(vertex);
    return kept;
}

TetMesh tets_of(const TetMesh& tets, std::span<const u32> vertices, Context& context) {
    TetMesh result;
    result.frame = tets.frame;
    result.positions = gather(tets.positions, vertices);
    result.vertex_columns = tets.vertex_columns.gather(vertices);
    RawTriangulation raw = triangulate(result.positions.span(), context);
    CanonicalCells canonical =
        canonical_cells(std::move(raw.cells), std::move(raw.neighbours), result.positions.size(), context.threads());
    result.cells = std::move(canonical.cells);
    result.neighbours = std::move(canonical.neighbours);
    return result;
}

}  // namespace scanmill::cocones
