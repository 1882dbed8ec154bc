// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One pose per view for views of one object without poses.
///
/// Source: Rusu, Blodow and Beetz 2009 (descriptors); Chen, Sun, Yang and Tao 2022 (consensus); Chen and Medioni 1992
/// (refinement); Huber and Hebert 2003 for the graph of views and the lines of sight.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "register/pair_of_views.hpp"
#include "scanmill/base/execution.hpp"

namespace scanmill {

struct RegisterViewsParams {
    /// The least share of points with a partner in a pair of views, above 0.
    double overlap = 0.3;
    /// Edge of the voxels to which views are reduced. If absent, 4 spacings or L / 10.5, whichever is larger; L is the
    /// median of the root mean square distances of a view's points from their centroid.
    std::optional<double> resolution;
    /// Number of hypotheses that are refined per pair, at least 1.
    u32 seed_tries = 20;
    /// Whether every view shows the whole side of the object that faces its scanner. If not, parts outside the convex
    /// outline of a view are no evidence against a pose.
    bool whole_views = true;
    /// The poses of the views (`start`, or the identity) are tested as they are. If no lines of sight contradict them
    /// and pairs that overlap and do not slide connect all views, they are kept bit for bit; otherwise the views are
    /// registered without them. If that refuses a view, and neither a line of sight nor an accepted pair contradicts
    /// the poses, they are kept after all.
    bool as_is = false;
};

struct ViewToRegister {
    std::string name;
    std::span<const Vec3> points;
    /// Any vector from the view to its scanner in the view's frame, not zero.
    Vec3 to_scanner = Vec3::UnitZ();
    /// A pose to begin with. Pairs of views with poses are not searched, only refined and tested.
    std::optional<RigidMotion> start;
};

enum class ViewRefusal {
    none,
    small,  ///< too few points at the resolution
    no_overlap,  ///< no pair overlaps enough
    slides,  ///< the surfaces that it shares with others do not determine its pose
    ambiguous,  ///< two poses are equally good
    contradicts,  ///< lines of sight contradict its pose
    apart  ///< overlaps only with views that do not belong to the largest group
};
/// "small", "no-overlap", "slides", …; empty for `none`.
std::string_view name_of(ViewRefusal refusal);

struct RegisteredView {
    /// From the view's frame to the frame of the first placed view; absent if the view is refused.
    std::optional<RigidMotion> pose;
    ViewRefusal refusal = ViewRefusal::none;
    /// The measures of the best pair, accepted or not; all zero without a candidate.
    registration::PairMeasures best;
    /// The other view of that pair, or ~0.
    u32 best_with = ~u32(0);
    double overlap = 0;  ///< largest share over the pairs of placed views
    double residual = 0;  ///< root mean square distance from the planes of the other views
    double confidence = 0;  ///< largest score of the accepted pairs
    /// For refused views: the ratio of this view's size to the others', if two units of length would explain it, and
    /// these units as text.
    std::optional<double> scale;
    std::string units;
};

/// An accepted pair of views. Both have poses.
struct RegisteredPair {
    u32 from, to;  ///< views, in the caller's order, from < to
    RigidMotion motion;  ///< before the relaxation
    registration::PairMeasures measures;
};

struct RegisterViewsResult {
    std::vector<RegisteredView> views;  ///< in the caller's order
    std::vector<RegisteredPair> pairs;
    std::size_t placed = 0;
    double spacing = 0, resolution = 0;
    double rms = 0;  ///< root mean square distance from the planes of the other views, over all placed pairs
    double confidence = 0;  ///< the smallest score in the tree
    /// With `as_is`: whether the poses were kept; otherwise the first pair that contradicts them, or none if the views
    /// are not connected.
    bool kept_as_is = false;
    std::optional<std::pair<u32, u32>> contradicting;
    /// The poses were kept because nothing contradicts them, but overlapping pairs do not connect all views.
    bool is_unconnected = false;
};

/// Registers the views. A view that cannot be placed surely is refused with a reason; it does not stop the others.
///
/// Pre:  finite `overlap`; equal units of all views.
/// Post: poses map into the frame of the first placed view, whose pose is the identity. If no two views can be placed,
///       all are refused. One view alone gets the identity.
///       Throws Error with the name of the view for: no view; a view without points, with fewer than 3 points, with
///       NaN, with all points equal or on a line; two views with the same points; too many pairs without start poses.
/// Ties: views are processed in the order of their number of points, then of their coordinates; lower views win ties.
/// Determinism: bytes do not depend on the number of threads. For another order of the views, relative poses differ
/// only
///       by the rounding of the last product.
/// Cost: about 0.1 s per pair of views, and 10 us per point.
RegisterViewsResult register_views(std::span<const ViewToRegister> views, const RegisterViewsParams& params,
                                   Execution& execution);

}  // namespace scanmill
