// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decides which cell of the solid is removed next.

#include "sculpt/chains.hpp"
#include "sculpt/openings.hpp"

namespace scanmill::sculpting {

/// Takes steps greedily until none is left: the best smoothing step if there is one, else the best chain of flips, else
/// the best exposing step, else an opening.
class Sculptor {
public:
    /// `interior_points`: vertices of the solid that are not on its boundary.
    Sculptor(CarvedSolid& solid, const SculptParams& params, std::size_t interior_points, unsigned threads);

    /// Removes one cell, or those of a chain or an opening; false if no step is left.
    bool step();

    const Array<SculptRemoval>& removals() const { return removals_; }
    Array<SculptRemoval> take_removals() { return std::move(removals_); }
    std::size_t interior_points() const { return interior_points_; }
    const StepCriteria& criteria() const { return criteria_; }
    Openings& openings() { return openings_; }

private:
    void find_candidates(unsigned threads);
    WaitingStep exposing_step(u32 cell, unsigned open) const;
    bool smooth();
    bool smooth_by_chain();
    bool expose();
    bool open();
    void remove(u32 cell, SculptStep step) { remove(cell, step, criteria_.gains().of(cell, solid_.open_facets(cell))); }
    /// `gain`: the gain of removing the cell now.
    void remove(u32 cell, SculptStep step, double gain);
    bool is_current(const WaitingStep& step) const {
        return solid_.has(step.cell) && evaluated_[step.cell] == step.time;
    }
    /// Evaluates the cell again, unless that was done since the last removal. Exposing steps are only marked as due,
    /// since most of them change several times before one is taken.
    void refresh(u32 cell);
    void evaluate_due();
    /// Evaluates all cells again whose gain the removal may have changed.
    void refresh_near(u32 removed);
    void allow_smoothing(u32 cell);
    void allow_smoothing_near(u32 removed);

    CarvedSolid& solid_;
    const TetMesh& tets_;
    StepCriteria criteria_;
    Chains chains_;
    Openings openings_;
    std::size_t interior_points_;
    StepQueue smoothing_, exposing_;
    /// Cells whose exposing steps must be evaluated before the next such step is taken. `is_due_`: whether a cell is
    /// among them.
    std::vector<u32> due_;
    Array<u8> is_due_;
    Array<SculptRemoval> removals_;
    /// Per cell the number of removals when it was last evaluated, or became due.
    Array<u32> evaluated_;
    u32 now_ = 0;
    std::vector<u32> changed_;
};

}  // namespace scanmill::sculpting
