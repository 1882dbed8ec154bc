// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `patches`: a surface as the zero set of one cubic polynomial per tetrahedron, after Bernardini et al. 1997.
///
/// The tetrahedra are on both sides of a triangle mesh. In barycentric coordinates a of its tetrahedron the function
/// is F = sum of 6 / (i! j! k! l!) c_ijkl a0^i a1^j a2^k a3^l over i + j + k + l = 3, with the 20 weights c; it is
/// negative inside the object and positive outside. Neighbours join with equal gradients, except across sharp edges:
/// beside those, two functions hold in a tetrahedron, and F is the larger or the smaller of them. geometry/a_patch.hpp
/// evaluates it.

#include <array>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Weights c_ijkl of one tetrahedron; (i, j, k, l) falls lexicographically: 3000, 2100, 2010, 2001, 1200, …, 0003.
using PatchWeights = std::array<double, 20>;

enum class PatchKind : u8 {
    face,  ///< is over a triangle, or a third of it: base point w of the triangle, corners i and j, apex
    edge,  ///< fills the gap beside an edge: point x between the apexes of its two triangles, corners i and j, apex
    /// Fills the gap beside a sharp edge: apex of the other triangle, corners i and j, apex of its own triangle. Two
    /// rows, partners of each other: the functions of both triangles.
    sharp,
    /// The corners of a `face` row at a curved sharp edge, with the function of the triangle beyond the edge. Partner
    /// of that row.
    continuation
};

constexpr std::array<std::string_view, 4> names_of(const PatchKind*) {
    return {"face", "edge", "sharp", "continuation"};
}

/// What F is in a tetrahedron with two rows.
enum class Combine : u8 {
    none,  ///< one row
    max,  ///< the larger function, at a convex edge
    min  ///< the smaller function, at a concave edge
};
constexpr std::array<std::string_view, 3> names_of(const Combine*) { return {"none", "max", "min"}; }

struct PatchComplex {
    /// In `edges`: the tetrahedron is over a triangle.
    static constexpr u32 no_edge = ~u32(0);
    /// In `partners`: the tetrahedron has one function.
    static constexpr u32 no_partner = ~u32(0);

    Frame frame;
    /// #vertices, relative to frame.origin: those of the mesh in its order, then base points, apexes and edge points.
    Buffer<Vec3> positions;
    /// #tetrahedra; corners in the order that PatchKind states, or the triangle's three and the apex if it is not
    /// divided. Those inside the object are mirrored: their orientation is negative.
    Buffer<std::array<u32, 4>> tets;
    Buffer<PatchWeights> weights;  ///< #tetrahedra
    Buffer<PatchKind> kinds;  ///< #tetrahedra
    Buffer<u8> sides;  ///< #tetrahedra: 1 outside the mesh, 0 inside it
    Buffer<u32> triangles;  ///< #tetrahedra: the row of the mesh's triangle whose apex is their last corner
    Buffer<u32> edges;  ///< #tetrahedra: the number of the mesh's edge, in the order of its first half-edge; or no_edge
    Buffer<Combine> combine;  ///< #tetrahedra; equal for partners
    /// #tetrahedra: the other row with the same four points, whose partner is this one; or no_partner.
    Buffer<u32> partners;
};
constexpr auto fields(const PatchComplex*) {
    return std::tuple{field("frame", &PatchComplex::frame),
                      field("positions", &PatchComplex::positions).means(Meaning::position),
                      field("tets", &PatchComplex::tets),
                      // A gradient has no unit, so a value of the function is a length.
                      field("weights", &PatchComplex::weights).means(Meaning::length),
                      field("kinds", &PatchComplex::kinds), field("sides", &PatchComplex::sides),
                      field("triangles", &PatchComplex::triangles), field("edges", &PatchComplex::edges),
                      field("combine", &PatchComplex::combine), field("partners", &PatchComplex::partners)};
}

}  // namespace scanmill
