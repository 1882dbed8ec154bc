// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Steps that wait to be taken, the best first. Entries are never changed: a newer entry of a cell makes the older ones
/// stale, and stale entries are skipped.

#include <algorithm>
#include <vector>

#include "sculpt/criteria.hpp"

namespace scanmill::sculpting {

struct WaitingStep {
    double gain = 0;
    /// Among equal gains the larger radius comes first: squared circumradius for exposing steps, else 0.
    double radius = 0;
    u32 cell = none;
    /// Number of removals before the cell was evaluated.
    u32 time = 0;
    /// Result of StepCriteria::uncovers_too_large(): such steps come last.
    bool is_too_large = false;
};

class StepQueue {
public:
    explicit StepQueue(const TetMesh& tets) : tets_(&tets) {}

    void push(const WaitingStep& step) {
        heap_.push_back(step);
        std::ranges::push_heap(heap_, Later{*tets_});
    }
    /// Adds many at once. Cost: linear.
    void append(const std::vector<WaitingStep>& steps) {
        heap_.insert(heap_.end(), steps.begin(), steps.end());
        std::ranges::make_heap(heap_, Later{*tets_});
    }
    /// Removes the best step for which is_current() is true, and returns it in `step`. Also removes all better steps,
    /// which are stale. False if there is none.
    template <class IsCurrent>
    bool pop(WaitingStep& step, const IsCurrent& is_current) {
        while (!heap_.empty()) {
            std::ranges::pop_heap(heap_, Later{*tets_});
            step = heap_.back();
            heap_.pop_back();
            if (is_current(step)) return true;
        }
        return false;
    }

private:
    struct Later {
        const TetMesh& tets;
        bool operator()(const WaitingStep& a, const WaitingStep& b) const {
            if (a.is_too_large != b.is_too_large) return a.is_too_large;
            if (a.gain != b.gain) return a.gain < b.gain;
            if (a.radius != b.radius) return a.radius < b.radius;
            return a.cell != b.cell && is_lower_cell(tets, b.cell, a.cell);
        }
    };

    const TetMesh* tets_;
    std::vector<WaitingStep> heap_;
};

}  // namespace scanmill::sculpting
