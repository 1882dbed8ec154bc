// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The boundary of a set of cells, and whether it is a 2-manifold.

#include <span>

#include "alpha_solid/disjoint_sets.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill::alpha {

/// What a cell counts as. Only `solid` cells are in the solid that is being chosen.
enum Label : u8 {
    outside = 0,
    solid = 1,
    left_out = 2  ///< in the alpha-solid, but in a piece of it that is not kept
};

/// The facets between solid and other cells, outward, in vertices of `tets`; ascending by cell, then by corner.
Array<Triangle> boundary_triangles(const TetMesh& tets, std::span<const u8> labels, unsigned threads);

struct BoundaryDefects {
    /// Vertices whose triangles are not exactly one closed fan, ascending.
    Array<u32> vertices;
    /// Edges with more than two triangles.
    std::size_t edges = 0;
};

/// Pre: triangles bound a set of cells: every directed edge occurs as often as its reverse.
/// Cost: linear, 24 bytes per triangle.
BoundaryDefects boundary_defects(std::span<const Triangle> triangles, std::size_t vertices, unsigned threads);

/// The triangles' vertices joined along them; the return value is the number of sets that have a triangle.
std::size_t join_vertices(std::span<const Triangle> triangles, DisjointSets& vertices);

}  // namespace scanmill::alpha
