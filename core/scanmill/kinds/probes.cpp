// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `probes`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "machine",
///      "radius": 2, "scanner-error": 1, "clearance": 2, "stylus-radius": 1.2, "stylus-length": 40,
///      "machine-axis": [0, 0, 1], "dmis": {"header": null, "goto": "cart", "decimals": 6},
///      "touches": [{"touch": 0, "feature": 3, "point": [0, 0, 0], "tangent": [0, 1, 0], "left-normal": [0, 0, 1],
///                   "right-normal": [1, 0, 0], "interior-angle": 1.57, "assumed": false, "phi-min": -0.26,
///                   "phi-max": 0.26, "phi-known-min": null, "phi-known-max": null, "phi": 0,
///                   "approach": [0.7, 0, 0.7], "start": [8, 0, 8], "centre": [1.4, 0, 1.4], "reason": "none",
///                   "false-share": 0, "contact": "edge", "contact-distance": 0.1, "order": 0}, …],
///      "moves": [{"type": "clearance", "touch": 0, "points": [[8, 0, 20], [8, 0, 8]]}, …]}
///
/// Points are world coordinates, angles radians. `reason` is none, concave, too-narrow, too-tilted or obstructed;
/// `contact` is none, edge, elsewhere or missed; `type` is clearance, approach or retract; `touch` of a move is a row
/// of `touches`. Undefined values are null: a range without directions, and the direction and the order of a touch that
/// is not made. `dmis` is absent if a DMIS program of the plan has the default header, plain moves and as many decimals
/// as the radius needs; `header` and `decimals` are null for these defaults. `unit` and `frame` are null if unknown.
/// Numbers are read back bit for bit.
#include "scanmill/data/probes.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

/// Throws Error if a move's touch does not exist.
void require_consistent(const ProbePlan& plan) {
    for (std::size_t row = 0; row < plan.moves.size(); ++row)
        if (const u32 touch = plan.moves[row].touch; touch >= plan.touches.size())
            throw Error("move {} names touch {}; there are {}", row, touch, plan.touches.size());
}

Array<Vec3> touch_points(const ProbePlan& plan) {
    Array<Vec3> points;
    for (const ProbeTouch& touch : plan.touches) points.push_back(touch.position);
    return points;
}

}  // namespace

template <>
struct KindTraits<ProbePlan> : HasDocument<ProbePlan, ProbePlan> {
    static constexpr std::string_view name = "probes";
    static constexpr bool is_geometric = true;
    /// The box of the reference points.
    static RobustBox box(const ProbePlan& plan) { return bounding_box(touch_points(plan)); }
    static double spacing(const ProbePlan& plan) { return point_spacing(touch_points(plan)); }

    static std::vector<PropertySpec> property_specs() {
        return {{"touches", Unit::count, "Touches, including those that are not made."},
                {"unreachable", Unit::count, "Touches that are not made.", Better::smaller}};
    }
    static std::vector<std::optional<double>> property_values(const ProbePlan& plan) {
        return {plan.touches.size(),
                std::ranges::count_if(plan.touches, [](const ProbeTouch& t) { return !t.is_made(); })};
    }
    static void require_usable(const ProbePlan& plan) {
        require_consistent(plan);
        if (plan.touches.empty()) throw Error("the result has no touches");
    }

    static constexpr std::string_view json_member = "touches";
    static const ProbePlan& document(const ProbePlan& plan) { return plan; }
    static ProbePlan object(ProbePlan plan) {
        require_consistent(plan);
        for (ProbeTouch& touch : plan.touches)
            if (!touch.is_made()) touch.start = touch.centre = touch.position;
        return plan;
    }
};

template Kind kind_of<ProbePlan>();

}  // namespace scanmill
