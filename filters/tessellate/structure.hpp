// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh under a complex of patches, with the tetrahedra over its triangles and beside its edges.

#include <array>
#include <vector>

#include "scanmill/data/patches.hpp"

namespace scanmill::tessellation {

inline constexpr u32 none = ~u32(0);

/// The tetrahedra of a triangle: one per side, or three per side around the base point.
struct TriangleTets {
    std::array<std::array<u32, 3>, 2> rows{{{none, none, none}, {none, none, none}}};  ///< by side
    u32 count = 0;                              ///< tetrahedra per side
    std::array<u32, 3> corners{};               ///< vertices of the mesh
    std::array<u32, 3> edges{none, none, none};  ///< into PatchStructure::edges; edge i goes from corner i to the next
};

/// The tetrahedra beside an edge a → b of its first triangle.
struct EdgeTets {
    u32 a = none, b = none;
    std::array<u32, 2> triangles{none, none};
    std::array<u32, 2> numbers{none, none};  ///< the edge's numbers in its triangles
    /// Rows of the tetrahedra, by side and triangle; `none` on a side without tetrahedra.
    std::array<std::array<u32, 2>, 2> rows{{{none, none}, {none, none}}};
    bool is_sharp = false;  ///< without tetrahedra: the gradients of the triangles' functions differ at its ends
    Combine combine = Combine::none;

    bool is_border() const { return triangles[1] == none; }
};

struct PatchStructure {
    std::vector<TriangleTets> triangles;
    std::vector<EdgeTets> edges;  ///< sorted by their vertices
};

/// Finds the structure of a complex. Throws Error if the complex is empty or tetrahedra are missing.
PatchStructure structure_of(const PatchComplex& patches);

}  // namespace scanmill::tessellation
