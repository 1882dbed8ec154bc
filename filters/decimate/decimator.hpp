// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decides the order of the edits: rounds of independent removals, smallest estimates first.
///
/// A round takes vertices with small estimates that have no common neighbour. It plans their removals in parallel,
/// on the mesh at the start of the round, and then applies them one by one. The plans are independent, with one
/// exception: the new triangles of two plans may intersect. The later of these plans waits for the next round. So the
/// result does not depend on the number of threads.

#include "decimate/planner.hpp"
#include "scanmill/base/execution.hpp"

namespace scanmill::decimating {

struct DecimatorCounts {
    std::size_t removed = 0, flips = 0;
};

class Decimator {
public:
    /// Range of the progress that run() reports. The caller reports progress below and above it.
    static constexpr double progress_begin = 0.1, progress_end = 0.75;

    /// Keeps references to `surface` and `execution`. Removal stops once at most `target` triangles are left.
    Decimator(Surface& surface, const Limits& limits, DecimateMode mode, u64 target, Execution& execution);

    /// Alternates between removing vertices and flipping edges until neither is possible. The first passes require
    /// larger least angles, so removals that leave well-shaped triangles come first. On scanned models, the first
    /// passes raise the 10 % quantile of the least angles by 2 degrees at the same number of triangles.
    DecimatorCounts run(bool flips_edges);

private:
    bool is_enough() const { return surface_.mesh().triangles() <= target_; }
    void update_estimates(std::span<const u32> vertices);
    void update_all_estimates();
    /// Picks independent vertices with small estimates, in ascending order.
    void pick_vertices();
    /// Picks independent edges among the open edges, and removes them from the open edges.
    void pick_edges();
    void open_all_edges();
    /// Plans edits of all picked elements in parallel.
    template <class Plan>
    void plan_all(Plan&& plan);
    /// Applies a planned edit. If its triangles intersect new triangles of this round, changes nothing and returns
    /// false.
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
    Array<float> estimates_;  ///< by vertex; infinite for vertices that are not tried
    std::vector<u32> open_edges_;  ///< half-edges of edges to try to flip; may contain repeated and removed ones
    Array<u32> touched_;  ///< by vertex: the last round that picked it, or an element beside it
    u32 round_ = 0;
    std::vector<u32> picked_, ring_, new_rows_;
    std::vector<Edit> plans_;
    DecimatorCounts counts_;
    std::size_t begin_triangles_ = 0;
};

}  // namespace scanmill::decimating
