// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/incremental_solid.hpp"

#include <algorithm>
#include <limits>

namespace scanmill::alpha {

namespace {
/// Up to this number, suspects are always tested one by one.
constexpr std::size_t few_suspects = 1024;
}  // namespace

IncrementalSolid::IncrementalSolid(const TetMesh& tets, Array<u8> labels, std::span<const u32> suspects)
    : tets_(tets),
      labels_(std::move(labels)),
      many_(std::max<std::size_t>(few_suspects, tets.positions.size() / 16)),
      is_suspect_(tets.positions.size()),
      covered_(tets.positions.size()),
      anchor_(tets.positions.size()),
      slot_(tets.cells.size()) {
    std::ranges::fill(covered_, u8(0));
    std::ranges::fill(slot_, u64(0));
    suspect_only(suspects);
    for (u32 cell = 0; cell < labels_.size(); ++cell)
        for (u32 vertex : tets_.cells[cell]) {
            anchor_[vertex] = cell;
            if (labels_[cell] == solid) covered_count_ += std::exchange(covered_[vertex], u8(1)) == 0;
        }
}

void IncrementalSolid::solidify(u32 seed) {
    stack_.assign(1, seed);
    labels_[seed] = solid;
    while (!stack_.empty()) {
        const u32 cell = stack_.back();
        stack_.pop_back();
        for (u32 vertex : tets_.cells[cell]) {
            if (std::exchange(is_suspect_[vertex], u8(1)) == 0) suspects_.push_back(vertex);
            next_changed_ |= vertex == suspects_[next_suspect_];
            covered_count_ += std::exchange(covered_[vertex], u8(1)) == 0;
        }
        for (u32 across : tets_.neighbours[cell])
            if (across != TetMesh::outside_hull && labels_[across] == left_out) {
                labels_[across] = solid;
                stack_.push_back(across);
            }
    }
}

void IncrementalSolid::add(std::span<const u32> cells) {
    for (u32 cell : cells)
        if (labels_[cell] != solid) solidify(cell);
}

void IncrementalSolid::add_joined(std::span<const u32> cells) {
    for (u32 cell : cells)
        if (labels_[cell] == outside) labels_[cell] = left_out;
    for (u32 cell : cells) {
        if (labels_[cell] == solid) continue;
        const auto is_solid = [&](u32 across) { return across != TetMesh::outside_hull && labels_[across] == solid; };
        if (std::ranges::any_of(tets_.neighbours[cell], is_solid)) solidify(cell);
    }
}

IncrementalSolid::Verdict IncrementalSolid::verdict() {
    for (; next_suspect_ < suspects_.size(); ++next_suspect_) {
        if (!std::exchange(next_changed_, false)) return Verdict::not_manifold;
        if (!is_manifold_at(suspects_[next_suspect_])) return Verdict::not_manifold;
        next_changed_ = true;
        if (suspects_.size() - next_suspect_ > many_) return Verdict::many_suspects;
        is_suspect_[suspects_[next_suspect_]] = 0;
    }
    return Verdict::manifold;
}

void IncrementalSolid::suspect_only(std::span<const u32> vertices) {
    suspects_.assign(vertices.begin(), vertices.end());
    next_suspect_ = 0;
    next_changed_ = true;
    std::ranges::fill(is_suspect_, u8(0));
    for (u32 vertex : suspects_) is_suspect_[vertex] = 1;
}

void IncrementalSolid::collect_star(u32 vertex) {
    base_ += star_.size();
    star_.assign(1, anchor_[vertex]);
    slot_[anchor_[vertex]] = base_;
    for (std::size_t i = 0; i < star_.size(); ++i) {
        const u32 cell = star_[i];
        for (int corner = 0; corner < 4; ++corner) {
            const u32 across = tets_.neighbours[cell][corner];
            if (tets_.cells[cell][corner] == vertex || across == TetMesh::outside_hull || slot_[across] >= base_)
                continue;
            slot_[across] = base_ + star_.size();
            star_.push_back(across);
        }
    }
}

/// The boundary triangles are one fan exactly when the solid cells round the vertex are face-connected, and so are the
/// others, the unbounded outside included.
bool IncrementalSolid::is_manifold_at(u32 vertex) {
    collect_star(vertex);
    const u32 hull = static_cast<u32>(star_.size());
    parent_.resize(hull + 1);
    for (u32 i = 0; i <= hull; ++i) parent_[i] = i;
    const auto find = [&](u32 i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    };
    int solid_parts = 0, other_parts = 0;
    bool at_hull = false;
    for (u32 i = 0; i < hull; ++i) ++(labels_[star_[i]] == solid ? solid_parts : other_parts);
    for (u32 i = 0; i < hull; ++i) {
        const u32 cell = star_[i];
        const bool is_solid = labels_[cell] == solid;
        for (int corner = 0; corner < 4; ++corner) {
            if (tets_.cells[cell][corner] == vertex) continue;
            const u32 across = tets_.neighbours[cell][corner];
            u32 other = hull;
            if (across == TetMesh::outside_hull) {
                if (!std::exchange(at_hull, true)) ++other_parts;
                if (is_solid) continue;
            } else {
                if ((labels_[across] == solid) != is_solid) continue;
                other = static_cast<u32>(slot_[across] - base_);
            }
            const u32 a = find(i), b = find(other);
            if (a == b) continue;
            parent_[a] = b;
            --(is_solid ? solid_parts : other_parts);
        }
    }
    return solid_parts == 0 || other_parts == 0 || (solid_parts == 1 && other_parts == 1);
}

void IncrementalSolid::repair(std::span<const double> price) {
    std::vector<u32> cheapest;
    while (true) {
        cheapest.clear();
        std::vector<u32> still_non_manifold;
        for (; next_suspect_ < suspects_.size(); ++next_suspect_) {
            const u32 vertex = suspects_[next_suspect_];
            if (is_manifold_at(vertex)) {
                is_suspect_[vertex] = 0;
                continue;
            }
            still_non_manifold.push_back(vertex);
            double least = std::numeric_limits<double>::infinity();
            for (u32 cell : star_)
                if (labels_[cell] != solid) least = std::min(least, price[cell]);
            for (u32 cell : star_)
                if (labels_[cell] != solid && price[cell] == least) cheapest.push_back(cell);
        }
        suspects_ = std::move(still_non_manifold);
        next_suspect_ = 0;
        next_changed_ = true;
        if (suspects_.empty()) return;
        add(cheapest);
    }
}

}  // namespace scanmill::alpha
