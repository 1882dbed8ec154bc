// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The model that is updated, with what all steps read of it.

#include <string>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::updating {

/// half_edges::opposites(mesh). Throws Error for a mesh that is open, not a manifold or inside out, with the position
/// of the first defect. Cost: linear.
Array<u32> closed_opposites(const TriangleMesh& mesh);

/// A closed mesh with its half-edges and a tree over its facets.
struct Model {
    /// Pre: `opposites` are closed_opposites(given), and the mesh outlives this object. Cost: O(F log F); about 130
    /// bytes per triangle.
    Model(const TriangleMesh& given, Array<u32> opposites, unsigned threads);
    Model(const TriangleMesh& given, const Context& context)
        : Model(given, closed_opposites(given), context.threads()) {}
    Model(const Model&) = delete;

    std::array<Vec3, 3> corners(u32 facet) const {
        const Triangle& t = mesh.triangles[facet];
        return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    }
    u32 start(u32 half_edge) const { return half_edges::start(mesh, half_edge); }
    /// Calls visit(half-edge) for all half-edges that start where the given one starts.
    template <class Visit>
    void for_each_around(u32 half_edge, const Visit& visit) const {
        u32 h = half_edge;
        do {
            visit(h);
            h = opposite[half_edges::before(h)];
        } while (h != half_edge);
    }

    const TriangleMesh& mesh;
    Array<u32> opposite;  ///< half_edges::opposites(mesh)
    TriangleTree tree;
};

/// "(1.5, 2, 3)", in world coordinates, for messages.
std::string position_text(const Vec3& position, const Frame& frame);

}  // namespace scanmill::updating
