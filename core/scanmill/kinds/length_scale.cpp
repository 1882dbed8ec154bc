// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/length_scale.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/point_stream.hpp"

namespace scanmill {

namespace {

/// The diagonal of `box`, the box of `points` points. Throws Error if it is 0.
double usable_diagonal(const RobustBox& box, std::size_t points, const Frame& frame, const OnWarning& on_stray) {
    const double diagonal = box.diagonal();
    if (!(diagonal > 0))
        throw Error("%diag is not defined here: the diagonal is 0, because {} at one position",
                    points == 1         ? "the only point is"
                    : box.stray.empty() ? fmt::format("all {} points are", points)
                                        : fmt::format("{} of {} points are", points - box.stray.size(), points))
            .hint("give a length instead, for example 0.5 u");
    if (!box.stray.empty() && on_stray) on_stray(stray_warning(box, frame));
    return diagonal;
}

double diagonal_of(const Value& value, const OnWarning& on_stray) {
    const Buffer<Vec3> positions = positions_of(value);
    if (positions.empty()) return 0;
    const RobustBox box = value.kind().info().box(value.object());
    if (!(box.diagonal() > 0)) require_finite(positions.span());
    return usable_diagonal(box, positions.size(), frame_of(value).value_or(Frame{}), on_stray);
}

double spacing_of(const Value& value) {
    const double spacing = value.kind().info().spacing(value.object());
    if (!(spacing > 0)) require_finite(positions_of(value).span());
    return spacing;
}

/// Returns a function that calls `compute` at most once. Copies of the function share the result.
std::function<double()> memoised(std::function<double()> compute) {
    return [memo = std::make_shared<std::optional<double>>(), compute = std::move(compute)] {
        if (!*memo) *memo = compute();
        return **memo;
    };
}

LengthScale scale_beside(const std::shared_ptr<const Metrics>& metrics) {
    return {metrics->unit,
            [metrics] {
                const Metric* diagonal = metrics->find("diagonal");
                if (!diagonal)
                    throw Error("%diag is not defined here: there is no metric `diagonal` with the size of the object")
                        .hint("give the length in a unit, or in u");
                return diagonal->value;
            },
            []() -> double {
                throw Error("spacing is not defined for metrics").hint("give the length in a unit, in u or in %diag");
            }};
}

}  // namespace

LengthScale length_scale(const PointStream& scan, const OnWarning& on_stray) {
    return {scan.frame().unit,
            memoised([box = scan.robust_box(), points = scan.size(), frame = scan.frame(), on_stray] {
                return usable_diagonal(box, points, frame, on_stray);
            }),
            []() -> double { throw Error("spacing needs all points at once, which a stream does not have"); }};
}

LengthScale length_scale(const Value& value, const OnWarning& on_stray) {
    if (value.find<Metrics>()) return scale_beside(value.get<Metrics>());
    const std::optional<Frame> frame = frame_of(value);
    return {frame ? frame->unit : LengthUnit::unknown, memoised([=] { return diagonal_of(value, on_stray); }),
            memoised([value] { return spacing_of(value); })};
}

std::string stray_warning(const RobustBox& box, const Frame& frame) {
    constexpr std::size_t shown = 3;
    const std::size_t count = box.stray.size();
    std::string points;
    for (std::size_t i = 0; i < std::min(count, shown); ++i) {
        const Vec3 world = box.stray[i].position + frame.origin;
        points += fmt::format("{}number {} at ({:.10g}, {:.10g}, {:.10g})", i > 0 ? ", " : "", box.stray[i].row,
                              world.x(), world.y(), world.z());
    }
    if (count > shown) points += fmt::format(" and {} more", count - shown);
    return fmt::format(
        "%diag is {:.6g} u, the diagonal of the box without {}, instead of {:.6g} u with {} ({}); remove {} if {} not "
        "part of the object",
        box.robust.diagonal(), count_text(count, "stray point", "stray points"), box.all.diagonal(),
        by_count(count, "it", "them"), points, by_count(count, "it", "them"), by_count(count, "it is", "they are"));
}

}  // namespace scanmill
