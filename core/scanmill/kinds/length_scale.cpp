// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/length_scale.hpp"

#include <fmt/format.h>

#include "scanmill/base/error.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/point_stream.hpp"

namespace scanmill {

namespace {

/// The diagonal of `box`, the box of `points` points. Throws Error if it is 0.
double usable_diagonal(const BoundingBox& box, std::size_t points) {
    const double diagonal = box.diagonal();
    if (!(diagonal > 0))
        throw Error("%diag is not defined here: the diagonal is 0, because {} at one position",
                    points == 1 ? "the only point is" : fmt::format("all {} points are", points))
            .hint("give a length instead, as 0.5 u");
    return diagonal;
}

double diagonal_of(const Value& value) {
    const Buffer<Vec3> positions = positions_of(value);
    if (positions.empty()) return 0;
    const BoundingBox box = value.kind().info().box(value.object());
    if (!(box.diagonal() > 0)) require_finite(positions.span());
    return usable_diagonal(box, positions.size());
}

double spacing_of(const Value& value) {
    const double spacing = value.kind().info().spacing(value.object());
    if (!(spacing > 0)) require_finite(positions_of(value).span());
    return spacing;
}

/// Computes at most once, also if it is copied.
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

LengthScale length_scale(const PointStream& scan) {
    return {scan.frame().unit, [box = scan.bounds(), points = scan.size()] { return usable_diagonal(box, points); },
            []() -> double { throw Error("spacing needs all points at once, which a stream does not have"); }};
}

LengthScale length_scale(const Value& value) {
    if (value.find<Metrics>()) return scale_beside(value.get<Metrics>());
    const std::optional<Frame> frame = frame_of(value);
    return {frame ? frame->unit : LengthUnit::unknown, memoised([value] { return diagonal_of(value); }),
            memoised([value] { return spacing_of(value); })};
}

}  // namespace scanmill
