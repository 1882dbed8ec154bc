// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The topology of a triangle mesh: closed, manifold, oriented, genus, number of connected components.
///
/// Edges are identified by vertex index: in a soup whose corners were not merged, every edge is a boundary edge.
/// Cost: O(F) time where no vertex has many edges, about 60 bytes per triangle.

#include <optional>
#include <span>
#include <string>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct MeshTopology {
    std::size_t vertices = 0;         ///< vertices that are in a triangle
    std::size_t unused_vertices = 0;  ///< vertices that are in no triangle
    std::size_t edges = 0;
    std::size_t triangles = 0;
    std::size_t degenerate_triangles = 0;   ///< triangles with a repeated vertex
    std::size_t boundary_edges = 0;         ///< edges in exactly one triangle
    std::size_t nonmanifold_edges = 0;      ///< edges in three or more triangles
    std::size_t nonmanifold_vertices = 0;   ///< vertices whose triangles are not exactly one fan, open or closed
    std::size_t misoriented_edges = 0;      ///< edges with two half-edges of the same direction
    std::size_t boundary_loops = 0;         ///< connected components of the graph of boundary edges
    std::size_t components = 0;             ///< components of triangles that are connected through edges
    /// V − E + F over the used vertices.
    long euler = 0;
    /// Whether the mesh has triangles, every edge has exactly two half-edges of opposite directions, and every vertex
    /// has a single fan.
    bool closed = false;
    /// The sum over the components, with holes counted as filled. Set only for oriented manifolds, open or closed.
    std::optional<long> genus;
};

MeshTopology topology(const TriangleMesh& mesh);

/// The volume that a closed surface encloses, negative if it is inside out; 0 without triangles. Cost: linear.
double signed_volume(std::span<const Vec3> positions, std::span<const Triangle> triangles);

/// Whether the mesh is closed and encloses a negative volume. A volume below 1e-9 of its parts counts as 0. Cost:
/// linear; that of topology() only if the volume is negative.
bool is_inside_out(const TriangleMesh& mesh);

/// The defects that keep a mesh from being closed, with their numbers, and no others: "3 boundary edges in 1 loop and 1
/// triangle with a repeated vertex". Empty for a closed mesh.
std::string defects_text(const MeshTopology& found);

}  // namespace scanmill
