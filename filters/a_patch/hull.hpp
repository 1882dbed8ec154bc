// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The simplicial hull of a mesh: an apex on both sides of every triangle, and the tetrahedra between the apexes of
/// neighbours (Bernardini et al. 1997, section 5). In the comments, f(x, y, z) is the polar form of a tetrahedron's
/// cubic: see patch_blossom().

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::a_patches {

enum Side : std::size_t { inside = 0, outside = 1 };
inline constexpr std::array<Side, 2> both_sides{inside, outside};
inline double sign_of(Side side) { return side == outside ? 1 : -1; }

// The next and the previous corner or edge of a triangle.
constexpr std::size_t next(std::size_t i) { return (i + 1) % 3; }
constexpr std::size_t previous(std::size_t i) { return (i + 2) % 3; }

/// A triangle with its base point and the heights of its apexes. The apexes lie on the line through the base point
/// along the normal.
struct HullFace {
    Vec3 normal;
    Vec3 base;              ///< the centre of the inscribed circle
    Vec3 share;             ///< barycentric coordinates of the base point
    double radius = 0;      ///< radius of the inscribed circle
    std::array<double, 2> least{};   ///< by Side: a higher apex has values of the right sign
    std::array<double, 2> height{};  ///< by Side
    /// By Side: largest height that the next sheet of the mesh above the base point allows.
    std::array<double, 2> limit{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    bool is_thin = false;  ///< whether an apex must be higher than the next sheet allows
    std::array<u32, 3> edges{};      ///< edge i goes from corner i to the next
    /// Whether the tetrahedron on either side is divided at the base point into three (Clough-Tocher).
    bool is_divided = true;
    double middle = 0;  ///< f(corner 0, corner 1, corner 2) of an undivided triangle
};

/// An edge of the mesh. It goes from a to b in its first face, and from b to a in its second one. On the boundary there
/// is no second face.
struct HullEdge {
    static constexpr u32 none = ~u32(0);

    u32 a = 0, b = 0;
    u32 first = 0, second = none;
    /// For the first and the second face: the vector g in f(a, b, X) = (b - a) · n_a / 3 + g · (X - a), where n_a is
    /// the face's normal at a. The two vectors are equal unless the edge is sharp.
    std::array<Vec3, 2> slopes{Vec3::Zero(), Vec3::Zero()};
    bool is_sharp = false;
    /// Whether the crease of a sharp edge is the edge itself: the normals on both sides are perpendicular to it.
    bool is_straight = false;
    /// At a convex sharp edge F is the larger of the two triangles' functions, at a concave one the smaller.
    bool is_convex = true;
    /// By Side: whether tetrahedra connect the apexes of the two faces.
    std::array<bool, 2> is_filled{true, true};

    bool is_smooth() const { return second != none && !is_sharp; }
    /// Whether the function of each face continues into the third of the other face at this edge.
    bool is_continued() const { return is_sharp && !is_straight && is_filled_twice(); }
    bool is_filled_twice() const { return is_filled[0] && is_filled[1]; }
};

/// Decides which triangles are divided.
enum class Split {
    always,
    where_needed  ///< where one tetrahedron per side cannot join its neighbours with equal gradients
};

/// Defects of a hull; the indices ascend.
struct HullFaults {
    std::vector<u32> thin;  ///< triangles too near to the next sheet
    std::vector<u32> inverted;  ///< edges beside which a tetrahedron is inside out; not open or straight ones
};

/// The gradients at the corners of every triangle: unit length, or zero where the surface has a singular point.
using CornerNormals = std::vector<std::array<Vec3, 3>>;

/// The mesh over which a surface is built, and its normals.
struct PatchMesh {
    TriangleMesh mesh;  ///< with its sharp edges; no columns
    /// Triangles that are connected at a vertex without crossing a sharp edge have equal normals there.
    CornerNormals normals;
    /// Sharp edges without tetrahedra between the apexes of their triangles, because none fit; ascending. The surfaces
    /// over the two triangles end there, and a narrow straight strip joins them.
    std::vector<Edge> open{};
    /// By triangle: whether the surface is the triangle, because no smooth surface fits there. Its three edges are
    /// open, and its normals are that of the triangle. False for triangles beyond the end of the vector.
    std::vector<bool> flat{};

    /// By smooth edge: what is added to the mean of the normals at its ends to get the gradient in its middle. Zero for
    /// edges that are not here.
    std::map<Edge, Vec3> bends{};

    /// The edges whose bisection made the last vertices of the mesh, in their order.
    std::vector<Edge> bisected{};

    bool is_open(const Edge& edge) const { return std::ranges::binary_search(open, edge); }
    bool is_flat(std::size_t triangle) const { return triangle < flat.size() && flat[triangle]; }
};

/// The difference between an edge, from one end to the other, and the tangent at an end of the curve that follows it
/// (Vlachos et al. 2001, "Curved PN triangles"): the edge is projected to the tangent plane, and at a crease to the
/// line in which the two tangent planes meet. `one` and `other` are the normals on both sides at this end.
Vec3 off_tangent(const Vec3& edge, const Vec3& one, const Vec3& other, bool is_sharp);

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
    /// f(v, v, point) for a face's corner v.
    double at_corner(std::size_t face, std::size_t corner, const Vec3& point) const {
        return (point - positions[triangles[face][corner]]).dot(normals[face][corner]) / 3;
    }
    /// f(a, b, point) for an edge of a face; `number` is the edge's number in the face.
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
    /// The number of an edge in one of its faces: 0, 1 or 2.
    std::size_t number_in(u32 edge, std::size_t face) const {
        const std::array<u32, 3>& all = faces[face].edges;
        return static_cast<std::size_t>(std::ranges::find(all, edge) - all.begin());
    }
    /// Whether no tetrahedra are beside an edge whose two sides have equal normals.
    bool is_open_within_smooth(u32 edge) const;
    /// Whether the tetrahedra on a side, between the apexes of the edge's two faces, have the right orientation.
    bool is_sound(const HullEdge& edge, Side side) const;
};

/// Smallest allowed cosine of the angle between a triangle's normal and the normals at its corners.
inline constexpr double least_cosine = 0.1;

/// Builds the hull of a mesh. An apex is `apex_factor` times as high as it must be, plus 0.15 inradii. It stays below
/// 0.45 of the distance to the next sheet of the mesh, unless it must be higher. Triangles with a sharp edge are
/// divided. The result refers to `mesh`.
///
/// Pre: an oriented manifold whose triangles have an area. A normal at a corner is zero, or has a cosine of at least
/// least_cosine with the triangle's normal.
Hull make_hull(const PatchMesh& mesh, double apex_factor, Split split, Execution& execution);

}  // namespace scanmill::a_patches
