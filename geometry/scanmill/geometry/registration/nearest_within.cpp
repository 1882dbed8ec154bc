// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/nearest_within.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace scanmill {

namespace {

/// Cells per reach. More cells have shorter lists, but take longer to fill.
constexpr double cells_per_reach = 2;
/// Outliers far away would need many empty cells: cells are enlarged until there are at most this many per point.
constexpr double most_cells_per_point = 1000;
/// Exceeds 1 by more than the rounding errors of distances and cells.
constexpr double slack = 1 + 0x1p-20;

}  // namespace

NearestWithin::NearestWithin(std::span<const Vec3> points, double reach)
    : points_(points.begin(), points.end()),
      box_(bounding_box(points)),
      edge_(reach / cells_per_reach) {
    assert(reach > 0);
    const double outer = reach * slack;
    if (points.empty()) box_.add(Vec3::Zero());
    box_.low.array() -= outer;
    box_.high.array() += outer;
    const double most_cells = most_cells_per_point * static_cast<double>(points.size() + 64);
    const auto count = [&](int axis) { return std::floor((box_.high - box_.low)[axis] / edge_) + 1; };
    while (count(0) * count(1) * count(2) > most_cells) edge_ *= 2;
    for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<std::size_t>(count(axis));

    // Calls action(cell, nearest, farthest): the squared distances of the point from the cell.
    const auto for_each_cell = [&](const Vec3& point, auto&& action) {
        std::size_t first[3], last[3];
        std::vector<std::array<double, 2>> squares[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double at = point[axis] - box_.low[axis];
            first[axis] = static_cast<std::size_t>(std::max(0.0, std::floor((at - outer) / edge_)));
            last[axis] = std::min(cells_[axis] - 1, static_cast<std::size_t>((at + outer) / edge_));
            for (std::size_t cell = first[axis]; cell <= last[axis]; ++cell) {
                const double below = static_cast<double>(cell) * edge_ - at, above = below + edge_;
                const double near = std::max(0.0, std::max(below, -above)), far = std::max(-below, above);
                squares[axis].push_back({near * near, far * far});
            }
        }
        for (std::size_t z = first[2]; z <= last[2]; ++z)
            for (std::size_t y = first[1]; y <= last[1]; ++y) {
                const auto &in_z = squares[2][z - first[2]], &in_y = squares[1][y - first[1]];
                const std::size_t row = (z * cells_[1] + y) * cells_[0];
                for (std::size_t x = first[0]; x <= last[0]; ++x) {
                    const auto& in_x = squares[0][x - first[0]];
                    action(row + x, in_x[0] + in_y[0] + in_z[0], in_x[1] + in_y[1] + in_z[1]);
                }
            }
    };
    // Points farther from the cell than this are nowhere in it the nearest one.
    Array<double> limit(cells_[0] * cells_[1] * cells_[2], outer * outer);
    for (const Vec3& point : points_)
        for_each_cell(point, [&](std::size_t cell, double, double farthest) {
            limit[cell] = std::min(limit[cell], farthest * slack);
        });
    begin_.assign(limit.size() + 1, 0);
    for (const Vec3& point : points_)
        for_each_cell(point,
                      [&](std::size_t cell, double nearest, double) { begin_[cell + 1] += nearest <= limit[cell]; });
    std::inclusive_scan(begin_.begin(), begin_.end(), begin_.begin());
    lists_.resize(begin_.back());
    Array<u32> next(begin_.begin(), begin_.end() - 1);
    for (u32 i = 0; i < points_.size(); ++i)
        for_each_cell(points_[i], [&](std::size_t cell, double nearest, double) {
            if (nearest <= limit[cell]) lists_[next[cell]++] = i;
        });
}

u32 NearestWithin::nearest(const Vec3& position, double distance) const {
    const Vec3 at = (position - box_.low) / edge_;
    if (!((position.array() >= box_.low.array()).all() && (position.array() <= box_.high.array()).all())) return none;
    const auto cell_of = [&](int axis) { return std::min(static_cast<std::size_t>(at[axis]), cells_[axis] - 1); };
    const std::size_t cell = (cell_of(2) * cells_[1] + cell_of(1)) * cells_[0] + cell_of(0);
    u32 best = none;
    double least = distance * distance;
    for (u32 slot = begin_[cell]; slot < begin_[cell + 1]; ++slot) {
        const double squared = (points_[lists_[slot]] - position).squaredNorm();
        if (squared < least) least = squared, best = lists_[slot];
    }
    return best;
}

}  // namespace scanmill
