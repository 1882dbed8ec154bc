// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/growing_pieces.hpp"

#include <algorithm>
#include <utility>

namespace scanmill::alpha {

GrowingPieces::GrowingPieces(const TetMesh& tets, std::span<const u8> labels)
    : tets_(tets),
      pieces_(tets.cells.size()),
      is_in_(tets.cells.size(), u8(0)),
      next_(tets.cells.size()),
      cells_(tets.cells.size()),
      points_(tets.cells.size()),
      first_(tets.positions.size() + 1, 0u),
      around_(4 * tets.cells.size()),
      pieces_holding_(tets.positions.size() + 1, 0u),
      seen_(tets.positions.size(), 0u) {
    for (const Tetrahedron& cell : tets_.cells)
        for (u32 vertex : cell) ++first_[vertex];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    for (u32 c = 0; c < tets_.cells.size(); ++c)
        for (u32 vertex : tets_.cells[c]) around_[--first_[vertex]] = c;
    for (u32 cell = 0; cell < labels.size(); ++cell)
        if (labels[cell] != outside) add(cell);
}

void GrowingPieces::add(std::span<const u32> cells) {
    for (u32 cell : cells) add(cell);
}

void GrowingPieces::add(u32 cell) {
    is_in_[cell] = 1;
    next_[cell] = cell;
    cells_[cell] = 1;
    points_[cell] = 4;
    ++pieces_holding_[4];
    most_ = std::max<std::size_t>(most_, 4);
    for (u32 across : tets_.neighbours[cell])
        if (across != TetMesh::outside_hull && is_in_[across]) join(cell, across);
}

void GrowingPieces::join(u32 a, u32 b) {
    u32 smaller = pieces_.find(a), larger = pieces_.find(b);
    if (smaller == larger) return;
    if (cells_[smaller] > cells_[larger]) std::swap(smaller, larger);
    const auto points = static_cast<u32>(points_[smaller] + points_[larger] - common_points(smaller, larger));
    const u32 cells = cells_[smaller] + cells_[larger];
    --pieces_holding_[points_[smaller]];
    --pieces_holding_[points_[larger]];
    ++pieces_holding_[points];
    most_ = std::max<std::size_t>(most_, points);
    std::swap(next_[smaller], next_[larger]);  // two rings become one
    pieces_.unite(smaller, larger);
    const u32 root = pieces_.find(smaller);
    cells_[root] = cells;
    points_[root] = points;
}

std::size_t GrowingPieces::common_points(u32 smaller, u32 larger) {
    ++round_;
    std::size_t count = 0;
    u32 cell = smaller;
    do {
        for (u32 vertex : tets_.cells[cell])
            if (std::exchange(seen_[vertex], round_) != round_) count += holds(larger, vertex);
        cell = next_[cell];
    } while (cell != smaller);
    return count;
}

bool GrowingPieces::holds(u32 piece, u32 vertex) {
    for (u32 i = first_[vertex]; i < first_[vertex + 1]; ++i)
        if (is_in_[around_[i]] && pieces_.find(around_[i]) == piece) return true;
    return false;
}

}  // namespace scanmill::alpha
