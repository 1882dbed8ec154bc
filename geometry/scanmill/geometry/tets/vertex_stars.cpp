// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/vertex_stars.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace scanmill {

VertexStars::VertexStars(const TetMesh& tets)
    : tets_(tets),
      anchors_(tets.positions.size()),
      slots_(tets.cells.size()) {
    std::ranges::fill(anchors_, none);
    std::ranges::fill(slots_, u64(0));
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        for (const u32 vertex : tets.cells[cell]) anchors_[vertex] = cell;
}

std::span<const u32> VertexStars::cells_at(u32 vertex) {
    base_ += star_.size();
    star_.assign(1, anchors_[vertex]);
    slots_[star_[0]] = base_;
    for (std::size_t i = 0; i < star_.size(); ++i) {
        const u32 cell = star_[i];
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const u32 across = tets_.neighbours[cell][corner];
            if (tets_.cells[cell][corner] == vertex || across == none || slots_[across] >= base_) continue;
            slots_[across] = base_ + star_.size();
            star_.push_back(across);
        }
    }
    return star_;
}

std::size_t VertexStars::surplus_parts(u32 vertex, std::span<const u8> labels) {
    cells_at(vertex);
    const u32 beyond = static_cast<u32>(star_.size());
    parents_.resize(beyond + 1);
    std::iota(parents_.begin(), parents_.end(), u32(0));
    std::size_t inside = 0, outside = 0;
    for (const u32 cell : star_) ++(labels[cell] == 1 ? inside : outside);
    bool at_hull = false;
    for (u32 i = 0; i < beyond; ++i) {
        const u32 cell = star_[i];
        const bool is_inside = labels[cell] == 1;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if (tets_.cells[cell][corner] == vertex) continue;
            const u32 across = tets_.neighbours[cell][corner];
            if (across == none && !std::exchange(at_hull, true)) ++outside;
            if (across == none ? is_inside : (labels[across] == 1) != is_inside) continue;
            u32 a = root(i), b = root(across == none ? beyond : static_cast<u32>(slots_[across] - base_));
            if (a == b) continue;
            // The representative of a part is the outside of the hull, if the part contains it, else its lowest cell.
            if (a == beyond || (b != beyond && star_[a] < star_[b])) std::swap(a, b);
            parents_[a] = b;
            --(is_inside ? inside : outside);
        }
    }
    return inside - std::min<std::size_t>(inside, 1) + outside - std::min<std::size_t>(outside, 1);
}

u32 VertexStars::part(u32 i) {
    const u32 representative = root(i);
    return representative == star_.size() ? none : star_[representative];
}

}  // namespace scanmill
