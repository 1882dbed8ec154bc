// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/incremental_solid.hpp"

#include <algorithm>
#include <limits>

namespace scanmill {

using enum cell_label::Label;

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
      stars_(tets) {
    std::ranges::fill(covered_, u8(0));
    suspect_only(suspects);
    for (u32 cell = 0; cell < labels_.size(); ++cell)
        for (u32 vertex : tets_.cells[cell])
            if (labels_[cell] == solid) covered_count_ += std::exchange(covered_[vertex], u8(1)) == 0;
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

void IncrementalSolid::repair(std::span<const double> price, const Execution& execution) {
    std::vector<u32> cheapest;
    while (true) {
        execution.check_cancelled();
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
            for (u32 cell : stars_.cells())
                if (labels_[cell] != solid) least = std::min(least, price[cell]);
            for (u32 cell : stars_.cells())
                if (labels_[cell] != solid && price[cell] == least) cheapest.push_back(cell);
        }
        suspects_ = std::move(still_non_manifold);
        next_suspect_ = 0;
        next_changed_ = true;
        if (suspects_.empty()) return;
        add(cheapest);
    }
}

}  // namespace scanmill
