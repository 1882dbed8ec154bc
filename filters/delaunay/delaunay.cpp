// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/delaunay.hpp"

#include <fmt/format.h>

#include "delaunay/flatness.hpp"
#include "delaunay/point_weights.hpp"
#include "delaunay/triangulate.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/tets/canonical_cells.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill {

namespace {

/// The input rows that are kept, and for every kept row its vertex.
struct DistinctRows {
    Array<u32> kept, vertex_of_row;
};

DistinctRows distinct_rows(std::size_t count, std::span<const u32> duplicates) {
    DistinctRows rows;
    rows.vertex_of_row.resize(count);
    std::fill(rows.vertex_of_row.begin(), rows.vertex_of_row.end(), 0);
    for (u32 row : duplicates) rows.vertex_of_row[row] = 1;
    rows.kept.reserve(count - duplicates.size());
    for (u32 row = 0; row < count; ++row) {
        if (rows.vertex_of_row[row] == 1) continue;
        rows.vertex_of_row[row] = static_cast<u32>(rows.kept.size());
        rows.kept.push_back(row);
    }
    return rows;
}

/// Warns of vertices that are in no cell, and marks them in a column. Returns their number.
std::size_t mark_hidden(TetMesh& tets, Context& context) {
    const Array<u32> hidden = hidden_vertices(tets);
    if (hidden.empty()) return 0;
    tets.vertex_columns = with_hidden(tets.vertex_columns, tets.positions.size(), hidden, context);
    context.warn(
        fmt::format("{} of {} points {} hidden by the weights of other points and in no cell; the column 'hidden' "
                    "marks them. Smaller weights hide fewer points",
                    hidden.size(), tets.positions.size(), by_count(hidden.size(), "is", "are")));
    return hidden.size();
}

}  // namespace

DelaunayResult delaunay(const PointCloud& cloud, const DelaunayParams& params, Context& context) {
    const std::span<const Vec3> positions = cloud.positions.span();
    require_finite(positions);
    require_spatial(positions, cloud.frame, context.threads());

    PointWeights weighted;
    RawTriangulation raw;
    if (params.weights) {
        weighted = point_weights(cloud, params, context);
        raw = triangulate_weighted(positions, weighted.weights, std::move(weighted.duplicates), context);
    } else {
        if (params.factor != DelaunayParams().factor) context.warn("factor has no effect while `weights` is none");
        raw = triangulate(positions, context);
    }
    if (raw.dimension < 3) refuse_flat(positions, raw.dimension, 0, cloud.frame);
    context.progress(0.85);
    context.check_cancelled();

    DelaunayResult result;
    result.duplicates = raw.duplicates.size();
    result.tets.frame = cloud.frame;
    if (raw.duplicates.empty()) {
        result.tets.positions = cloud.positions;
        result.tets.vertex_columns = cloud.columns;
        result.tets.weights = std::move(weighted.weights);
    } else {
        const DistinctRows rows = distinct_rows(positions.size(), raw.duplicates);
        result.tets.positions = gather(cloud.positions, rows.kept);
        result.tets.vertex_columns = cloud.columns.gather(rows.kept);
        if (params.weights) result.tets.weights = gather(Buffer<double>(std::move(weighted.weights)), rows.kept);
        // Vertices keep the order of their rows, so the cells' corners stay in canonical order.
        for (Tetrahedron& cell : raw.cells)
            for (u32& corner : cell) corner = rows.vertex_of_row[corner];
    }

    CanonicalCells canonical = canonical_cells(std::move(raw.cells), std::move(raw.neighbours),
                                               result.tets.positions.size(), context.threads());
    result.tets.cells = std::move(canonical.cells);
    result.tets.neighbours = std::move(canonical.neighbours);
    if (params.weights) result.hidden = mark_hidden(result.tets, context);

    context.metric("cells", static_cast<double>(result.tets.cells.size()));
    context.metric("duplicates", static_cast<double>(result.duplicates));
    context.metric("hidden", static_cast<double>(result.hidden));
    context.progress(1);
    return result;
}

}  // namespace scanmill
