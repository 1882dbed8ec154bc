// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/distinct_points.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/data/points.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill::growing {

namespace {

/// Sorts the points of each cell of the Morton curve by position; spatial_order() sorts them by row.
void order_within_cells(std::span<const Vec3> positions, const BoundingBox& box, Array<u32>& order) {
    constexpr double steps = (1 << 21) - 1;
    const double extent = (box.high - box.low).maxCoeff();
    const auto share_cell = [&](u32 a, u32 b) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto cell = [&](u32 row) {
                return extent > 0 ? std::floor((positions[row][axis] - box.low[axis]) / extent * steps) : 0;
            };
            if (cell(a) != cell(b)) return false;
        }
        return true;
    };
    for (std::size_t begin = 0; begin < order.size();) {
        std::size_t end = begin + 1;
        while (end < order.size() && share_cell(order[begin], order[end])) ++end;
        if (end - begin > 1)
            std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin),
                      order.begin() + static_cast<std::ptrdiff_t>(end), [&](u32 a, u32 b) {
                          return positions[a] != positions[b] ? is_lower(positions[a], positions[b]) : a < b;
                      });
        begin = end;
    }
}

constexpr std::size_t most_neighbours = 16;

}  // namespace

DistinctPoints distinct_points_of(std::span<const Vec3> positions) {
    DistinctPoints points;
    Array<u32> order = spatial_order(positions);
    order_within_cells(positions, bounding_box(positions), order);

    points.positions.reserve(order.size());
    points.rows.reserve(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && positions[order[i]] == positions[order[i - 1]]) {
            points.repeats.push_back({static_cast<u32>(points.rows.size() - 1), order[i]});
            continue;
        }
        points.positions.push_back(positions[order[i]]);
        points.rows.push_back(order[i]);
    }
    return points;
}

void require_area(const DistinctPoints& points, std::size_t rows) {
    constexpr const char* hint = "check the file with `scanmill info`; use smaller voxels if the scan was thinned";
    if (rows == 0) throw Error("needs at least 3 distinct points; the cloud has none").hint(hint);
    if (points.size() < 3)
        throw Error("needs at least 3 distinct points; the cloud has {} in {} rows", points.size(), rows).hint(hint);
    // Finds the point farthest from the first point, then the point farthest from the line through these two.
    const auto& p = points.positions;
    const auto farthest = [&](const auto& distance) { return *std::ranges::max_element(p, {}, distance); };
    const Vec3 end = farthest([&](const Vec3& x) { return (x - p[0]).squaredNorm(); });
    const Vec3 along = (end - p[0]).normalized();
    const auto off_line = [&](const Vec3& x) { return (x - p[0]).cross(along).norm(); };
    const double off = off_line(farthest(off_line));
    if (off <= 1e-9 * (end - p[0]).norm())
        throw Error("all {} distinct points lie on one line, to within {:.2g} u; a surface needs points off that line",
                    points.size(), off)
            .hint("scan more than a single profile, or check which columns are read as x, y and z");
}

Neighbourhoods::Neighbourhoods(const DistinctPoints& points, unsigned threads)
    : tree_(points.positions, threads),
      count_(std::min(most_neighbours, points.size() - 1)),
      point_of_tree_index_(points.size()),
      nearest_(points.size() * count_),
      squared_reach_(points.size()) {
    const auto tree_indices = tree_.index_of_row();
    for (u32 point = 0; point < tree_indices.size(); ++point) point_of_tree_index_[tree_indices[point]] = point;
    const bool all = count_ + 1 == points.size();
    tree_.for_each_nearest(count_, threads, [&](const NeighbourBatch& batch) {
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 point = point_of_tree_index_[batch.indices[i]];
            u32* nearest = nearest_.data() + point * count_;
            for (const Neighbour& neighbour : batch.of(i)) *nearest++ = point_of_tree_index_[neighbour.index];
            squared_reach_[point] = all ? std::numeric_limits<double>::infinity() : batch.of(i).back().squared;
        }
    });
}

void Neighbourhoods::within(u32 point, double squared, NeighbourBuffer& buffer, std::vector<u32>& found) const {
    for (const Neighbour& neighbour : tree_.within(tree_.index_of_row()[point], squared, buffer))
        found.push_back(point_of_tree_index_[neighbour.index]);
}

}  // namespace scanmill::growing
