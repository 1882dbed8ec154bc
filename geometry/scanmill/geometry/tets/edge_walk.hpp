// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The cells around an edge.

#include "scanmill/data/tets.hpp"

namespace scanmill {

/// Walks around an edge from cell to cell, through the facets at the edge.
class EdgeWalk {
public:
    /// Starts at `cell` and first crosses the facet opposite to its corner `across`; the edge joins the two corners
    /// that are neither `across` nor `kept`.
    EdgeWalk(const TetMesh& tets, u32 cell, int across, int kept)
        : tets_(tets),
          cell_(cell),
          across_(across),
          kept_(tets.cells[cell][kept]),
          others_(tets.cells[cell][across] ^ kept_ ^ sum(cell)) {}

    u32 cell() const { return cell_; }
    /// The corner opposite to the next facet.
    int across() const { return across_; }
    u32 next() const { return tets_.neighbours[cell_][across_]; }
    /// Pre: next() is a cell.
    void step() {
        cell_ = next();
        const Tetrahedron& corners = tets_.cells[cell_];
        across_ = corners[0] == kept_ ? 0 : corners[1] == kept_ ? 1 : corners[2] == kept_ ? 2 : 3;
        // The exclusive or of four corners, combined with that of three of them, gives the fourth corner.
        kept_ = sum(cell_) ^ others_ ^ kept_;
    }

private:
    u32 sum(u32 cell) const {
        const Tetrahedron& corners = tets_.cells[cell];
        return corners[0] ^ corners[1] ^ corners[2] ^ corners[3];
    }

    const TetMesh& tets_;
    u32 cell_;
    int across_;
    /// `kept_`: the vertex of the next facet that is not on the edge. `others_`: exclusive or of the edge's two
    /// vertices.
    u32 kept_, others_;
};

}  // namespace scanmill
