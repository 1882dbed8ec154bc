// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The model that is updated, with what all steps read of it.

#include <string>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::updating {

/// A search tree over facets of a mesh: all of them, or those in a region.
class FacetTree {
public:
    /// Pre: at least one facet.
    FacetTree(const TriangleMesh& mesh, unsigned threads)
        : tree_(mesh.positions.span(), mesh.triangles.span(), threads) {}
    /// `facets`: rows of the facets in the tree, ascending.
    FacetTree(const TriangleMesh& mesh, Array<u32> facets, unsigned threads);

    /// As TriangleTree::nearest(); `triangle` is the row in the mesh.
    NearestTriangle nearest(const Vec3& point, u32 hint) const {
        NearestTriangle found = tree_.nearest(point, hint);
        if (!facets_.empty()) found.triangle = facets_[found.triangle];
        return found;
    }
    Vec3 nearest_point(const Vec3& point, u32 slot) const { return tree_.nearest_point(point, slot); }
    /// As TriangleTree::meeting(), with rows in the mesh.
    void meeting(const BoundingBox& box, Array<u32>& rows) const;
    /// Pre: the tree contains all facets.
    const TriangleTree& of_all() const { return tree_; }

private:
    Array<u32> facets_;  ///< by triangle of the tree, its row in the mesh; empty if the tree contains all facets
    TriangleTree tree_;
};

/// half_edges::opposites(mesh). Throws Error for a mesh that is open or not a manifold, with the first defect and its
/// position, and for a mesh that is inside out. Cost: linear.
Array<u32> closed_opposites(const TriangleMesh& mesh);

/// A closed mesh with its half-edges and a tree over its facets.
struct Model {
    /// Pre: `opposites` are closed_opposites(given), and the mesh outlives this object.
    Model(const TriangleMesh& given, Array<u32> opposites, FacetTree facets)
        : mesh(given),
          opposite(std::move(opposites)),
          tree(std::move(facets)) {}
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
    FacetTree tree;
};

/// "(1.5, 2, 3)", in world coordinates, for messages.
std::string position_text(const Vec3& position, const Frame& frame);

}  // namespace scanmill::updating
