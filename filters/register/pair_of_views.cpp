// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/pair_of_views.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/geometry/registration/plane_equations.hpp"

namespace scanmill::registration {

namespace {

// Lengths are multiples of the resolution.
constexpr std::size_t similar_per_point = 3;  ///< the right partner often is not the most similar one
constexpr double point_rounds[] = {2, 2, 1.5}, plane_rounds[] = {1.5, 1, 1, 1};
constexpr double refined_product = 0.7;  ///< least product of the normals of two joined points
constexpr double same_candidate = 1.5;
constexpr double partner_distance = 1, partner_product = 0.8;
constexpr double least_facing = 0.5;  ///< cosine of the angle between normal and line of sight
constexpr double other_place = 5, nearly_equal = 0.8;
constexpr std::size_t least_pairs = 6;

/// The nearest point of `to` for each point of `from`, at a motion.
template <class Action>
void for_each_joined(const ReducedView& from, const ReducedView& to, const RigidMotion& motion, double distance,
                     double least_product, Action&& action) {
    for (u32 i = 0; i < from.points.size(); ++i) {
        const Vec3 point = motion.apply(from.points[i]);
        const u32 partner = to.nearest.nearest(point, distance);
        if (partner != NearestWithin::none && motion.turned(from.normals[i]).dot(to.normals[partner]) > least_product)
            action(i, point, partner);
    }
}

/// Counts of one direction: the points of `from` seen from the scanner of `to`.
struct Counts {
    std::size_t points = 0, partners = 0, front = 0, missing = 0;
};

Counts counted(const ReducedView& from, const ReducedView& to, const RigidMotion& motion,
               std::vector<PlanePair>& partners) {
    Counts counts{from.points.size(), 0, 0, 0};
    std::vector<bool> has_partner(from.points.size(), false);
    for_each_joined(from, to, motion, partner_distance * to.resolution, partner_product,
                    [&](u32 i, const Vec3& point, u32 partner) {
                        has_partner[i] = true;
                        ++counts.partners;
                        partners.push_back({point, to.normals[partner], 0});
                    });
    for (u32 i = 0; i < from.points.size(); ++i) {
        if (has_partner[i]) continue;
        const Vec3 point = motion.apply(from.points[i]);
        counts.front += to.sight.place_of(point) == SightLines::Place::in_front;
        counts.missing +=
            motion.turned(from.normals[i]).dot(to.sight.to_scanner()) > least_facing && to.sight.is_empty_at(point);
    }
    return counts;
}

double share(std::size_t part, std::size_t rest) {
    return part == 0 ? 0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

bool is_better(const Candidate& one, const Candidate& other) {
    const bool accepted = one.verdict == Verdict::accepted;
    if (accepted != (other.verdict == Verdict::accepted)) return accepted;
    return one.measures.score() > other.measures.score();
}

}  // namespace

RigidMotion refined(const ReducedView& first, const ReducedView& second, RigidMotion motion) {
    Array<Vec3> before, after;
    for (const double distance : point_rounds) {
        before.clear(), after.clear();
        for_each_joined(first, second, motion, distance * second.resolution, refined_product,
                        [&](u32 i, const Vec3&, u32 partner) {
                            before.push_back(first.points[i]);
                            after.push_back(second.points[partner]);
                        });
        if (before.size() < least_pairs) return motion;
        motion = fitted_motion(before, after);
    }
    std::vector<PlanePair> pairs;
    for (const double distance : plane_rounds) {
        pairs.clear();
        for_each_joined(first, second, motion, distance * second.resolution, refined_product,
                        [&](u32, const Vec3& point, u32 partner) {
                            const Vec3& normal = second.normals[partner];
                            pairs.push_back({point, normal, (point - second.points[partner]).dot(normal)});
                        });
        if (pairs.size() < least_pairs) return motion;
        // Directions along which the surfaces slide would move without limit.
        constexpr double least_eigenvalue = 1e-4;
        motion = orthonormal(motion.then(plane_equations(pairs).motion(least_eigenvalue)));
    }
    return motion;
}

Verdict verdict_of(const PairMeasures& measures, double least_overlap) {
    if (!(measures.overlap >= least_overlap)) return Verdict::no_overlap;
    // Where surfaces slide, any position is as good as another one, and contradictions say nothing.
    if (!(measures.slide >= least_slide)) return Verdict::slides;
    if (!(measures.front <= largest_front)) return Verdict::contradicts;
    return measures.missing <= largest_missing ? Verdict::accepted : Verdict::missing;
}

PairMeasures measured(const ReducedView& first, const ReducedView& second, const RigidMotion& motion) {
    const RigidMotion back = motion.inverse();
    std::vector<PlanePair> partners;
    const Counts there = counted(first, second, motion, partners);
    const std::size_t in_second = partners.size();
    const Counts here = counted(second, first, back, partners);
    for (std::size_t i = in_second; i < partners.size(); ++i)
        partners[i] = {motion.apply(partners[i].point), motion.rotation * partners[i].normal, 0};
    PairMeasures measures;
    measures.overlap = std::max(share(there.partners, there.points - there.partners),
                                share(here.partners, here.points - here.partners));
    measures.front = share(there.front + here.front, there.partners + here.partners);
    measures.missing = share(there.missing + here.missing, there.partners + here.partners);
    const Vector6 eigenvalues = plane_equations(partners).eigenvalues();
    measures.slide = std::max(0.0, eigenvalues[0]);
    measures.free_directions = static_cast<u32>((eigenvalues.array() < least_slide).count());
    return measures;
}

PairResult registered_pair(const ReducedView& first, const ReducedView& second, const PairParams& params,
                           const std::optional<RigidMotion>& start) {
    std::vector<Hypothesis> hypotheses;
    const ViewExtent& extent = first.extent;
    const double resolution = first.resolution;
    if (start) {
        hypotheses.push_back({*start, 0});
    } else {
        const Array<Correspondence> correspondences =
            similar_points(first.descriptors, second.descriptors, similar_per_point, params.most_correspondences);
        hypotheses = consistent_motions(first.points_with_normals(), second.points_with_normals(), correspondences,
                                        {resolution, extent.centre, extent.radius, params.seed_tries});
    }
    PairResult result;
    std::vector<Candidate>& candidates = result.candidates;
    for (const Hypothesis& hypothesis : hypotheses) {
        const RigidMotion motion = refined(first, second, hypothesis.motion);
        const bool is_new = std::ranges::all_of(candidates, [&](const Candidate& old) {
            return displacement(motion, old.motion, extent.centre, extent.radius) > same_candidate * resolution;
        });
        if (!is_new) continue;
        Candidate candidate{motion, measured(first, second, motion)};
        candidate.verdict = verdict_of(candidate.measures, params.least_overlap);
        candidates.push_back(candidate);
        if (candidates.size() == params.most_candidates) break;
    }
    result.settle(extent, resolution);
    return result;
}

void PairResult::settle(const ViewExtent& first, double resolution) {
    std::ranges::stable_sort(candidates, is_better);
    const auto is_rival = [&](const Candidate& other) {
        return other.verdict == Verdict::accepted &&
               other.measures.score() >= nearly_equal * candidates[0].measures.score() &&
               displacement(other.motion, candidates[0].motion, first.centre, first.radius) > other_place * resolution;
    };
    is_ambiguous = is_accepted() && std::ranges::any_of(candidates, is_rival);
}

}  // namespace scanmill::registration
