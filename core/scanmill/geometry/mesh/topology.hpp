// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The combinatorial facts of a triangle mesh: is it closed, manifold, oriented, of which genus, in how many pieces.
///
/// Edges are identified by vertex index: a soup whose corners were not merged is all boundary. Vertices in no triangle
/// are counted, and count for nothing else. Cost: O(F) time where no vertex has many edges, about 60 bytes per
/// triangle.

#include <optional>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct MeshTopology {
    std::size_t vertices = 0;         ///< used by a triangle
    std::size_t unused_vertices = 0;  ///< in no triangle
    std::size_t edges = 0;
    std::size_t triangles = 0;
    std::size_t degenerate_triangles = 0;   ///< naming a vertex twice
    std::size_t boundary_edges = 0;         ///< in exactly one triangle
    std::size_t nonmanifold_edges = 0;      ///< in three or more triangles
    std::size_t nonmanifold_vertices = 0;   ///< whose triangles do not form exactly one fan, open or closed
    std::size_t misoriented_edges = 0;      ///< two triangles that pass it in the same direction
    std::size_t boundary_loops = 0;         ///< connected pieces of the boundary edges' graph
    std::size_t components = 0;             ///< connected through edges
    /// V − E + F over the used vertices.
    long euler = 0;
    /// Every edge in exactly two triangles, passed in opposite directions, and every vertex a single fan.
    bool closed = false;
    /// Sum over the components, holes counted as filled; absent unless the mesh is an oriented manifold, open or
/// closed.
    std::optional<long> genus;
};

MeshTopology topology(const TriangleMesh& mesh);

}  // namespace scanmill
