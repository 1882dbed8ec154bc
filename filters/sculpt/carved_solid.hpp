// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A solid of cells that loses one cell at a time while its boundary stays a closed 2-manifold (Boissonnat 1984).
///
/// A cell with one facet on the boundary may be removed if the opposite corner is not on the boundary: one triangle
/// becomes three. A cell with two such facets may be removed if the edge opposite to their common edge is not on the
/// boundary: the common edge is flipped. No other cell may be removed. Without a cell with three such facets, a point
/// would be outside. A cell with four is a solid of its own. In all other cases, the boundary would touch itself.
///
/// In queries, the cells `without` count as removed already.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/geometry/tets/edge_walk.hpp"

namespace scanmill::sculpting {

inline constexpr u32 none = TetMesh::outside_hull;
using Without = std::span<const u32>;

class CarvedSolid {
public:
    /// `boundary`: the triangles that bound the cells labelled 1.
    CarvedSolid(const TetMesh& tets, Array<u8> labels, std::span<const Triangle> boundary);

    const TetMesh& tets() const { return tets_; }
    const Array<u8>& labels() const { return labels_; }
    bool has(u32 cell, Without without = {}) const {
        if (cell == none || labels_[cell] != 1) return false;
        for (u32 removed : without)
            if (cell == removed) return false;
        return true;
    }
    bool is_on_boundary(u32 vertex) const { return on_boundary_[vertex] == 1; }
    /// Bit i: the facet opposite to corner i is on the boundary. Pre: has(cell).
    unsigned open_facets(u32 cell, Without without = {}) const {
        unsigned mask = 0;
        for (int corner = 0; corner < 4; ++corner)
            if (!has(tets_.neighbours[cell][corner], without)) mask |= 1u << corner;
        return mask;
    }

    /// Whether the cell may be removed and brings a point to the boundary. Pre: `open` are its open facets.
    bool exposes(u32 cell, unsigned open) const;
    /// Whether the cell may be removed and flips an edge. Pre: `open` are its open facets.
    bool flips(u32 cell, unsigned open, Without without = {}) const;

    /// Pre: the cell exposes or flips.
    void remove(u32 cell);
    /// Removes a cell or puts it back during a query: is_on_boundary() does not change.
    void set_temporarily(u32 cell, bool is_inside) { labels_[cell] = is_inside; }

    Array<u8> take_labels() { return std::move(labels_); }

private:
    const TetMesh& tets_;
    Array<u8> labels_, on_boundary_;
};

/// An edge of a cell, by the numbers of corners within the cell.
struct CellEdge {
    int a, b;  ///< its ends
    int c, d;  ///< the other corners
};
inline constexpr std::array<CellEdge, 6> cell_edges{
    {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};

/// Return the only corner in the mask, and both corners in it.
int only_corner(unsigned mask);
std::array<int, 2> both_corners(unsigned mask);

}  // namespace scanmill::sculpting
