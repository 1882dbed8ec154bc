// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/carved_solid.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

namespace scanmill::sculpting {

int only_corner(unsigned mask) {
    assert(std::popcount(mask) == 1);
    return std::countr_zero(mask);
}

std::array<int, 2> both_corners(unsigned mask) {
    assert(std::popcount(mask) == 2);
    return {std::countr_zero(mask), std::countr_zero(mask & (mask - 1))};
}

CarvedSolid::CarvedSolid(const TetMesh& tets, Array<u8> labels, std::span<const Triangle> boundary)
    : tets_(tets),
      labels_(std::move(labels)),
      on_boundary_(tets.positions.size()) {
    std::ranges::fill(on_boundary_, u8(0));
    for (const Triangle& triangle : boundary)
        for (u32 vertex : triangle) on_boundary_[vertex] = 1;
}

bool CarvedSolid::exposes(u32 cell, unsigned open) const {
    return std::popcount(open) == 1 && !is_on_boundary(tets_.cells[cell][only_corner(open)]);
}

bool CarvedSolid::flips(u32 cell, unsigned open, Without without) const {
    if (std::popcount(open) != 2) return false;
    // The new edge joins the corners opposite to the open facets; it is inside if all cells at it are solid.
    const auto [c, d] = both_corners(~open & 15u);
    EdgeWalk walk(tets_, cell, c, d);
    do {
        if (!has(walk.next(), without)) return false;
        walk.step();
    } while (walk.cell() != cell);
    return true;
}

void CarvedSolid::remove(u32 cell) {
    const unsigned open = open_facets(cell);
    assert(exposes(cell, open) || flips(cell, open));
    if (std::popcount(open) == 1) on_boundary_[tets_.cells[cell][only_corner(open)]] = 1;
    labels_[cell] = 0;
}

}  // namespace scanmill::sculpting
