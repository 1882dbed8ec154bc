// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Sets of facets of a tetrahedralisation, and rotations around their edges.

#include <algorithm>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/tets/edge_walk.hpp"
#include "scanmill/geometry/tets/voronoi.hpp"

namespace scanmill::cocones {

/// A facet, seen from one of its cells: the facet opposite to a corner.
struct Side {
    u32 cell = TetMesh::outside_hull;
    int corner = 0;

    bool is_cell() const { return cell != TetMesh::outside_hull; }
};

/// The same facet, seen from its other cell; at the hull, is_cell() is false. Pre: side.is_cell().
inline Side other_side(const TetMesh& tets, const Side& side) {
    const u32 across = tets.neighbours[side.cell][static_cast<std::size_t>(side.corner)];
    return across == TetMesh::outside_hull ? Side{} : Side{across, corner_across(tets, side.cell, side.corner)};
}

inline int corner_of(const TetMesh& tets, u32 cell, u32 vertex) {
    const Tetrahedron& corners = tets.cells[cell];
    return corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : corners[2] == vertex ? 2 : 3;
}

/// The facet's corners, counter-clockwise seen from outside the cell.
inline Triangle corners_of(const TetMesh& tets, const Side& side) {
    const auto& [i, j, k] = outward_facet[static_cast<std::size_t>(side.corner)];
    const Tetrahedron& corners = tets.cells[side.cell];
    return {corners[i], corners[j], corners[k]};
}

/// By cell, bit i: whether the facet opposite to corner i is in the set. The two cells of a facet agree.
class FacetSet {
public:
    explicit FacetSet(std::size_t cells) : bits_(cells, u8(0)) {}
    explicit FacetSet(Array<u8> bits) : bits_(std::move(bits)) {}

    bool contains(u32 cell, int corner) const { return (bits_[cell] >> corner & 1) != 0; }
    bool contains(const Side& side) const { return contains(side.cell, side.corner); }
    unsigned of(u32 cell) const { return bits_[cell]; }
    void add(const TetMesh& tets, const Side& side) {
        bits_[side.cell] = static_cast<u8>(bits_[side.cell] | 1 << side.corner);
        if (const Side other = other_side(tets, side); other.is_cell())
            bits_[other.cell] = static_cast<u8>(bits_[other.cell] | 1 << other.corner);
    }
    void remove(const TetMesh& tets, const Side& side) {
        bits_[side.cell] = static_cast<u8>(bits_[side.cell] & ~(1 << side.corner));
        if (const Side other = other_side(tets, side); other.is_cell())
            bits_[other.cell] = static_cast<u8>(bits_[other.cell] & ~(1 << other.corner));
    }

private:
    Array<u8> bits_;
};

/// Rotates around an edge of a facet, from the facet into side.cell and on from cell to cell. The edge is opposite to
/// the facet's corner `third`. Calls visit(Side) for each facet at the edge, seen from the cell before it, until visit
/// returns true, or the hull is reached, or the turn comes back to the facet. Returns whether the hull was reached.
template <class Visit>
bool rotate(const TetMesh& tets, const Side& side, u32 third, const Visit& visit) {
    const u32 behind = tets.neighbours[side.cell][static_cast<std::size_t>(side.corner)];
    EdgeWalk walk(tets, side.cell, corner_of(tets, side.cell, third), side.corner);
    while (true) {
        if (walk.next() == side.cell && walk.cell() == behind) return false;
        if (visit(Side{walk.cell(), walk.across()})) return false;
        if (walk.next() == TetMesh::outside_hull) return true;
        walk.step();
    }
}

/// Calls visit(Side) for every facet at the edge, except the given one.
template <class Visit>
void for_each_facet_at(const TetMesh& tets, const Side& side, u32 third, const Visit& visit) {
    const auto go_on = [&](const Side& facet) {
        visit(facet);
        return false;
    };
    if (!rotate(tets, side, third, go_on)) return;
    if (const Side other = other_side(tets, side); other.is_cell()) rotate(tets, other, third, go_on);
}

/// A facet with an outer side. `inner`: whether side.cell is its inner cell.
struct OrientedFacet {
    Side side;
    bool inner;
};

/// The other facets of the set at an edge of an oriented facet, in the order in which they are seen from its outer
/// side, each with its own outer side towards the facet before. The edge is opposite to the facet's corner `third`.
/// Space outside the hull counts as one cell. `accepts(side)` decides which facets are in the set.
template <class Accepts>
void facets_seen(const TetMesh& tets, const OrientedFacet& facet, u32 third, const Accepts& accepts,
                 std::vector<OrientedFacet>& seen) {
    seen.clear();
    const Side other = other_side(tets, facet.side);
    const Side &outer = facet.inner ? other : facet.side, &inner = facet.inner ? facet.side : other;
    const auto collect = [&](bool from_inside) {
        return [&, from_inside](const Side& side) {
            if (accepts(side)) seen.push_back({side, from_inside});
            return false;
        };
    };
    if (outer.is_cell() && !rotate(tets, outer, third, collect(false))) return;
    // Beyond the hull, the turn goes on from the hull's other facet at the edge; these facets are found from behind.
    const auto begin = static_cast<std::ptrdiff_t>(seen.size());
    if (inner.is_cell()) rotate(tets, inner, third, collect(true));
    std::reverse(seen.begin() + begin, seen.end());
}

}  // namespace scanmill::cocones
