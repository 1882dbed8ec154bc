// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/misplaced_views.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scanmill/base/statistics.hpp"
#include "scanmill/geometry/registration/rigid_motion.hpp"

namespace scanmill {

namespace {

constexpr std::size_t samples = 200;  ///< per view
constexpr int rounds = 3;
constexpr double least_spacings = 0.5, least_ratio = 3;

/// Points of a view where it was found, and where its pose puts them.
struct Placed {
    u32 view;
    std::vector<Vec3> found, given;

    double distance(const RigidMotion& motion) const {
        double squares = 0;
        for (std::size_t i = 0; i < found.size(); ++i) squares += (motion.apply(found[i]) - given[i]).squaredNorm();
        return std::sqrt(squares / static_cast<double>(found.size()));
    }
};

RigidMotion motion_of(std::span<const Placed> views) {
    std::vector<Vec3> from, to;
    for (const Placed& view : views) {
        from.insert(from.end(), view.found.begin(), view.found.end());
        to.insert(to.end(), view.given.begin(), view.given.end());
    }
    return fitted_motion(from, to);
}

}  // namespace

std::vector<MisplacedView> misplaced_views(std::span<const ViewToRegister> views, RegisterViewsParams params,
                                           double& spacing, Execution& execution) {
    params.as_is = false;
    const RegisterViewsResult refined = register_views(views, params, execution);
    spacing = refined.spacing;
    std::vector<Placed> placed;
    std::vector<MisplacedView> result;
    for (u32 i = 0; i < views.size(); ++i) {
        if (refined.views[i].refusal == ViewRefusal::contradicts) result.push_back({i, {}});
        if (!refined.views[i].pose) continue;
        Placed& view = placed.emplace_back(Placed{i, {}, {}});
        const std::span<const Vec3> points = views[i].points;
        for (std::size_t row = 0; row < points.size(); row += points.size() / samples + 1) {
            view.found.push_back(refined.views[i].pose->apply(points[row]));
            view.given.push_back(views[i].start->apply(points[row]));
        }
    }
    if (placed.size() < 3) return result;  // two views do not show which one is wrong
    RigidMotion motion = motion_of(placed);
    for (int round = 0; round < rounds; ++round) {
        std::ranges::stable_sort(placed, {}, [&](const Placed& view) { return view.distance(motion); });
        motion = motion_of(std::span(placed).first(placed.size() / 2 + 1));
    }
    std::vector<double> distances;
    for (const Placed& view : placed) distances.push_back(view.distance(motion));
    const double limit = std::max(least_spacings * spacing, least_ratio * median(distances));
    for (const Placed& view : placed)
        if (const double distance = view.distance(motion); distance > limit) result.push_back({view.view, distance});
    std::ranges::sort(result, {}, &MisplacedView::view);
    return result;
}

}  // namespace scanmill
