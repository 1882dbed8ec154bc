// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/decimator.hpp"

#include <algorithm>
#include <limits>

#include "scanmill/base/parallel.hpp"

namespace scanmill::decimating {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
/// Each round chooses from this share of the removable vertices: those with the smallest estimates. For shares between
/// 0.03 and 0.3, the number of triangles of the result changes by less than 2 %. Larger shares need fewer rounds.
constexpr double share_of_round = 0.25;
constexpr std::size_t least_of_round = 64;
constexpr std::size_t chunk = 64;
/// Sines of 25 and 20 degrees, the least angles of the first passes.
constexpr double first_angle_sines[] = {0.42261826174069944, 0.3420201433256687};

}  // namespace

Decimator::Decimator(Surface& surface, const Limits& limits, DecimateMode mode, u64 target, Execution& execution)
    : surface_(surface),
      limits_(limits),
      mode_(mode),
      target_(target),
      execution_(execution),
      planner_(surface, limits, mode),
      estimates_(surface.mesh().vertices(), infinite),
      touched_(surface.mesh().vertices(), 0),
      begin_triangles_(surface.mesh().triangles()) {}

void Decimator::update_estimates(std::span<const u32> vertices) {
    constexpr std::size_t large = 1024;
    for_each_chunk(execution_.threads(), vertices.size(), large, [&](std::size_t begin, std::size_t end) {
        Planner planner(surface_, limits_, mode_);
        for (std::size_t i = begin; i < end; ++i)
            estimates_[vertices[i]] = static_cast<float>(planner.estimate(vertices[i]));
    });
}

void Decimator::update_all_estimates() {
    std::vector<u32> used;
    for (u32 vertex = 0; vertex < estimates_.size(); ++vertex)
        if (surface_.mesh().is_used(vertex)) used.push_back(vertex);
    update_estimates(used);
}

void Decimator::pick_vertices() {
    struct Candidate {
        float estimate;
        u32 vertex;
        auto operator<=>(const Candidate&) const = default;
    };
    std::vector<Candidate> candidates;
    for (u32 vertex = 0; vertex < estimates_.size(); ++vertex)
        if (estimates_[vertex] < infinite) candidates.push_back({estimates_[vertex], vertex});
    const std::size_t share = static_cast<std::size_t>(share_of_round * static_cast<double>(candidates.size()));
    const std::size_t most = std::min(candidates.size(), std::max(least_of_round, share));
    std::ranges::nth_element(candidates, candidates.begin() + static_cast<std::ptrdiff_t>(most));
    candidates.resize(most);
    std::ranges::sort(candidates);
    picked_.clear();
    for (const Candidate& candidate : candidates) {
        const auto is_touched = [&](u32 vertex) { return touched_[vertex] == round_; };
        if (is_touched(candidate.vertex)) continue;
        surface_.mesh().ring(candidate.vertex, ring_);
        if (std::ranges::any_of(ring_, is_touched)) continue;
        touched_[candidate.vertex] = round_;
        for (const u32 vertex : ring_) touched_[vertex] = round_;
        picked_.push_back(candidate.vertex);
    }
    // Near the target, only the first candidates are removed. A removal takes away two triangles, or one on the
    // boundary.
    const std::size_t triangles = surface_.mesh().triangles();
    const std::size_t needed = triangles > target_ ? (triangles - target_ + 1) / 2 : 0;
    if (picked_.size() > needed) picked_.resize(needed);
    std::ranges::sort(picked_);  // plans neighbours in memory one after the other
}

void Decimator::open_all_edges() {
    const EditableMesh& mesh = surface_.mesh();
    open_edges_.clear();
    for (u32 half_edge = 0; half_edge < 3 * mesh.rows(); ++half_edge)
        if (!mesh.is_empty(half_edge / 3) && !mesh.is_boundary(half_edge) && half_edge < mesh.opposite(half_edge))
            open_edges_.push_back(half_edge);
}

void Decimator::pick_edges() {
    const EditableMesh& mesh = surface_.mesh();
    std::ranges::sort(open_edges_);
    open_edges_.erase(std::unique(open_edges_.begin(), open_edges_.end()), open_edges_.end());
    picked_.clear();
    std::size_t left = 0;
    for (const u32 half_edge : open_edges_) {
        if (mesh.is_empty(half_edge / 3) || mesh.is_boundary(half_edge) || surface_.is_feature(half_edge)) continue;
        const std::array<u32, 4> vertices{mesh.start(half_edge), mesh.end(half_edge), mesh.apex(half_edge),
                                          mesh.apex(mesh.opposite(half_edge))};
        if (std::ranges::any_of(vertices, [&](u32 vertex) { return touched_[vertex] == round_; })) {
            open_edges_[left++] = half_edge;
            continue;
        }
        for (const u32 vertex : vertices) touched_[vertex] = round_;
        picked_.push_back(half_edge);
    }
    open_edges_.resize(left);
}

template <class Plan>
void Decimator::plan_all(Plan&& plan) {
    if (plans_.size() < picked_.size()) plans_.resize(picked_.size());
    for_each_chunk(execution_.threads(), picked_.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution_.check_cancelled();
        Planner planner(surface_, limits_, mode_);
        for (std::size_t i = begin; i < end; ++i) plan(planner, picked_[i], plans_[i]);
    });
}

bool Decimator::apply(const Edit& edit) {
    if (planner_.intersects(edit, round_)) return false;
    new_rows_.clear();
    surface_.apply(edit, round_, new_rows_);
    const EditableMesh& mesh = surface_.mesh();
    for (const u32 row : new_rows_)
        for (u32 half_edge = 3 * row; half_edge < 3 * row + 3; ++half_edge)
            open_edges_.push_back(std::min(half_edge, mesh.opposite(half_edge)));
    return true;
}

void Decimator::remove_vertices() {
    std::vector<u32> changed;
    while (!is_enough()) {
        ++round_;
        pick_vertices();
        if (picked_.empty()) return;
        plan_all([](Planner& planner, u32 vertex, Edit& edit) { planner.plan_removal(vertex, edit); });
        changed.clear();
        for (std::size_t i = 0; i < picked_.size() && !is_enough(); ++i) {
            surface_.mesh().ring(picked_[i], ring_);
            if (plans_[i].is_possible && !apply(plans_[i])) continue;
            estimates_[picked_[i]] = infinite;
            if (!plans_[i].is_possible) continue;
            changed.insert(changed.end(), ring_.begin(), ring_.end());
            ++counts_.removed;
        }
        surface_.tidy();
        update_estimates(changed);
        const double removed = static_cast<double>(counts_.removed);
        const double share = std::min(1.0, 2 * removed / static_cast<double>(begin_triangles_));
        execution_.progress(progress_begin + (progress_end - progress_begin) * share);
    }
}

std::size_t Decimator::flip_edges() {
    std::size_t flips = 0;
    std::vector<u32> changed;
    for (;;) {
        ++round_;
        pick_edges();
        if (picked_.empty()) break;
        plan_all([](Planner& planner, u32 half_edge, Edit& edit) { planner.plan_flip(half_edge, edit); });
        for (std::size_t i = 0; i < picked_.size(); ++i) {
            if (!plans_[i].is_possible) continue;
            if (!apply(plans_[i])) {
                open_edges_.push_back(picked_[i]);
                continue;
            }
            ++flips;
            for (const Triangle& triangle : plans_[i].triangles)
                changed.insert(changed.end(), triangle.begin(), triangle.end());
        }
    }
    std::ranges::sort(changed);
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    update_estimates(changed);
    return flips;
}

void Decimator::run_until_stuck(bool flips_edges) {
    update_all_estimates();
    open_all_edges();
    for (;;) {
        const std::size_t before = counts_.removed;
        remove_vertices();
        const std::size_t flips = flips_edges ? flip_edges() : 0;
        counts_.flips += flips;
        if (is_enough() || flips == 0 || counts_.removed == before) return;
    }
}

DecimatorCounts Decimator::run(bool flips_edges) {
    const double least = limits_.angle_sine, least_on_flat = limits_.flat_angle_sine;
    for (const double sine : first_angle_sines) {
        if (!(sine > least)) continue;
        limits_.angle_sine = limits_.flat_angle_sine = sine;
        run_until_stuck(flips_edges);
    }
    limits_.angle_sine = least;
    limits_.flat_angle_sine = least_on_flat;
    // An edit can make distant edits possible, so all are tried again until none is possible.
    DecimatorCounts before;
    do {
        before = counts_;
        run_until_stuck(flips_edges);
    } while (!is_enough() && (counts_.removed > before.removed || counts_.flips > before.flips));
    return counts_;
}

}  // namespace scanmill::decimating
