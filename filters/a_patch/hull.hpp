// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The simplicial hull of a mesh: an apex on both sides of every triangle, and the tetrahedra between the apexes of
/// neighbours (Bernardini et al. 1997, section 5).

#include <limits>
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
    /// By Side: the most that the next sheet of the mesh above the base point allows.
    std::array<double, 2> limit{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    std::array<u32, 3> edges{};      ///< edge i goes from corner i to the next
    /// Whether a tetrahedron per side is divided at the base point into three (Clough-Tocher).
    bool is_divided = true;
    double middle = 0;  ///< undivided: f(corner 0, corner 1, corner 2)
};

/// An edge a → b of the first face, and, unless it is on the boundary, b → a of the second.
struct HullEdge {
    static constexpr u32 none = ~u32(0);

    u32 a = 0, b = 0;
    u32 first = 0, second = none;
    Vec3 slope = Vec3::Zero();  ///< g: f(a, b, X) = (b - a) · n_a / 3 + g · (X - a)
};

/// Which triangles are divided.
enum class Split {
    always,
    where_needed  ///< where one tetrahedron per side cannot join its neighbours with equal gradients
};

/// What keeps a hull from carrying a surface; numbers ascend.
struct HullFaults {
    std::vector<u32> opposed;   ///< triangles with a normal at a corner that is more than 84 degrees from their own
    std::vector<u32> thin;      ///< triangles too near to the next sheet
    std::vector<u32> inverted;  ///< edges beside which a tetrahedron is inside out

    bool empty() const { return opposed.empty() && thin.empty() && inverted.empty(); }
};

struct Hull {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
    std::vector<Vec3> normals;  ///< the gradient of every vertex
    std::vector<HullFace> faces;
    std::vector<HullEdge> edges;
    HullFaults faults;  ///< with `opposed` there are no heights

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

/// The least cosine between the normals of a triangle and of its corners.
inline constexpr double least_cosine = 0.1;

/// `apex_factor`: the apex is so many times as high as it must be, and a bit more; but at most 0.45 of the distance to
/// the next sheet of the mesh. Pre: an oriented manifold without triangles of no area; a normal per vertex.
Hull make_hull(const TriangleMesh& mesh, std::vector<Vec3> normals, double apex_factor, Split split,
               Execution& execution);

}  // namespace scanmill::a_patches
