// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <vector>

#include "merge/merge_steps.hpp"
#include "scanmill/geometry/spatial/cell_grid.hpp"

namespace scanmill::merging {

namespace {

/// A growing set of points, with a test whether a point of another source is within a fixed distance.
///
/// The points of a grid cell are grouped by source, so the test takes no time for points of the same source.
class SourceGrid {
public:
    /// The set is empty at first. `positions` and `source` must outlive it. Pre: within > 0.
    SourceGrid(std::span<const Vec3> positions, std::span<const u32> source, double within)
        : positions_(positions),
          source_(source),
          squared_distance_(within * within),
          grid_(bounding_box(positions), within),
          next_row_(positions.size()) {}

    void insert(u32 row) {
        const u32 cell = grid_.enter(positions_[row]);
        if (cell == first_group_.size()) first_group_.push_back(none);
        u32 group = first_group_[cell];
        while (group != none && groups_[group].source != source_[row]) group = groups_[group].next_group;
        if (group == none) {
            group = static_cast<u32>(groups_.size());
            groups_.push_back({source_[row], none, first_group_[cell]});
            first_group_[cell] = group;
        }
        next_row_[row] = groups_[group].first_row;
        groups_[group].first_row = row;
    }

    /// Whether the set contains a point of another source at a squared distance of at most within² from the point
    /// `row`.
    bool has_foreign_neighbour(u32 row) const {
        const Vec3& point = positions_[row];
        return grid_.any_near(point, [&](u32 cell) {
            for (u32 group = first_group_[cell]; group != none; group = groups_[group].next_group) {
                if (groups_[group].source == source_[row]) continue;
                for (u32 other = groups_[group].first_row; other != none; other = next_row_[other])
                    if ((positions_[other] - point).squaredNorm() <= squared_distance_) return true;
            }
            return false;
        });
    }

private:
    static constexpr u32 none = ~u32(0);
    /// The points of one source in one cell, chained through next_row_.
    struct Group {
        u32 source, first_row, next_group;
    };

    std::span<const Vec3> positions_;
    std::span<const u32> source_;
    double squared_distance_;
    CellGrid grid_;
    std::vector<u32> first_group_;  ///< by cell
    std::vector<Group> groups_;
    Array<u32> next_row_;
};

}  // namespace

Array<u32> without_overlap(std::span<const Vec3> positions, std::span<const u32> source,
                           std::span<const double> preference, double within, Context& context) {
    Array<u32> rows(positions.size());
    std::iota(rows.begin(), rows.end(), u32(0));
    if (within == 0) {
        if (!preference.empty()) context.warn("lower-uncertainty has no effect while `within` is 0");
        return rows;
    }
    if (!preference.empty()) std::ranges::stable_sort(rows, {}, [&](u32 row) { return preference[row]; });

    SourceGrid kept(positions, source, within);
    constexpr std::size_t rows_per_report = 1 << 16;
    std::size_t visited = 0;
    std::erase_if(rows, [&](u32 row) {
        if (visited++ % rows_per_report == 0) {
            context.check_cancelled();
            context.progress(static_cast<double>(visited) / static_cast<double>(positions.size()));
        }
        if (kept.has_foreign_neighbour(row)) return true;
        kept.insert(row);
        return false;
    });
    std::ranges::sort(rows);
    return rows;
}

}  // namespace scanmill::merging
