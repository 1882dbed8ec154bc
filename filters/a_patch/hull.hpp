// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The simplicial hull of a mesh: an apex on both sides of every triangle, and the tetrahedra between the apexes of
/// neighbours (Bernardini et al. 1997, section 5).

#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::a_patches {

enum Side : std::size_t { inside = 0, outside = 1 };
inline constexpr std::array<Side, 2> both_sides{inside, outside};
inline double sign_of(Side side) { return side == outside ? 1 : -1; }

/// A triangle with its base point and the heights of its apexes, which lie on the line through the base point along
/// the normal.
struct HullFace {
    Vec3 normal;
    Vec3 base;              ///< the centre of the inscribed circle
    Vec3 share;             ///< barycentric coordinates of the base point
    double radius = 0;      ///< of the inscribed circle
    std::array<double, 2> least{};   ///< by Side: above it the signs at the apex are right
    std::array<double, 2> height{};  ///< by Side
    std::array<u32, 3> edges{};      ///< edge i goes from corner i to the next
};

/// An edge a → b of the first face, and, unless it is on the boundary, b → a of the second.
struct HullEdge {
    static constexpr u32 none = ~u32(0);

    u32 a = 0, b = 0;
    u32 first = 0, second = none;
    Vec3 slope;  ///< g: f(a, b, X) = (b - a) · n_a / 3 + g · (X - a)
};

struct Hull {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
    std::vector<Vec3> normals;  ///< the gradient of every vertex
    std::vector<HullFace> faces;
    std::vector<HullEdge> edges;

    Vec3 apex(std::size_t face, Side side) const {
        return faces[face].base + sign_of(side) * faces[face].height[side] * faces[face].normal;
    }
    /// f(v, v, X).
    double at_vertex(u32 v, const Vec3& point) const { return (point - positions[v]).dot(normals[v]) / 3; }
    /// f(a, b, X) of an edge.
    double at_edge(const HullEdge& edge, const Vec3& point) const {
        return at_vertex(edge.a, positions[edge.b]) + edge.slope.dot(point - positions[edge.a]);
    }
    /// Edge `edge` of the side: whether the tetrahedra between the apexes of its two faces have the right orientation.
    bool is_sound(const HullEdge& edge, Side side) const;
};

/// `apex_factor`: the apex is so many times as high as it must be, and a bit more. Pre: an oriented manifold without
/// triangles of no area; a normal per vertex.
Hull make_hull(const TriangleMesh& mesh, std::vector<Vec3> normals, double apex_factor, Execution& execution);

}  // namespace scanmill::a_patches
