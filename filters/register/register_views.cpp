// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/register_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>

#include "register/scale.hpp"
#include "register/view_checks.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/registration/relaxation.hpp"

namespace scanmill {

namespace {

using namespace registration;

constexpr std::size_t most_pairs = 5000;
/// The automatic resolution: spacings, and the share of a view's size.
constexpr double spacings_per_voxel = 4, voxels_per_size = 10.5;
constexpr std::size_t least_reduced_points = 50;
/// Relative poses that differ by less resolutions than this are the same.
constexpr double same_pose = 2;
/// Pairs with less overlap say nothing about the poses: rims and thin walls have a few points in front.
constexpr double least_checked_overlap = 0.1;
/// Contradicting pairs have a larger `front`. At relaxed poses, right pairs with enough overlap have up to 0.103. Rims
/// count more where the overlap is less than in an accepted pair: right ones have up to 0.124 there.
constexpr double contradicting_front = 0.12, contradicting_front_of_little_overlap = 0.2;
constexpr std::size_t normal_neighbours = 24, most_samples = 3000;
/// Rounds of the relaxation, with tolerances as shares of the resolution; the last one is in spacings.
constexpr RelaxationStage relaxation_stages[] = {{1, 6}, {0.5, 5}, {0.25, 5}};
/// Surfaces that nearly slide need many rounds; most settle after a few.
constexpr u32 last_rounds = 50;
constexpr double settled = 0.01;  ///< in spacings
/// In spacings, and in multiples of the noise of the noisiest view.
constexpr double last_tolerance = 3, noise_multiple = 4;
/// Views that the field cuts off do not contradict each other by missing points, so their surfaces must agree better.
constexpr double cut_off_tolerance = 1;
/// The least share of points on the other view's surface, among those near it. Right pairs with enough overlap have
/// 0.90 and more; parts that are turned by their symmetry but for details have up to 0.80.
constexpr double least_agreement = 0.87;

struct Edge {
    u32 first, second;
    PairResult result;
};

/// Works on the views that are large enough, in the order of their contents.
class Registration {
public:
    Registration(std::span<const ViewToRegister* const> views, std::span<const std::unique_ptr<ViewSurface>> surfaces,
                 double spacing, double resolution, const RegisterViewsParams& params, Execution& execution)
        : views_(views),
          surfaces_(surfaces),
          resolution_(resolution),
          close_(last_tolerance * spacing),
          settled_(settled * spacing),
          params_(params),
          execution_(execution),
          refusal_(views.size(), ViewRefusal::none) {
        fitting_ = params.whole_views ? close_ : cut_off_tolerance * spacing;
        for (const auto& surface : surfaces)
            for (double* distance : {&close_, &fitting_})
                *distance = std::max(*distance, noise_multiple * surface->noise());
        reduced_.resize(views.size());
        for_each_chunk(execution.threads(), views.size(), 1, [&](std::size_t i, std::size_t) {
            execution.check_cancelled();
            reduced_[i] = std::make_unique<ReducedView>(
                reduced_view(views[i]->points, views[i]->to_scanner.normalized(), resolution, params.whole_views));
            if (reduced_[i]->points.size() < least_reduced_points) refusal_[i] = ViewRefusal::small;
        });
    }

    bool is_small(std::size_t view) const { return refusal_[view] == ViewRefusal::small; }

    struct AsTheyAre {
        std::optional<std::pair<u32, u32>> contradicting;  ///< the first pair whose poses contradict each other
        bool is_connected = false;  ///< pairs that overlap and do not slide lead from each view to each other one
        bool is_right() const { return !contradicting && is_connected; }
    };
    /// Whether no accepted pair has another relative pose than these.
    bool confirms(std::span<const RigidMotion> poses) const {
        return std::ranges::all_of(accepted, [&](const RegisteredPair& pair) {
            const ViewExtent& extent = reduced_[pair.from]->extent;
            return displacement(pair.motion, poses[pair.from].then(poses[pair.to].inverse()), extent.centre,
                                extent.radius) < same_pose * resolution_;
        });
    }
    /// Tests poses by lines of sight alone: given poses may be less exact than relaxed ones.
    AsTheyAre tested(std::span<const RigidMotion> poses) const {
        AsTheyAre test;
        DisjointSets groups(views_.size());
        for (u32 a = 0; a < views_.size(); ++a)
            for (u32 b = a + 1; b < views_.size(); ++b) {
                const PairMeasures measures = measured(*reduced_[a], *reduced_[b], poses[a].then(poses[b].inverse()));
                if (measures.overlap < least_checked_overlap) continue;
                if (sight_contradicts(measures) && !test.contradicting) test.contradicting = {a, b};
                if (measures.slide >= least_slide) groups.unite(a, b);
            }
        test.is_connected = true;
        for (u32 a = 0; a < views_.size(); ++a) test.is_connected &= groups.find(a) == 0;
        return test;
    }

    void run() {
        register_pairs();
        choose_edges();
        while (!place()) {
        }
        explain_refusals();
    }

    const ReducedView& reduced(std::size_t view) const { return *reduced_[view]; }
    ViewRefusal refusal(std::size_t view) const { return refusal_[view]; }
    const std::optional<RigidMotion>& pose(std::size_t view) const { return poses_[view]; }
    const std::vector<Edge>& pairs() const { return pairs_; }

    RegisterViewsResult result;  ///< without views and pairs
    std::vector<RegisteredView> details;  ///< in the order of this class
    std::vector<RegisteredPair> accepted;  ///< in the order of this class

private:
    void register_pairs() {
        for (u32 a = 0; a < views_.size(); ++a)
            for (u32 b = a + 1; b < views_.size(); ++b)
                if (!is_small(a) && !is_small(b)) pairs_.push_back({a, b, {}});
        std::size_t done = 0;
        std::mutex mutex;
        for_each_chunk(execution_.threads(), pairs_.size(), 1, [&](std::size_t i, std::size_t) {
            execution_.check_cancelled();
            Edge& pair = pairs_[i];
            const ViewToRegister &first = *views_[pair.first], &second = *views_[pair.second];
            std::optional<RigidMotion> start;
            if (!params_.as_is && first.start && second.start) start = first.start->then(second.start->inverse());
            pair.result = registered_pair(*reduced_[pair.first], *reduced_[pair.second],
                                          {params_.overlap, params_.seed_tries}, start);
            verify(pair);
            const std::scoped_lock lock(mutex);
            execution_.progress(0.1 + 0.6 * static_cast<double>(++done) / static_cast<double>(pairs_.size()));
        });
    }

    /// Brings the accepted candidates of a pair onto each other with the full views, and rejects those that do not fit.
    void verify(Edge& pair) const {
        const ReducedView &first = *reduced_[pair.first], &second = *reduced_[pair.second];
        const ViewSurface* const surfaces[] = {surfaces_[pair.second].get(), surfaces_[pair.first].get()};
        const ViewPair both[] = {{0, 1}};
        const RelaxationStage stages[] = {{resolution_ / 2, 3}, {resolution_ / 4, 3}, {close_, 4}};
        for (Candidate& candidate : pair.result.candidates) {
            if (candidate.verdict != Verdict::accepted) continue;
            candidate.motion =
                relaxed(surfaces, {RigidMotion(), candidate.motion}, both, stages, settled_, execution_).poses[1];
            candidate.measures = measured(first, second, candidate.motion);
            candidate.verdict = verdict_of(candidate.measures, params_.overlap);
            if (candidate.verdict == Verdict::accepted && !fits(pair.first, pair.second, candidate.motion))
                candidate.verdict = Verdict::misfit;
        }
        pair.result.settle(first.extent, resolution_);
    }

    /// Whether most points that have a partner at the resolution also lie on the other view's surface.
    bool fits(u32 a, u32 b, const RigidMotion& motion) const {
        const Agreement there = agreement(*surfaces_[a], *surfaces_[b], motion, resolution_, fitting_),
                        back = agreement(*surfaces_[b], *surfaces_[a], motion.inverse(), resolution_, fitting_);
        return static_cast<double>(there.close + back.close) >=
               least_agreement * static_cast<double>(there.points + back.points);
    }

    bool sight_contradicts(const PairMeasures& measures) const {
        return measures.overlap >= std::min(least_checked_overlap, params_.overlap) &&
               measures.front >
                   (measures.overlap < params_.overlap ? contradicting_front_of_little_overlap : contradicting_front);
    }
    /// Whether two views cannot both be where they are. `motion` leads from the frame of a to that of b.
    bool contradicts(u32 a, u32 b, const PairMeasures& measures, const RigidMotion& motion) const {
        return sight_contradicts(measures) || (measures.overlap >= params_.overlap && !fits(a, b, motion));
    }

    void choose_edges() {
        std::vector<ViewExtent> extents;
        for (const auto& view : reduced_) extents.push_back(view->extent);
        std::vector<GraphEdge> all;
        std::vector<std::size_t> pair_of_edge;
        for (std::size_t i = 0; i < pairs_.size(); ++i)
            if (const Edge& pair = pairs_[i]; pair.result.is_accepted()) {
                const Candidate& best = *pair.result.best();
                all.push_back({pair.first, pair.second, best.motion, best.measures.score(), pair.result.is_ambiguous});
                pair_of_edge.push_back(i);
            }
        const CheckedEdges checked = checked_by_triples(all, extents, same_pose * resolution_);
        for (std::size_t i = 0; i < all.size(); ++i)
            if (checked.is_kept[i]) edges_.push_back(all[i]), pair_of_edge_.push_back(pair_of_edge[i]);
    }

    /// Places the largest group of views. Returns false if a view was taken out because it contradicts the others.
    bool place() {
        execution_.check_cancelled();
        std::vector<GraphEdge> usable;
        for (const GraphEdge& edge : edges_)
            if (is_usable(edge.from) && is_usable(edge.to)) usable.push_back(edge);
        const SpanningTree tree = largest_tree(usable, views_.size());
        poses_.assign(views_.size(), std::nullopt);
        if (tree.edges.empty()) return true;
        poses_ = tree.poses;
        relax();
        if (const auto worst = most_contradicting(usable)) {
            refusal_[*worst] = ViewRefusal::contradicts;
            return false;
        }
        result.confidence = usable[tree.edges.back()].score;
        for (std::size_t e = 0; e < usable.size(); ++e) {
            if (!poses_[usable[e].from] || !poses_[usable[e].to]) continue;
            const std::size_t pair = pair_of_edge_[static_cast<std::size_t>(index_of(usable[e]))];
            accepted.push_back({usable[e].from, usable[e].to, usable[e].motion, pairs_[pair].result.best()->measures});
        }
        return true;
    }

    bool has_edge(u32 a, u32 b) const {
        return std::ranges::any_of(edges_, [&](const GraphEdge& e) { return e.from == a && e.to == b; });
    }
    bool is_usable(u32 view) const { return refusal_[view] == ViewRefusal::none; }
    std::size_t index_of(const GraphEdge& edge) const {
        const auto found =
            std::ranges::find_if(edges_, [&](const GraphEdge& e) { return e.from == edge.from && e.to == edge.to; });
        return static_cast<std::size_t>(found - edges_.begin());
    }

    RigidMotion relative(u32 a, u32 b) const { return poses_[a]->then(poses_[b]->inverse()); }

    void relax() {
        std::vector<u32> placed;
        for (u32 view = 0; view < views_.size(); ++view)
            if (poses_[view]) placed.push_back(view);
        std::vector<const ViewSurface*> surfaces;
        std::vector<RigidMotion> poses;
        for (const u32 view : placed) surfaces.push_back(surfaces_[view].get()), poses.push_back(*poses_[view]);
        std::vector<ViewPair> pairs;
        for (u32 a = 0; a < placed.size(); ++a)
            for (u32 b = a + 1; b < placed.size(); ++b)
                if (has_edge(placed[a], placed[b]) ||
                    measured(*reduced_[placed[a]], *reduced_[placed[b]], relative(placed[a], placed[b])).overlap >=
                        least_checked_overlap)
                    pairs.push_back({a, b});
        std::vector<RelaxationStage> stages;
        for (const RelaxationStage& stage : relaxation_stages)
            stages.push_back({stage.tolerance * resolution_, stage.most_rounds});
        stages.push_back({close_, last_rounds});
        const Relaxed relaxed = scanmill::relaxed(surfaces, std::move(poses), pairs, stages, settled_, execution_);

        for (std::size_t i = 0; i < placed.size(); ++i) poses_[placed[i]] = relaxed.poses[i];
        std::vector<Relaxed::Residual> of_view(views_.size());
        Relaxed::Residual all;
        const auto add = [](Relaxed::Residual& to, const Relaxed::Residual& more) {
            to.points += more.points;
            to.squares += more.squares;
        };
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            add(all, relaxed.residuals[i]);
            add(of_view[placed[pairs[i].first]], relaxed.residuals[i]);
            add(of_view[placed[pairs[i].second]], relaxed.residuals[i]);
        }
        const auto rms = [](const Relaxed::Residual& r) {
            return r.points == 0 ? 0 : std::sqrt(r.squares / static_cast<double>(r.points));
        };
        result.rms = rms(all);
        details.assign(views_.size(), {});
        for (std::size_t view = 0; view < views_.size(); ++view) details[view].residual = rms(of_view[view]);
    }

    /// The placed view with the most contradictions. Ties: the smaller sum of the scores of its edges, then the higher
    /// index.
    std::optional<u32> most_contradicting(std::span<const GraphEdge> usable) {
        std::vector<u32> contradictions(views_.size(), 0);
        for (u32 a = 0; a < views_.size(); ++a)
            for (u32 b = a + 1; b < views_.size(); ++b) {
                if (!poses_[a] || !poses_[b]) continue;
                const PairMeasures measures = measured(*reduced_[a], *reduced_[b], relative(a, b));
                for (const u32 view : {a, b}) details[view].overlap = std::max(details[view].overlap, measures.overlap);
                if (contradicts(a, b, measures, relative(a, b))) ++contradictions[a], ++contradictions[b];
            }
        std::vector<double> scores(views_.size(), 0);
        for (const GraphEdge& edge : usable) scores[edge.from] += edge.score, scores[edge.to] += edge.score;
        std::optional<u32> worst;
        for (u32 view = 0; view < views_.size(); ++view) {
            if (contradictions[view] == 0) continue;
            if (!worst || contradictions[view] > contradictions[*worst] ||
                (contradictions[view] == contradictions[*worst] && scores[view] <= scores[*worst]))
                worst = view;
        }
        return worst;
    }

    /// Sets the refusals of views without a pose and the measures of every view's best pair.
    void explain_refusals() {
        details.resize(views_.size());
        std::vector<const Edge*> best(views_.size(), nullptr);
        for (const Edge& pair : pairs_) {
            if (!pair.result.best()) continue;
            for (const u32 view : {pair.first, pair.second}) {
                const Edge* old = best[view];
                const auto rank = [](const Edge& e) {
                    return std::pair(e.result.is_accepted(), e.result.best()->measures.score());
                };
                if (!old || rank(pair) > rank(*old)) best[view] = &pair;
            }
        }
        for (u32 view = 0; view < views_.size(); ++view) {
            if (best[view]) {
                details[view].best = best[view]->result.best()->measures;
                details[view].best_with = best[view]->first == view ? best[view]->second : best[view]->first;
                if (best[view]->result.is_accepted()) details[view].confidence = details[view].best.score();
            }
            if (!poses_[view] && refusal_[view] == ViewRefusal::none) refusal_[view] = refusal_by(best[view], view);
        }
    }

    ViewRefusal refusal_by(const Edge* best, u32 view) const {
        if (!best) return ViewRefusal::no_overlap;
        switch (best->result.best()->verdict) {
            case Verdict::no_overlap: return ViewRefusal::no_overlap;
            case Verdict::slides: return ViewRefusal::slides;
            case Verdict::contradicts:
            case Verdict::missing:
            case Verdict::misfit: return ViewRefusal::contradicts;
            case Verdict::accepted: break;
        }
        const bool has_edge =
            std::ranges::any_of(edges_, [&](const GraphEdge& e) { return e.from == view || e.to == view; });
        if (has_edge) return ViewRefusal::apart;
        return best->result.is_ambiguous ? ViewRefusal::ambiguous : ViewRefusal::contradicts;
    }

    std::span<const ViewToRegister* const> views_;
    std::span<const std::unique_ptr<ViewSurface>> surfaces_;
    double resolution_;
    double close_;  ///< points of right poses are usually not farther from the other view's planes
    double fitting_ = 0;  ///< the same for the test of a pose
    double settled_;  ///< a smaller motion is none
    const RegisterViewsParams& params_;
    Execution& execution_;
    std::vector<std::unique_ptr<ReducedView>> reduced_;
    std::vector<ViewRefusal> refusal_;
    std::vector<Edge> pairs_;
    std::vector<GraphEdge> edges_;  ///< accepted, and not dropped by triples
    std::vector<std::size_t> pair_of_edge_;
    std::vector<std::optional<RigidMotion>> poses_;
};

/// The order of the views by content: number of points, then their coordinates.
std::vector<u32> order_of(std::span<const ViewToRegister> views) {
    std::vector<u32> order(views.size());
    std::iota(order.begin(), order.end(), 0);
    const auto compare = [&](u32 a, u32 b) {
        const std::span<const Vec3> one = views[a].points, other = views[b].points;
        if (one.size() != other.size()) return one.size() < other.size() ? -1 : 1;
        for (std::size_t i = 0; i < one.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                if (one[i][axis] != other[i][axis]) return one[i][axis] < other[i][axis] ? -1 : 1;
        return 0;
    };
    std::ranges::sort(order, [&](u32 a, u32 b) { return compare(a, b) < 0; });
    for (std::size_t i = 1; i < order.size(); ++i)
        if (compare(order[i - 1], order[i]) == 0) {
            const auto [a, b] = std::minmax(order[i - 1], order[i]);
            throw Error("the views '{}' and '{}' have the same {} points", views[a].name, views[b].name,
                        views[a].points.size())
                .hint("give every view once");
        }
    return order;
}

/// All views with the poses that they have.
RegisterViewsResult as_they_are(std::span<const ViewToRegister> views, double spacing, double resolution) {
    RegisterViewsResult result;
    result.kept_as_is = true;
    result.spacing = spacing, result.resolution = resolution;
    result.views.resize(views.size());
    for (std::size_t row = 0; row < views.size(); ++row)
        result.views[row].pose = views[row].start.value_or(RigidMotion());
    result.placed = views.size();
    return result;
}

}  // namespace

std::string_view name_of(ViewRefusal refusal) {
    switch (refusal) {
        case ViewRefusal::none: break;
        case ViewRefusal::small: return "small";
        case ViewRefusal::no_overlap: return "no-overlap";
        case ViewRefusal::slides: return "slides";
        case ViewRefusal::ambiguous: return "ambiguous";
        case ViewRefusal::contradicts: return "contradicts";
        case ViewRefusal::apart: return "apart";
    }
    return {};
}

RegisterViewsResult register_views(std::span<const ViewToRegister> views, const RegisterViewsParams& params,
                                   Execution& execution) {
    if (views.empty()) throw Error("there is no view to register").hint("give at least two views of one object");
    for (const ViewToRegister& view : views) require_surface(view.points, view.name);
    if (views.size() == 1) {
        RegisterViewsResult single;
        single.views.resize(1);
        single.views[0].pose = RigidMotion();
        single.placed = 1;
        return single;
    }
    const bool has_start =
        !params.as_is && std::ranges::all_of(views, [](const ViewToRegister& v) { return v.start.has_value(); });
    const auto is_large = [](const ViewToRegister& v) { return v.points.size() >= least_reduced_points; };
    const auto large = static_cast<std::size_t>(std::ranges::count_if(views, is_large));
    if (const std::size_t pairs = large * (large - (large > 0)) / 2; pairs > most_pairs && !has_start)
        throw Error("{} views are {} pairs; at most {} pairs can be searched", large, pairs, most_pairs)
            .hint("give `start` with rough poses, or register the views in groups");

    const std::vector<u32> order = order_of(views);
    std::vector<const ViewToRegister*> used;
    std::vector<u32> row_of_used;
    RegisterViewsResult result;
    result.views.resize(views.size());
    for (const u32 row : order)
        if (is_large(views[row]))
            used.push_back(&views[row]), row_of_used.push_back(row);
        else
            result.views[row].refusal = ViewRefusal::small;
    std::vector<double> sizes(views.size());
    for (std::size_t row = 0; row < views.size(); ++row) sizes[row] = extent_of(views[row].points).radius;
    if (used.empty()) return result;

    std::vector<double> spacings(used.size()), used_sizes;
    std::vector<std::unique_ptr<ViewSurface>> surfaces(used.size());
    for_each_chunk(execution.threads(), used.size(), 1, [&](std::size_t i, std::size_t) {
        execution.check_cancelled();
        const Vec3 to_scanner = used[i]->to_scanner.normalized();
        surfaces[i] =
            std::make_unique<ViewSurface>(used[i]->points, std::span(&to_scanner, 1), normal_neighbours, most_samples);
        spacings[i] = surfaces[i]->spacing();
    });
    for (const u32 row : row_of_used) used_sizes.push_back(sizes[row]);
    const double spacing = median(spacings), size = median(used_sizes);
    const double resolution =
        params.resolution.value_or(std::max(spacings_per_voxel * spacing, size / voxels_per_size));
    execution.progress(0.05);

    Registration registration(used, surfaces, spacing, resolution, params, execution);
    std::vector<std::optional<RigidMotion>> poses(views.size());
    std::vector<RigidMotion> given;
    if (params.as_is) {
        for (const ViewToRegister* view : used) given.push_back(view->start.value_or(RigidMotion()));
        const auto test = registration.tested(given);
        if (test.contradicting)
            result.contradicting = {row_of_used[test.contradicting->first], row_of_used[test.contradicting->second]};
        if (test.is_right()) return as_they_are(views, spacing, resolution);
    }
    registration.run();

    std::vector<RegisteredView> found = std::move(result.views);
    const auto contradicting = result.contradicting;
    result = std::move(registration.result);
    result.contradicting = contradicting;
    result.views = std::move(found);
    result.spacing = spacing, result.resolution = resolution;
    for (std::size_t i = 0; i < used.size(); ++i) {
        RegisteredView& view = result.views[row_of_used[i]];
        view = registration.details[i];
        view.refusal = registration.refusal(i);
        view.pose = registration.pose(i);
        if (view.best_with != ~u32(0)) view.best_with = row_of_used[view.best_with];
        result.placed += view.pose.has_value();
    }
    if (params.as_is && !contradicting && result.placed < views.size() && registration.confirms(given)) {
        result = as_they_are(views, spacing, resolution);
        result.is_unconnected = true;
        return result;
    }
    const auto first =
        std::ranges::find_if(result.views, [](const RegisteredView& view) { return view.pose.has_value(); });
    if (first != result.views.end()) {
        const RigidMotion to_first = first->pose->inverse();
        for (RegisteredView& view : result.views)
            if (view.pose) view.pose = &view == &*first ? RigidMotion() : orthonormal(view.pose->then(to_first));
    }
    for (RegisteredPair pair : registration.accepted) {
        pair.from = row_of_used[pair.from], pair.to = row_of_used[pair.to];
        if (pair.from > pair.to) {
            std::swap(pair.from, pair.to);
            pair.motion = pair.motion.inverse();
        }
        result.pairs.push_back(pair);
    }
    std::ranges::sort(result.pairs, {}, [](const RegisteredPair& pair) { return std::pair(pair.from, pair.to); });
    name_scales(result.views, sizes);
    return result;
}

}  // namespace scanmill
