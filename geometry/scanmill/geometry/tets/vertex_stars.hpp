// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The cells around a vertex, and whether a solid of cells has a 2-manifold boundary there.

#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill {

class VertexStars {
public:
    static constexpr u32 none = TetMesh::outside_hull;

    /// Cost: linear, 8 bytes per cell and 4 per vertex.
    explicit VertexStars(const TetMesh& tets);

    /// A cell at the vertex; `none` if the vertex is in no cell.
    u32 any_cell(u32 vertex) const { return anchors_[vertex]; }
    /// The cells at the vertex, in unspecified order. Valid until the next call. Pre: the vertex is in a cell.
    std::span<const u32> cells_at(u32 vertex);

    /// Divides the cells at the vertex into face-connected parts of two kinds: of cells labelled 1, and of other cells
    /// together with the space outside the hull. Returns the number of parts beyond the first, summed over both kinds.
    /// It is 0 exactly if the boundary of the cells labelled 1 has one closed fan of triangles at the vertex, or none.
    /// Afterwards cells() returns the cells at the vertex.
    std::size_t surplus_parts(u32 vertex, std::span<const u8> labels);
    std::span<const u32> cells() const { return star_; }
    /// The lowest cell in the part of cells()[i], or `none` if this part contains the outside of the hull.
    u32 part(u32 i);

private:
    u32 root(u32 i) {
        while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
        return i;
    }

    const TetMesh& tets_;
    Array<u32> anchors_;
    /// slots_[c] - base_ is the index of cell c in star_; cells with a smaller slot are not in star_.
    Array<u64> slots_;
    u64 base_ = 1;
    std::vector<u32> star_;
    std::vector<u32> parents_;  ///< disjoint sets of indices in star_; the last is the outside of the hull
};

}  // namespace scanmill
