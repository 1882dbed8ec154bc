// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The simplicial hull of a mesh: an apex on both sides of every triangle, and the tetrahedra between the apexes of
/// neighbours (Bernardini et al. 1997, section 5).

#include <algorithm>
#include <limits>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::a_patches {

enum Side : std::size_t { inside = 0, outside = 1 };
inline constexpr std::array<Side, 2> both_sides{inside, outside};
inline double sign_of(Side side) { return side == outside ? 1 : -1; }

// Corners and edges of a triangle, around it.
constexpr std::size_t next(std::size_t i) { return (i + 1) % 3; }
constexpr std::size_t previous(std::size_t i) { return (i + 2) % 3; }

/// A triangle with its base point and the heights of its apexes, which lie on the line through the base point along
/// the normal.
struct HullFace {
    Vec3 normal;
    Vec3 base;              ///< the centre of the inscribed circle
    Vec3 share;             ///< barycentric coordinates of the base point
    double radius = 0;      ///< of the inscribed circle
    std::array<double, 2> least{};   ///< by Side: above it the signs at the apex are right
    std::array<double, 2> height{};  ///< by Side
    /// By Side: largest height that the next sheet of the mesh above the base point allows.
    std::array<double, 2> limit{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    bool is_thin = false;  ///< whether an apex must be higher than `limit` by the next sheet
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
    /// g of the first and of the second triangle, with n_a of that triangle: f(a, b, X) = (b - a) · n_a / 3 + g · (X -
    /// a). Equal unless the edge is sharp.
    std::array<Vec3, 2> slopes{Vec3::Zero(), Vec3::Zero()};
    bool is_sharp = false;
    /// Sharp: the surface along the edge is the segment itself.
    bool is_straight = false;
    /// Sharp: outside is where the larger of the two triangles' functions is positive; else the smaller.
    bool is_convex = true;
    /// By Side: whether tetrahedra connect the apexes of its two triangles.
    std::array<bool, 2> is_filled{true, true};

    bool is_smooth() const { return second != none && !is_sharp; }
    /// Whether the functions continue into the thirds beyond the edge.
    bool is_continued() const { return is_sharp && !is_straight && is_filled[0] && is_filled[1]; }
    /// Whether the surfaces of the two triangles may end apart from each other. Straight edges need no tetrahedra.
    bool is_open() const { return second != none && !is_straight && !(is_filled[0] && is_filled[1]); }
};

/// Which triangles are divided.
enum class Split {
    always,
    where_needed  ///< where one tetrahedron per side cannot join its neighbours with equal gradients
};

/// Defects of a hull; numbers ascend.
struct HullFaults {
    std::vector<u32> thin;  ///< triangles too near to the next sheet
    std::vector<u32> inverted;  ///< edges beside which a tetrahedron is inside out
};

/// The gradients at the corners of every triangle: unit length, or zero where the surface has a singular point.
using CornerNormals = std::vector<std::array<Vec3, 3>>;

/// A mesh whose surface is sought.
struct PatchMesh {
    TriangleMesh mesh;  ///< with its sharp edges; no columns
    /// Equal at a vertex in triangles that are connected there without crossing a sharp edge.
    CornerNormals normals;
    /// By vertex, of those beyond its end false: whether the gradient is 0 there, so that the surface has a tip.
    std::vector<bool> pointed{};

    bool is_pointed(u32 vertex) const { return vertex < pointed.size() && pointed[vertex]; }
};

struct Hull {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
    std::span<const std::array<Vec3, 3>> normals;  ///< see PatchMesh
    std::vector<HullFace> faces;
    std::vector<HullEdge> edges;
    HullFaults faults;

    Vec3 apex(std::size_t face, Side side) const {
        return faces[face].base + sign_of(side) * faces[face].height[side] * faces[face].normal;
    }
    /// f(v, v, X) of a face's corner v.
    double at_corner(std::size_t face, std::size_t corner, const Vec3& point) const {
        return (point - positions[triangles[face][corner]]).dot(normals[face][corner]) / 3;
    }
    /// f(a, b, X) of a face's edge.
    double at_edge(std::size_t face, std::size_t number, const Vec3& point) const {
        const HullEdge& edge = edges[faces[face].edges[number]];
        const bool is_second = edge.first != face;
        return at_corner(face, is_second ? (number + 1) % 3 : number, positions[edge.b]) +
               edge.slopes[is_second].dot(point - positions[edge.a]);
    }
    const Vec3& slope(std::size_t face, std::size_t number) const {
        const HullEdge& edge = edges[faces[face].edges[number]];
        return edge.slopes[edge.first != face];
    }
    /// The number of an edge in one of its faces.
    std::size_t number_in(u32 edge, std::size_t face) const {
        const std::array<u32, 3>& all = faces[face].edges;
        return static_cast<std::size_t>(std::ranges::find(all, edge) - all.begin());
    }
    /// Edge `edge` of the side: whether the tetrahedra between the apexes of its two faces have the right orientation.
    bool is_sound(const HullEdge& edge, Side side) const;
};

/// The least cosine between the normals of a triangle and of its corners.
inline constexpr double least_cosine = 0.1;

/// `apex_factor`: the apex is so many times as high as it must be, and a bit more; but at most 0.45 of the distance to
/// the next sheet of the mesh, unless it must be higher. Triangles with a sharp edge are divided. Pre: an oriented
/// manifold without triangles of no area, whose normals are within least_cosine of their triangles', or zero. The
/// result refers to `mesh`.
Hull make_hull(const PatchMesh& mesh, double apex_factor, Split split, Execution& execution);

}  // namespace scanmill::a_patches
