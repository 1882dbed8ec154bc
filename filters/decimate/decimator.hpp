// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decides the order of the edits: rounds of independent removals, those with the smallest estimates first.
///
/// A round takes the vertices with the smallest estimates that share no neighbour, plans their removals in parallel on
/// the mesh as it is, and applies them one by one. No plan depends on another, except that two new triangles may
/// intersect: such a plan waits for the next round. So the result does not depend on the number of threads.

#include "decimate/planner.hpp"
#include "scanmill/base/execution.hpp"

namespace scanmill::decimating {

struct DecimatorCounts {
    std::size_t removed = 0, flips = 0;
};

class Decimator {
public:
    /// Keeps the references to surface and execution. Removal ends with at most `target` triangles.
    Decimator(Surface& surface, const Limits& limits, DecimateMode mode, u64 target, Execution& execution);

    /// Removes vertices until no removal is possible, then flips edges, and again, until neither is possible.
    /// Before that, the same with larger least angles: what can be removed with good triangles goes first. On scanned
    /// models this raises the 10 % quantile of the least angles by 2 degrees at the same number of triangles.
    DecimatorCounts run(bool flips_edges);

private:
    bool is_enough() const { return surface_.mesh().triangles() <= target_; }
    void update_estimates(std::span<const u32> vertices);
    void update_all_estimates();
    /// Independent vertices with small estimates, ascending.
    void pick_vertices();
    /// Independent ones of the open edges, which are then no longer open.
    void pick_edges();
    void open_all_edges();
    /// Plans edits of all picked elements in parallel.
    template <class Plan>
    void plan_all(Plan&& plan);
    /// Applies a planned edit, unless its triangles intersect others of this round: then false.
    bool apply(const Edit& edit);
    void remove_vertices();
    std::size_t flip_edges();
    void run_until_stuck(bool flips_edges);

    Surface& surface_;
    Limits limits_;
    DecimateMode mode_;
    u64 target_;
    Execution& execution_;
    Planner planner_;
    Array<float> estimates_;  ///< by vertex; infinite: not to be tried
    std::vector<u32> open_edges_;  ///< half-edges to try to flip, one per edge; may have repeats and stale ones
    Array<u32> touched_;  ///< by vertex: the last round that took it or a neighbour
    u32 round_ = 0;
    std::vector<u32> picked_, ring_, new_rows_;
    std::vector<Edit> plans_;
    DecimatorCounts counts_;
    std::size_t begin_triangles_ = 0;
};

}  // namespace scanmill::decimating
