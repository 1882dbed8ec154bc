// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/points.hpp"
#include "scanmill/base/text.hpp"

#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill {

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
        .hint("remove them from the file")
        .remedy(Remedy::drop_invalid_points);
}

Array<u32> finite_rows(std::span<const Vec3> positions) {
    Array<u32> rows;
    rows.reserve(positions.size());
    for (u32 row = 0; row < positions.size(); ++row)
        if (positions[row].allFinite()) rows.push_back(row);
    return rows;
}

Cleaned<PointCloud> without_invalid_points(const PointCloud& cloud) {
    const Array<u32> rows = finite_rows(cloud.positions.span());
    if (rows.size() == cloud.size()) return {cloud, 0, 0};
    return {gather(cloud, rows), cloud.size() - rows.size(), 0};
}

Buffer<Vec3> translated(const Buffer<Vec3>& positions, const Vec3& shift) {
    Array<Vec3> moved(positions.size());
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = positions[i] + shift;
    return moved;
}

}  // namespace scanmill
