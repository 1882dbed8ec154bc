// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/points.hpp"
#include "scanmill/filter/counted.hpp"

#include <cmath>

#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

/// The smallest power of two that is not below `value`, a positive number. Exact, unlike the C library's log2, whose
/// last bit depends on the processor.
double power_of_two_from(double value) {
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);
    return std::ldexp(1.0, fraction == 0.5 ? exponent - 1 : exponent);
}

}  // namespace

PointCloud gather(const PointCloud& cloud, std::span<const u32> rows) {
    return {cloud.frame, gather(cloud.positions, rows), cloud.columns.gather(rows)};
}

void require_finite(std::span<const Vec3> positions, std::string_view what) {
    std::size_t bad = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (!positions[i].allFinite() && bad++ == 0) first = i;
    if (bad == 0) return;
    const Vec3& p = positions[first];
    const int axis = !std::isfinite(p.x()) ? 0 : !std::isfinite(p.y()) ? 1 : 2;
    throw Error("needs finite coordinates; {} of {} {} {} a NaN or an infinity, the first is number {} ({} is {})", bad,
                positions.size(), what, by_count(bad, "has", "have"), first, "xyz"[axis], p[axis])
        .hint("'scanmill convert --drop-invalid IN OUT' writes a copy without them");
}

BoundingBox bounding_box(std::span<const Vec3> positions) {
    BoundingBox box;
    for (const Vec3& p : positions) {
        if (!p.allFinite()) continue;
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
    }
    return box;
}

Vec3 distant_origin(const BoundingBox& box) {
    Vec3 origin = Vec3::Zero();
    const double diagonal = box.diagonal();
    if (box.empty() || !box.low.allFinite() || !box.high.allFinite() || !std::isfinite(diagonal)) return origin;
    constexpr double far = 16;  // diagonals away from zero; nearer, doubles have bits to spare
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = 0.5 * box.low[axis] + 0.5 * box.high[axis];
        if (!(std::abs(middle) > far * diagonal)) continue;
        // A multiple of a power of two at least as coarse as any coordinate's last bit: the difference of two such
        // numbers that lie this close together has a short mantissa, so no bit is lost.
        // Not below the normal numbers: a step of zero would make the origin NaN.
        const double last_bit = std::max(std::ldexp(std::abs(middle), -50), std::numeric_limits<double>::min());
        const double step = power_of_two_from(std::max(diagonal, last_bit));
        origin[axis] = std::round(middle / step) * step;
    }
    return origin;
}

Buffer<Vec3> translated(const Buffer<Vec3>& positions, const Vec3& shift) {
    Array<Vec3> moved(positions.size());
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = positions[i] + shift;
    return moved;
}

}  // namespace scanmill
