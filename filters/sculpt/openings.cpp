// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/openings.hpp"

#include <algorithm>

namespace scanmill::sculpting {

namespace {

int corner_of(const Tetrahedron& cell, u32 vertex) {
    return static_cast<int>(std::ranges::find(cell, vertex) - cell.begin());
}

}  // namespace

Openings::Openings(CarvedSolid& solid, const StepCriteria& criteria)
    : solid_(solid),
      tets_(solid.tets()),
      criteria_(criteria) {}

VertexStars& Openings::stars() {
    if (!stars_) stars_.emplace(tets_);
    return *stars_;
}

void Openings::consider_after(Opening& best, u32 first, u32 second, u32 below, double gain_of_first) {
    const unsigned open = solid_.open_facets(second);
    if (!solid_.flips(second, open) || criteria_.uncovers_too_large(second, open)) return;
    double gain = gain_of_first + criteria_.gains().of(second, open);
    solid_.set_temporarily(second, false);
    gain += criteria_.exposing(below, solid_.open_facets(below));
    solid_.set_temporarily(second, true);

    const auto is_lower = [&](u32 a, u32 b) { return b != none && (a == none || is_lower_cell(tets_, a, b)); };
    const bool is_better =
        best.second == none || gain > best.gain ||
        (gain == best.gain && (second != best.second ? is_lower(second, best.second) : is_lower(first, best.first)));
    if (is_better) best = {gain, first, second};
}

void Openings::consider(Opening& best, u32 vertex, u32 below) {
    const u32 over = tets_.neighbours[below][corner_of(tets_.cells[below], vertex)];
    const unsigned open = solid_.open_facets(over);
    if (std::popcount(open) == 2) consider_after(best, none, over, below, 0);
    if (std::popcount(open) != 1) return;
    for (u32 beside : tets_.neighbours[over]) {
        if (beside == below || !solid_.has(beside)) continue;
        const unsigned open_beside = solid_.open_facets(beside);
        if (!solid_.flips(beside, open_beside) || criteria_.uncovers_too_large(beside, open_beside)) continue;
        const double gain = criteria_.gains().of(beside, open_beside);
        solid_.set_temporarily(beside, false);
        consider_after(best, beside, over, below, gain);
        solid_.set_temporarily(beside, true);
    }
}

Opening Openings::best_for(u32 vertex) {
    Opening best;
    for (u32 below : stars().cells_at(vertex)) consider(best, vertex, below);
    return best;
}

void Openings::start_round() {
    round_.clear();
    next_in_round_ = 0;
    reached_ = false;
    for (u32 vertex = 0; vertex < tets_.positions.size(); ++vertex) {
        if (!is_interior(vertex)) continue;
        const Opening opening = best_for(vertex);
        if (opening.second != none) round_.push_back({opening.gain, vertex});
    }
    std::ranges::sort(round_, [&](const Candidate& a, const Candidate& b) {
        return a.gain != b.gain ? a.gain > b.gain : is_lower(tets_.positions[a.vertex], tets_.positions[b.vertex]);
    });
}

Opening Openings::next() {
    while (true) {
        if (next_in_round_ == round_.size()) {
            if (!reached_) return {};
            start_round();
            if (round_.empty()) return {};
        }
        const u32 vertex = round_[next_in_round_++].vertex;
        if (!is_interior(vertex)) continue;
        const Opening opening = best_for(vertex);
        if (opening.second == none) continue;
        reached_ = true;
        return opening;
    }
}

Openings::Reason Openings::reason(u32 vertex) {
    for (u32 below : stars().cells_at(vertex)) {
        const u32 over = tets_.neighbours[below][corner_of(tets_.cells[below], vertex)];
        if (solid_.open_facets(over) != 0) return Reason::blocked;
    }
    return Reason::deep;
}

Array<u32> Openings::interior_points() {
    Array<u32> points;
    for (u32 vertex = 0; vertex < tets_.positions.size(); ++vertex)
        if (is_interior(vertex)) points.push_back(vertex);
    return points;
}

}  // namespace scanmill::sculpting
