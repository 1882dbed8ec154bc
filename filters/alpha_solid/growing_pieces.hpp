// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How many points do the pieces of a growing alpha-solid hold, and which holds the most?
///
/// Pieces are cells joined across facets; they may share points where they touch. When two meet, the cells of the
/// smaller are gone through once, so a cell is looked at as often as its piece has doubled.

#include <span>

#include "alpha_solid/labels.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill::alpha {

class GrowingPieces {
public:
    /// Cells that are not `outside` are in the alpha-solid. Cost: about 40 bytes per cell.
    GrowingPieces(const TetMesh& tets, std::span<const u8> labels);

    /// The cells enter. Pre: they were outside.
    void add(std::span<const u32> cells);

    /// Points of a piece that holds the most, and the number of pieces that hold as many.
    std::size_t most() const { return most_; }
    std::size_t pieces_with_most() const { return pieces_holding_[most_]; }

private:
    void add(u32 cell);
    void join(u32 a, u32 b);
    std::size_t common_points(u32 smaller, u32 larger);
    bool holds(u32 piece, u32 vertex);

    const TetMesh& tets_;
    DisjointSets pieces_;
    Array<u8> is_in_;
    /// The cells of a piece are a ring.
    Array<u32> next_;
    /// At a piece's root.
    Array<u32> cells_, points_;
    /// Cells round vertex v: around_[first_[v]] up to around_[first_[v + 1]].
    Array<u32> first_, around_;
    /// Per number of points, the pieces that hold as many.
    Array<u32> pieces_holding_;
    std::size_t most_ = 0;
    Array<u32> seen_;
    u32 round_ = 0;
};

}  // namespace scanmill::alpha
