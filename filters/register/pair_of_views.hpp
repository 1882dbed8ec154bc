// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The relative pose of two views: hypotheses, refinement, and the measures that tell right from wrong.

#include "register/reduced_view.hpp"

namespace scanmill::registration {

/// How well two views agree at a relative pose.
struct PairMeasures {
    /// Share of the points that have a partner in the other view; the larger of the two shares.
    double overlap = 0;
    /// Share of points in front of the other view, where its scanner would have hit them first, among these and those
    /// with a partner.
    double front = 0;
    /// Share of points that face the other view's scanner where that has no points, among these and those with a
    /// partner.
    double missing = 0;
    /// Smallest eigenvalue of the matrix of plane_equations() over the points with a partner. Near 0, the surfaces
    /// slide on each other.
    double slide = 0;
    /// Number of eigenvalues below `least_slide`.
    u32 free_directions = 0;

    double score() const { return overlap * (1 - front) * (1 - front) * (1 - missing); }
};

/// A pose is accepted within these limits. Wrong poses of scanned views have a `front` of 0.05 and more, right ones at
/// most 0.021; right ones of virtual scans of flat parts reach 0.03.
inline constexpr double largest_front = 0.03, largest_missing = 0.10;
/// With noise of half a spacing, planes, spheres, cylinders and bodies of revolution have a `slide` of 0 to 0.0005;
/// parts that do not slide have 0.0022 and more.
inline constexpr double least_slide = 0.002;

enum class Verdict { accepted, no_overlap, slides, contradicts, missing, misfit };
/// The first limit that the measures exceed, in the order of Verdict; never `misfit`, which the full views decide.
Verdict verdict_of(const PairMeasures& measures, double least_overlap);

struct Candidate {
    RigidMotion motion;  ///< from the frame of the first view to that of the second
    PairMeasures measures;
    Verdict verdict = Verdict::no_overlap;
};

struct PairResult {
    /// Those accepted first, then by score, the largest first; ties: more votes.
    std::vector<Candidate> candidates;
    /// Another accepted candidate with nearly the same score differs by much from the first one.
    bool is_ambiguous = false;

    const Candidate* best() const { return candidates.empty() ? nullptr : candidates.data(); }
    bool is_accepted() const { return !candidates.empty() && candidates[0].verdict == Verdict::accepted; }
    /// Sorts the candidates and sets `is_ambiguous`, after measures or verdicts have changed.
    void settle(const ViewExtent& first, double resolution);
};

struct PairParams {
    double least_overlap = 0.3;
    std::size_t seed_tries = 20;
    std::size_t most_candidates = 10;
    /// The most similar ones are used. More of them find poses of parts with large plane faces, whose points are the
    /// most similar ones, but the cost is quadratic.
    std::size_t most_correspondences = 3000;
};

/// Measures the views at a relative pose from the first view to the second.
PairMeasures measured(const ReducedView& first, const ReducedView& second, const RigidMotion& motion);

/// Refines a relative pose with the reduced points: point to point, then point to plane, with decreasing tolerances.
RigidMotion refined(const ReducedView& first, const ReducedView& second, RigidMotion motion);

/// Searches the relative pose of two views with the same resolution. With `start`, this is the only hypothesis.
/// Ties: of equal scores the candidate with more votes counts. Cost: about 0.1 s for views of 1,000 reduced points.
PairResult registered_pair(const ReducedView& first, const ReducedView& second, const PairParams& params,
                           const std::optional<RigidMotion>& start = {});

}  // namespace scanmill::registration
