// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/triangulate.hpp"

#include "delaunay/insertion.hpp"
#include "delaunay/raw_cells.hpp"

namespace scanmill {

namespace {

template <class Triangulation>
RawTriangulation triangulate_in(std::span<const Vec3> positions, Context& context) {
    RawTriangulation raw;
    Triangulation triangulation;
    raw.duplicates = insert_all(triangulation, positions, context);
    raw.dimension = triangulation.dimension();
    if (raw.dimension == 3) fill_cells(triangulation, positions.size(), context.threads(), raw);
    return raw;
}

}  // namespace

RawTriangulation triangulate(std::span<const Vec3> positions, Context& context) {
    return is_worth_sharing(positions.size(), context.threads())
               ? triangulate_in<SharedTriangulation>(positions, context)
               : triangulate_in<LoneTriangulation>(positions, context);
}

}  // namespace scanmill
