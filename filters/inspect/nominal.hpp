// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The nominal surface, and on which side of it a point is.
///
/// The sign of a distance is that of the angle between the way from the nearest point of the surface and a normal
/// there: the normal of the face, the sum of the two faces' normals on an edge, the angle-weighted sum of the normals
/// at a vertex. These normals give the right sign at every point of a closed or open oriented manifold, which the
/// normal of just any nearest face does not.
///
/// Source: Bærentzen & Aanæs 2005, Signed distance computation using the angle weighted pseudonormal.

#include <span>

#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::inspecting {

enum class Side : u8 {
    decided,  ///< the distance has a sign, or is 0
    undecided,  ///< the normals at the nearest point do not agree on a sign
    beyond  ///< the nearest point is on the border, and the point is beside the surface, not above or below it
};

struct SignedDistance {
    double value;  ///< NaN if the side is undecided
    Side side;
};

/// The triangles of a mesh with vertices at one position as one vertex, without triangles that then have a vertex
/// twice. So the surface also continues across seams where a file repeats vertices.
class Nominal {
public:
    /// Pre: consistent, finite; some triangle has three positions. `positions` are used instead of the mesh's own.
    /// Cost: O(F log F), about 350 bytes per triangle.
    Nominal(const TriangleMesh& mesh, const Buffer<Vec3>& positions, unsigned threads);

    const TriangleMesh& surface() const { return surface_; }
    const TriangleTree& tree() const { return tree_; }
    /// The row in the given mesh of each triangle of surface().
    const Array<u32>& rows() const { return rows_; }
    /// The opposite of each half-edge of surface(); half_edges::boundary on the border and on edges that do not have
    /// two triangles of one orientation.
    const Array<u32>& opposites() const { return opposites_; }
    /// Unit normals of the triangles of surface(); see facet_normals().
    const Array<Vec3>& normals() const { return normals_; }

    /// Distances up to this are rounding, and 0.
    double rounding() const { return rounding_; }

    /// The distance of a point whose nearest triangle has this slot in tree().
    ///
    /// A point beyond the border has the sign of its side of the nearest triangle or vertex; NaN if it is in their
    /// plane. On an edge of three or more triangles or of triangles with different orientations, and at a vertex of
    /// such edges or of several fans, the point has a sign if it is on the same side of every triangle there that it is
    /// not level with. Cosines up to 1e-9 are level.
    SignedDistance signed_distance(const Vec3& point, u32 slot) const;

private:
    enum class Kind : u8 { inner, border, irregular };

    void find_edges();
    void find_vertex_kinds();
    void find_vertex_normals();
    SignedDistance at_edge(const Vec3& way, u32 half_edge) const;
    SignedDistance at_vertex(const Vec3& way, u32 vertex) const;
    bool leads_across(const Vec3& way, u32 border) const;

    Array<u32> rows_;
    TriangleMesh surface_;
    TriangleTree tree_;
    double rounding_, near_;
    Array<u32> opposites_;
    Array<u8> is_irregular_;  ///< by half-edge
    Array<Vec3> normals_;
    Array<Vec3> vertex_normals_;
    Array<Kind> kinds_;  ///< by vertex
    Lists<u32> corners_;  ///< by vertex; those at a vertex that is not inner, ascending
};

}  // namespace scanmill::inspecting
