// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `tets`: a Delaunay tetrahedralisation as index arrays, with an optional inside/outside label per cell and an
/// optional weight per vertex.

#include <array>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Four vertex indices, positively oriented: orient3d(v0, v1, v2, v3) > 0, that is (v1-v0)×(v2-v0)·(v3-v0) > 0.
using Tetrahedron = std::array<u32, 4>;

struct TetMesh {
    /// Value in `neighbours` for a facet on the convex hull.
    static constexpr u32 outside_hull = ~u32(0);

    Frame frame;
    /// #vertices, relative to frame.origin: the distinct input points, in input order.
    Buffer<Vec3> positions;
    ColumnTable vertex_columns;
    /// #vertices, squared lengths in frame.unit, finite and not negative. Empty if the points have no weights, which is
    /// equivalent to equal weights. With weights, the cells form the regular triangulation. Let (c, r²) be the sphere
    /// orthogonal to the corners of a cell: then no vertex p has a negative power |c - p|² - w_p - r². A vertex may be
    /// hidden, which means that it is in no cell.
    Buffer<double> weights;
    /// #cells finite cells in canonical order: each cell begins with its smallest index and is the lexicographically
    /// smallest even permutation of itself; cells ascend lexicographically.
    Buffer<Tetrahedron> cells;
    /// #cells: neighbours[c][i] is the cell across the facet opposite to cells[c][i], or outside_hull.
    Buffer<std::array<u32, 4>> neighbours;
    /// #cells, 1 inside and 0 outside the solid; empty without labels.
    Buffer<u8> inside;
};
constexpr auto fields(const TetMesh*) {
    return std::tuple{field("frame", &TetMesh::frame),
                      field("positions", &TetMesh::positions).means(Meaning::position),
                      field("vertex-columns", &TetMesh::vertex_columns),
                      field("weights", &TetMesh::weights).means(Meaning::length, 2),
                      field("cells", &TetMesh::cells),
                      field("neighbours", &TetMesh::neighbours),
                      field("inside", &TetMesh::inside)};
}

/// The corners of a positively oriented cell's facet opposite to corner i, ordered so that the facet's normal (right
/// hand rule) points away from corner i, out of the cell.
inline constexpr std::array<std::array<int, 3>, 4> outward_facet{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

}  // namespace scanmill
