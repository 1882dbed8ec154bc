// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/sculptor.hpp"

#include <algorithm>
#include <cassert>

#include "scanmill/filter/parallel.hpp"

namespace scanmill::sculpting {

Sculptor::Sculptor(CarvedSolid& solid, const SculptParams& params, std::size_t interior_points, unsigned threads)
    : solid_(solid),
      tets_(solid.tets()),
      judge_(solid, params),
      openings_(solid, judge_),
      interior_points_(interior_points),
      smoothing_(tets_),
      exposing_(tets_),
      looked_at_(tets_.cells.size()) {
    std::ranges::fill(looked_at_, 0);
    find_candidates(threads);
}

void Sculptor::find_candidates(unsigned threads) {
    constexpr std::size_t chunk = 1 << 14;
    struct Found {
        std::vector<WaitingStep> smoothing, exposing;
    };
    const std::size_t cells = tets_.cells.size();
    std::vector<Found> found((cells + chunk - 1) / chunk);
    for_each_chunk(threads, cells, chunk, [&](std::size_t begin, std::size_t end) {
        for (u32 cell = static_cast<u32>(begin); cell < end; ++cell) {
            if (!solid_.has(cell)) continue;
            const unsigned open = solid_.open_facets(cell);
            if (open == 0) continue;
            if (solid_.exposes(cell, open))
                found[begin / chunk].exposing.push_back(
                    {judge_.exposing(cell, open), judge_.gains().squared_radius(cell, only_corner(open)), cell, now_});
            else if (const std::optional<double> gain = judge_.smoothing(cell, open))
                found[begin / chunk].smoothing.push_back({*gain, 0, cell, now_});
        }
    });
    std::vector<WaitingStep> smoothing, exposing;
    for (const Found& part : found) {
        smoothing.insert(smoothing.end(), part.smoothing.begin(), part.smoothing.end());
        exposing.insert(exposing.end(), part.exposing.begin(), part.exposing.end());
    }
    smoothing_.append(smoothing);
    exposing_.append(exposing);
}

bool Sculptor::step() {
    const auto is_current = [&](const WaitingStep& step) {
        return solid_.has(step.cell) && looked_at_[step.cell] == step.time;
    };
    WaitingStep best;
    if (smoothing_.pop(best, is_current)) {
        remove(best.cell, SculptStep::smoothing);
        return true;
    }
    if (interior_points_ == 0) return false;
    // Another step may have brought the point to the surface without touching an edge of this cell.
    const auto still_exposes = [&](const WaitingStep& step) {
        return is_current(step) && solid_.exposes(step.cell, solid_.open_facets(step.cell));
    };
    if (exposing_.pop(best, still_exposes)) {
        remove(best.cell, SculptStep::exposing);
        return true;
    }
    const Opening opening = openings_.next();
    if (opening.second == none) return false;
    if (opening.first != none) remove(opening.first, SculptStep::opening);
    remove(opening.second, SculptStep::opening);
    return true;
}

void Sculptor::remove(u32 cell, SculptStep step) {
    removals_.push_back({cell, step, judge_.gains().of(cell, solid_.open_facets(cell))});
    solid_.remove(cell);
    ++now_;
    if (step == SculptStep::exposing) {
        --interior_points_;
        allow_smoothing_near(cell);
    }
    refresh_round(cell);
}

void Sculptor::refresh(u32 cell) {
    if (looked_at_[cell] == now_) return;
    looked_at_[cell] = now_;
    const unsigned open = solid_.open_facets(cell);
    if (open == 0) return;
    if (solid_.exposes(cell, open))
        exposing_.push(
            {judge_.exposing(cell, open), judge_.gains().squared_radius(cell, only_corner(open)), cell, now_});
    else if (const std::optional<double> gain = judge_.smoothing(cell, open))
        smoothing_.push({*gain, 0, cell, now_});
}

void Sculptor::refresh_round(u32 removed) {
    // Gains depend on the boundary at the cell's edges, and so on the cells round these edges...
    round_.clear();
    for (const CellEdge& edge : cell_edges)
        for (const auto& [across, kept] : {std::pair(edge.c, edge.d), std::pair(edge.d, edge.c)})
            for (EdgeWalk walk(tets_, removed, across, kept); solid_.has(walk.next());) {
                walk.step();
                round_.push_back(walk.cell());
            }
    // ... with look-ahead also round those of their neighbours.
    for (std::size_t i = 0, count = round_.size(); i < count; ++i)
        for (u32 across : tets_.neighbours[round_[i]])
            if (solid_.has(across)) round_.push_back(across);
    for (u32 cell : round_) refresh(cell);
}

void Sculptor::allow_smoothing_near(u32 removed) {
    for (u32 first : tets_.neighbours[removed]) {
        if (!solid_.has(first)) continue;
        if (judge_.set_near(first)) refresh(first);
        for (u32 second : tets_.neighbours[first])
            if (solid_.has(second) && judge_.set_near(second)) refresh(second);
    }
}

}  // namespace scanmill::sculpting
