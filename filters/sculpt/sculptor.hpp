// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The order of the steps: which cell of the solid goes next.

#include "sculpt/chains.hpp"
#include "sculpt/openings.hpp"

namespace scanmill::sculpting {

/// Greedy: a smoothing step as soon as there is one, the best first; else the best chain of flips; else the best
/// exposing step; else an opening; until none of these is left.
class Sculptor {
public:
    /// `interior_points`: vertices of the solid that are not on its boundary.
    Sculptor(CarvedSolid& solid, const SculptParams& params, std::size_t interior_points, unsigned threads);

    /// Removes one cell, or those of a chain or an opening; false when nothing is left to do.
    bool step();

    const Array<SculptRemoval>& removals() const { return removals_; }
    Array<SculptRemoval> take_removals() { return std::move(removals_); }
    std::size_t interior_points() const { return interior_points_; }
    const Judge& judge() const { return judge_; }
    Openings& openings() { return openings_; }

private:
    void find_candidates(unsigned threads);
    WaitingStep exposing_step(u32 cell, unsigned open) const;
    bool smooth();
    bool smooth_by_chain();
    bool expose();
    bool open();
    void remove(u32 cell, SculptStep step);
    bool is_current(const WaitingStep& step) const {
        return solid_.has(step.cell) && looked_at_[step.cell] == step.time;
    }
    /// Looks again at a cell unless that was done since the last removal.
    void refresh(u32 cell);
    /// At everything whose judgement a removal can change.
    void refresh_round(u32 removed);
    void set_near(u32 cell);
    void allow_smoothing_near(u32 removed);

    CarvedSolid& solid_;
    const TetMesh& tets_;
    Judge judge_;
    Chains chains_;
    Openings openings_;
    std::size_t interior_points_;
    StepQueue smoothing_, exposing_;
    Array<SculptRemoval> removals_;
    /// Per cell the number of removals when it was last looked at.
    Array<u32> looked_at_;
    u32 now_ = 0;
    std::vector<u32> round_;
};

}  // namespace scanmill::sculpting
