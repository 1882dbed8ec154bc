// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/sculptor.hpp"

#include <algorithm>
#include <cassert>

#include "scanmill/filter/parallel.hpp"

namespace scanmill::sculpting {

Sculptor::Sculptor(CarvedSolid& solid, const SculptParams& params, std::size_t interior_points, unsigned threads)
    : solid_(solid),
      tets_(solid.tets()),
      judge_(solid, params, threads),
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
                found[begin / chunk].exposing.push_back(exposing_step(cell, open));
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

WaitingStep Sculptor::exposing_step(u32 cell, unsigned open) const {
    return {judge_.exposing(cell, open), judge_.gains().squared_radius(cell, only_corner(open)), cell, now_,
            judge_.digs(cell, open)};
}

bool Sculptor::step() {
    const auto is_current = [&](const WaitingStep& step) {
        return solid_.has(step.cell) && looked_at_[step.cell] == step.time;
    };
    // Another step may have brought the edge or the point to the surface without changing a gain.
    const auto still_flips = [&](const WaitingStep& step) {
        return is_current(step) && solid_.flips(step.cell, solid_.open_facets(step.cell));
    };
    WaitingStep best;
    if (smoothing_.pop(best, still_flips)) {
        remove(best.cell, SculptStep::smoothing);
        return true;
    }
    if (interior_points_ == 0) return false;
    const auto still_exposes = [&](const WaitingStep& step) {
        return is_current(step) && solid_.exposes(step.cell, solid_.open_facets(step.cell));
    };
    while (exposing_.pop(best, still_exposes)) {
        // The smoothing step that look-ahead counted on may have become impossible.
        const double gain = judge_.exposing(best.cell, solid_.open_facets(best.cell));
        if (gain < best.gain) {
            best.gain = gain;
            exposing_.push(best);
            continue;
        }
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
        exposing_.push(exposing_step(cell, open));
    else if (const std::optional<double> gain = judge_.smoothing(cell, open))
        smoothing_.push({*gain, 0, cell, now_});
}

void Sculptor::refresh_round(u32 removed) {
    round_.clear();
    for (u32 across : tets_.neighbours[removed])
        if (solid_.has(across)) round_.push_back(across);
    // Gains depend on the boundary triangles at the cell's edges. Of the cells round an edge only the first and the
    // last have such a triangle, and see another one now at its other end.
    for (const CellEdge& edge : cell_edges)
        for (const auto& [across, kept] : {std::pair(edge.c, edge.d), std::pair(edge.d, edge.c)}) {
            EdgeWalk walk(tets_, removed, across, kept);
            while (solid_.has(walk.next())) walk.step();
            if (walk.cell() != removed) round_.push_back(walk.cell());
        }
    for (u32 cell : round_) refresh(cell);
    // With look-ahead an exposing step's gain depends on those of its neighbours.
    for (u32 cell : round_)
        for (u32 across : tets_.neighbours[cell])
            if (solid_.has(across) && solid_.exposes(across, solid_.open_facets(across))) refresh(across);
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
