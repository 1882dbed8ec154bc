// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `patches`: a surface as the zero set of one cubic polynomial per tetrahedron, after Bernardini et al. 1997.
///
/// The tetrahedra are on both sides of a triangle mesh. In a tetrahedron with barycentric coordinates a0 … a3, the
/// function is F = sum of 6 / (i! j! k! l!) c_ijkl a0^i a1^j a2^k a3^l over i + j + k + l = 3, with the 20 weights c. F
/// is negative inside the object and positive outside. Neighbouring tetrahedra join with equal gradients, except across
/// sharp edges. A tetrahedron beside a sharp edge has two functions; F is the larger or the smaller of the two.
/// geometry/patches/a_patch.hpp evaluates F.

#include <array>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Weights c_ijkl of one tetrahedron, with (i, j, k, l) in descending lexicographic order: 3000, 2100, 2010, 2001,
/// 1200, …, 0003.
using PatchWeights = std::array<double, 20>;

enum class PatchKind : u8 {
    face,  ///< over a triangle or a third of it; corners: base point w of the triangle, corners i and j, apex
    edge,  ///< in the gap beside an edge; corners: point x between its triangles' apexes, corners i and j, apex
    /// In the gap beside a sharp edge; corners: apex of the other triangle, corners i and j, apex of its own triangle.
    /// Such a tetrahedron has two rows that are partners, one for the function of each triangle.
    sharp,
    /// Has the corners of a `face` row at a curved sharp edge, and the function of the triangle beyond the edge. The
    /// `face` row is its partner.
    continuation
};

constexpr std::array<std::string_view, 4> names_of(const PatchKind*) {
    return {"face", "edge", "sharp", "continuation"};
}

/// The function F in a tetrahedron with two rows.
enum class Combine : u8 {
    none,  ///< one row
    max,  ///< the larger function, at a convex edge
    min  ///< the smaller function, at a concave edge
};
constexpr std::array<std::string_view, 3> names_of(const Combine*) { return {"none", "max", "min"}; }

struct PatchComplex {
    /// Value in `edges` for a tetrahedron over a triangle.
    static constexpr u32 no_edge = ~u32(0);
    /// Value in `partners` for a tetrahedron with one function.
    static constexpr u32 no_partner = ~u32(0);

    Frame frame;
    /// #vertices, relative to frame.origin: the vertices of the mesh in its order, then base points, apexes and edge
    /// points.
    Buffer<Vec3> positions;
    /// #tetrahedra; corners in the order that PatchKind states. If a triangle is not divided, its `face` row has the
    /// triangle's three corners and the apex. Tetrahedra inside the object are mirrored: their orientation is negative.
    Buffer<std::array<u32, 4>> tets;
    Buffer<PatchWeights> weights;  ///< #tetrahedra
    Buffer<PatchKind> kinds;  ///< #tetrahedra
    Buffer<u8> sides;  ///< #tetrahedra: 1 outside the mesh, 0 inside it
    Buffer<u32> triangles;  ///< #tetrahedra: the row of the mesh's triangle whose apex is the last corner
    /// #tetrahedra: the number of the mesh's edge, or no_edge. Edges are numbered in the order of their first
    /// half-edges.
    Buffer<u32> edges;
    Buffer<Combine> combine;  ///< #tetrahedra; equal for partners
    /// #tetrahedra: the other row with the same four points, or no_partner. Partners refer to each other.
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
