// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/points.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill {

PointCloud gather(const PointCloud& cloud, std::span<const u32> rows) {
    return {cloud.frame, gather(cloud.positions, rows), cloud.columns.gather(rows)};
}

namespace {

void require_finite(std::span<const Vec3> positions, std::string_view what, Remedy remedy) {
    std::size_t bad = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (!positions[i].allFinite() && bad++ == 0) first = i;
    if (bad == 0) return;
    const Vec3& p = positions[first];
    const int axis = !std::isfinite(p.x()) ? 0 : !std::isfinite(p.y()) ? 1 : 2;
    throw Error("needs finite coordinates; {} of {} {} {} a NaN or an infinity, the first is number {} ({} is {})", bad,
                positions.size(), what, by_count(bad, "has", "have"), first, "xyz"[axis], p[axis])
        .hint("remove them from the file")
        .remedy(remedy);
}

}  // namespace

void require_finite(std::span<const Vec3> positions, std::string_view what) {
    require_finite(positions, what, Remedy::drop_invalid_points);
}

Array<u32> finite_rows(std::span<const Vec3> positions) {
    Array<u32> rows;
    rows.reserve(positions.size());
    for (u32 row = 0; row < positions.size(); ++row)
        if (positions[row].allFinite()) rows.push_back(row);
    return rows;
}

namespace {

/// In a scan that is too long, a row is invalid if it is farther than this from the median along an axis.
constexpr double farthest = largest_side / 2;

/// The lower median along every axis. Pre: at least one position is finite.
Vec3 median_of(std::span<const Vec3> positions) {
    Vec3 median;
    Array<double> coordinates;
    for (int axis = 0; axis < 3; ++axis) {
        coordinates.clear();
        for (const Vec3& p : positions)
            if (p.allFinite()) coordinates.push_back(p[axis]);
        median[axis] = quantile(coordinates, 0.5);
    }
    return median;
}

bool is_near(const Vec3& position, const Vec3& median) { return ((position - median).array().abs() <= farthest).all(); }

/// Throws Error with the number of invalid rows and the first of them. Pre: all rows are finite; at least one is
/// invalid.
[[noreturn]] void refuse_far_rows(const PointCloud& cloud, std::span<const u32> valid) {
    u32 first = 0;
    while (first < valid.size() && valid[first] == first) ++first;
    const Vec3 world = cloud.positions[first] + cloud.frame.origin;
    throw Error(
        "{} of {} points {} farther than {:g} u from the median of all, the first is number {} at ({}, {}, {}); "
        "two points may be at most {:g} u apart",
        cloud.size() - valid.size(), cloud.size(), by_count(cloud.size() - valid.size(), "lies", "lie"), farthest,
        first, number_text(world.x()), number_text(world.y()), number_text(world.z()), largest_side)
        .hint("remove them from the file")
        .remedy(Remedy::drop_invalid_rows);
}

/// Throws Error for a scan that is too long because of many far rows rather than a few stray rows.
void refuse_length(const BoundingBox& box, std::size_t far, std::size_t finite) {
    try {
        require_supported_range(box);
    } catch (const Error& error) {
        throw error.reworded(fmt::format("{}; {} of {} points lie farther than {:g} u from the median of all",
                                         error.sentence(), far, finite, farthest));
    }
}

}  // namespace

Array<u32> valid_rows(std::span<const Vec3> positions) {
    Array<u32> rows = finite_rows(positions);
    const BoundingBox box = bounding_box(positions);
    if (!is_too_long(box)) return rows;
    const Vec3 median = median_of(positions);
    const std::size_t finite = rows.size();
    std::erase_if(rows, [&](u32 row) { return !is_near(positions[row], median); });
    if (rows.size() <= finite / 2) refuse_length(box, finite - rows.size(), finite);
    return rows;
}

std::string_view name_of(InvalidRows rule) {
    switch (rule) {
        case InvalidRows::by_format: return "";
        case InvalidRows::refuse: return "refuse";
        case InvalidRows::drop: return "drop";
    }
    return "";
}

std::optional<InvalidRows> invalid_rows_named(std::string_view name) {
    for (const InvalidRows rule : {InvalidRows::refuse, InvalidRows::drop})
        if (name == name_of(rule)) return rule;
    return std::nullopt;
}

Cleaned<PointCloud> without_invalid_points(const PointCloud& cloud) {
    const Array<u32> rows = valid_rows(cloud.positions.span());
    if (rows.size() == cloud.size()) return {cloud, 0, 0};
    if (rows.empty())
        throw Error("{} a NaN or an infinity; no point is left",
                    cloud.size() == 1 ? "the only point has" : fmt::format("all {} points have", cloud.size()))
            .hint("export the scan again");
    return {gather(cloud, rows), cloud.size() - rows.size(), 0};
}

Cleaned<PointCloud> accepted(const PointCloud& cloud, InvalidRows rule, bool nan_is_no_return) {
    Cleaned<PointCloud> result{cloud};
    const FiniteBounds bounds = finite_bounds(cloud.positions.span());
    if (!bounds.finite || is_too_long(bounds.box)) {
        if (rule == InvalidRows::drop || (rule == InvalidRows::by_format && nan_is_no_return)) {
            result = without_invalid_points(cloud);
        } else {
            if (!bounds.finite) require_finite(cloud.positions.span(), "points", Remedy::drop_invalid_rows);
            if (const Array<u32> valid = valid_rows(cloud.positions.span()); valid.size() < cloud.size())
                refuse_far_rows(cloud, valid);
        }
    }
    require_supported_range(bounding_box(result.result.positions.span()));
    return result;
}

Buffer<Vec3> translated(const Buffer<Vec3>& positions, const Vec3& shift) {
    if (shift.isZero(0)) return positions;
    Array<Vec3> moved(positions.size());
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = positions[i] + shift;
    return moved;
}

}  // namespace scanmill
