// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/sculptor.hpp"

#include <algorithm>
#include <cassert>

#include "scanmill/base/parallel.hpp"

namespace scanmill::sculpting {

Sculptor::Sculptor(CarvedSolid& solid, const SculptParams& params, std::size_t interior_points, unsigned threads)
    : solid_(solid),
      tets_(solid.tets()),
      criteria_(solid, params, threads),
      chains_(solid, criteria_),
      openings_(solid, criteria_),
      interior_points_(interior_points),
      smoothing_(tets_),
      exposing_(tets_),
      is_due_(tets_.cells.size()),
      evaluated_(tets_.cells.size()) {
    std::ranges::fill(is_due_, u8(0));
    std::ranges::fill(evaluated_, 0);
    find_candidates(threads);
}

void Sculptor::find_candidates(unsigned threads) {
    constexpr std::size_t chunk = 1 << 14;
    struct Found {
        std::vector<WaitingStep> smoothing, chains, exposing;
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
            else if (const std::optional<double> gain = criteria_.smoothing(cell, open))
                found[begin / chunk].smoothing.push_back({*gain, 0, cell, now_});
            else if (const Chain chain = chains_.best_from(cell, open); !chain.cells().empty())
                found[begin / chunk].chains.push_back({chain.gain(), 0, cell, now_});
        }
    });
    std::vector<WaitingStep> smoothing, chains, exposing;
    for (const Found& part : found) {
        smoothing.insert(smoothing.end(), part.smoothing.begin(), part.smoothing.end());
        chains.insert(chains.end(), part.chains.begin(), part.chains.end());
        exposing.insert(exposing.end(), part.exposing.begin(), part.exposing.end());
    }
    smoothing_.append(smoothing);
    chains_.append(chains);
    exposing_.append(exposing);
}

WaitingStep Sculptor::exposing_step(u32 cell, unsigned open) const {
    return {criteria_.exposing(cell, open), criteria_.gains().squared_radius(cell, only_corner(open)), cell, now_,
            criteria_.uncovers_too_large(cell, open)};
}

bool Sculptor::step() {
    if (smooth() || smooth_by_chain()) return true;
    return interior_points_ > 0 && (expose() || open());
}

bool Sculptor::smooth() {
    // Another step may have brought the edge to the boundary without changing a gain.
    const auto still_flips = [&](const WaitingStep& step) {
        return is_current(step) && solid_.flips(step.cell, solid_.open_facets(step.cell));
    };
    WaitingStep best;
    if (!smoothing_.pop(best, still_flips)) return false;
    remove(best.cell, SculptStep::smoothing, best.gain);
    return true;
}

bool Sculptor::smooth_by_chain() {
    const Chain chain = chains_.next();
    for (u32 cell : chain.cells()) {
        remove(cell, SculptStep::smoothing);
        removals_.back().chained = cell != chain.cells().back();
    }
    return !chain.cells().empty();
}

bool Sculptor::expose() {
    // Another step may have brought the point to the boundary.
    const auto still_exposes = [&](const WaitingStep& step) {
        return is_current(step) && solid_.exposes(step.cell, solid_.open_facets(step.cell));
    };
    evaluate_due();
    WaitingStep best;
    while (exposing_.pop(best, still_exposes)) {
        if (best.time != now_) {
            // The smoothing step of the look-ahead may have become impossible.
            const double gain = criteria_.exposing(best.cell, solid_.open_facets(best.cell));
            if (gain < best.gain) {
                best.gain = gain;
                best.time = evaluated_[best.cell] = now_;
                exposing_.push(best);
                continue;
            }
        }
        remove(best.cell, SculptStep::exposing);
        return true;
    }
    return false;
}

bool Sculptor::open() {
    const Opening opening = openings_.next();
    if (opening.second == none) return false;
    if (opening.first != none) remove(opening.first, SculptStep::opening);
    remove(opening.second, SculptStep::opening);
    return true;
}

void Sculptor::remove(u32 cell, SculptStep step, double gain) {
    assert(gain == criteria_.gains().of(cell, solid_.open_facets(cell)));
    removals_.push_back({cell, step, gain});
    solid_.remove(cell);
    ++now_;
    if (step == SculptStep::exposing) {
        --interior_points_;
        allow_smoothing_near(cell);
    }
    refresh_near(cell);
}

void Sculptor::refresh(u32 cell) {
    if (evaluated_[cell] == now_) return;
    evaluated_[cell] = now_;
    const unsigned open = solid_.open_facets(cell);
    if (open == 0) return;
    if (solid_.exposes(cell, open)) {
        if (std::exchange(is_due_[cell], u8(1)) == 0) due_.push_back(cell);
    } else if (const std::optional<double> gain = criteria_.smoothing(cell, open)) {
        smoothing_.push({*gain, 0, cell, now_});
    }
}

void Sculptor::evaluate_due() {
    for (u32 cell : due_) {
        is_due_[cell] = 0;
        if (!solid_.has(cell)) continue;
        const unsigned open = solid_.open_facets(cell);
        if (!solid_.exposes(cell, open)) continue;
        evaluated_[cell] = now_;
        exposing_.push(exposing_step(cell, open));
    }
    due_.clear();
}

void Sculptor::refresh_near(u32 removed) {
    changed_.clear();
    for (u32 across : tets_.neighbours[removed])
        if (solid_.has(across)) changed_.push_back(across);
    // Gains depend on the boundary triangles at the cell's edges. Among the cells at an edge only the first and the
    // last have such a triangle; the triangle on the other side of the edge is now a different one.
    for (const CellEdge& edge : cell_edges)
        for (const auto& [across, kept] : {std::pair(edge.c, edge.d), std::pair(edge.d, edge.c)}) {
            EdgeWalk walk(tets_, removed, across, kept);
            while (solid_.has(walk.next())) walk.step();
            if (walk.cell() != removed) changed_.push_back(walk.cell());
        }
    for (u32 cell : changed_) {
        refresh(cell);
        chains_.recheck(cell);
    }
    // With look-ahead, the gain of an exposing step depends on the gains of the cell's neighbours.
    for (u32 cell : changed_)
        for (u32 across : tets_.neighbours[cell])
            if (solid_.has(across) && solid_.exposes(across, solid_.open_facets(across))) refresh(across);
}

void Sculptor::allow_smoothing(u32 cell) {
    if (!criteria_.mark_near_exposed(cell)) return;
    refresh(cell);
    chains_.recheck(cell);
}

void Sculptor::allow_smoothing_near(u32 removed) {
    for (u32 first : tets_.neighbours[removed]) {
        if (!solid_.has(first)) continue;
        allow_smoothing(first);
        for (u32 second : tets_.neighbours[first])
            if (solid_.has(second)) allow_smoothing(second);
    }
}

}  // namespace scanmill::sculpting
