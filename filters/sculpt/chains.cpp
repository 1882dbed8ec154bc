// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/chains.hpp"

#include <algorithm>

namespace scanmill::sculpting {

Chain Chains::extended(const Chain& chain, u32 cell, unsigned open) const {
    Chain result = chain;
    result.cells_[result.length_] = cell;
    result.open_[result.length_++] = open;
    result.may_smooth_ |= criteria_.may_smooth(cell, open);
    return result;
}

bool Chains::evaluate(Chain& chain) const {
    for (; chain.evaluated_ < chain.length_; ++chain.evaluated_) {
        const u32 cell = chain.cells_[chain.evaluated_];
        const unsigned open = chain.open_[chain.evaluated_];
        const Without earlier = chain.cells().first(chain.evaluated_);
        if (!criteria_.may_flip(cell, open, earlier)) return false;
        chain.gain_ += criteria_.gains().of(cell, open, earlier);
        chain.least_ += criteria_.least_gain(cell, open);
    }
    return true;
}

bool Chains::is_better(const Chain& chain, const Chain& best) const {
    if (!(chain.gain_ > chain.least_)) return false;
    if (best.length_ == 0 || chain.gain_ != best.gain_) return best.length_ == 0 || chain.gain_ > best.gain_;
    return std::ranges::lexicographical_compare(
        chain.cells(), best.cells(), [&](u32 a, u32 b) { return a != b && is_lower_cell(solid_.tets(), a, b); });
}

void Chains::search_from(const Chain& chain, Chain& best) const {
    // Most of a boundary is smooth. Nothing is evaluated there.
    Chain checked = chain;
    if (checked.may_smooth_ && !evaluate(checked)) return;
    if (checked.may_smooth_ && checked.length_ > 1 && is_better(checked, best)) best = checked;
    if (checked.length_ == longest_chain) return;
    for (u32 cell : checked.cells())
        for (u32 across : solid_.tets().neighbours[cell]) {
            if (!solid_.has(across, checked.cells())) continue;
            const unsigned open = solid_.open_facets(across, checked.cells());
            if (std::popcount(open) == 2) search_from(extended(checked, across, open), best);
        }
}

Chain Chains::best_from(u32 cell, unsigned open) const {
    Chain best;
    if (std::popcount(open) == 2) search_from(extended({}, cell, open), best);
    return best;
}

void Chains::find_first_cells(u32 changed) {
    // The first cell of a chain has two open facets now. A later cell of the chain gets one or both of its open facets
    // during the chain. Now it has one, or it has none and two earlier cells as neighbours. So the first cell is at
    // most two steps from any other cell of the chain, through cells with fewer than two open facets.
    const auto open_facets = [&](u32 cell) { return solid_.has(cell) ? std::popcount(solid_.open_facets(cell)) : 4; };
    const auto consider = [&](u32 cell) {
        const int open = open_facets(cell);
        if (open == 2) first_cells_.push_back(cell);
        return open < 2;
    };
    if (!consider(changed)) return;
    for (u32 one : solid_.tets().neighbours[changed])
        if (consider(one))
            for (u32 two : solid_.tets().neighbours[one]) consider(two);
}

void Chains::recheck_changed() {
    first_cells_.clear();
    std::ranges::sort(changed_);
    changed_.erase(std::ranges::unique(changed_).begin(), changed_.end());
    for (u32 cell : changed_) find_first_cells(cell);
    changed_.clear();
    std::ranges::sort(first_cells_);
    first_cells_.erase(std::ranges::unique(first_cells_).begin(), first_cells_.end());
    for (u32 cell : first_cells_) {
        const Chain chain = best_from(cell, solid_.open_facets(cell));
        if (chain.length_ > 0) waiting_.push({chain.gain_, 0, cell});
    }
}

Chain Chains::next() {
    recheck_changed();
    const auto is_there = [&](const WaitingStep& step) { return solid_.has(step.cell); };
    WaitingStep first;
    while (waiting_.pop(first, is_there)) {
        const Chain chain = best_from(first.cell, solid_.open_facets(first.cell));
        if (chain.length_ == 0) continue;
        if (chain.gain_ >= first.gain) return chain;
        first.gain = chain.gain_;
        waiting_.push(first);
    }
    return {};
}

}  // namespace scanmill::sculpting
