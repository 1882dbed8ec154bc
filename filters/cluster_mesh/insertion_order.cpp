// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster_mesh/insertion_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace scanmill::clustering {

namespace {

/// The points, slice after slice; within a slice in ascending order. `begins` contains the start of each slice, and the
/// end.
struct Slices {
    Array<u32> points;
    std::vector<std::size_t> begins;
};

Slices sort_by_slice(std::span<const u32> slices) {
    Slices sorted;
    const std::size_t count = std::size_t(*std::ranges::max_element(slices)) + 1;
    if (count > 4 * slices.size() + 1024) {  // mostly empty slices: sort instead of counting
        sorted.points.resize(slices.size());
        std::iota(sorted.points.begin(), sorted.points.end(), 0);
        std::ranges::stable_sort(sorted.points, {}, [&](u32 point) { return slices[point]; });
        for (std::size_t i = 0; i < slices.size(); ++i)
            if (i == 0 || slices[sorted.points[i]] != slices[sorted.points[i - 1]]) sorted.begins.push_back(i);
        sorted.begins.push_back(slices.size());
        return sorted;
    }
    sorted.begins.assign(count + 1, 0);
    for (u32 slice : slices) ++sorted.begins[slice + 1];
    std::partial_sum(sorted.begins.begin(), sorted.begins.end(), sorted.begins.begin());
    std::vector<std::size_t> next(sorted.begins.begin(), sorted.begins.end() - 1);
    sorted.points.resize(slices.size());
    for (u32 point = 0; point < slices.size(); ++point) sorted.points[next[slices[point]]++] = point;
    return sorted;
}

/// Orders each slice so that every point is near an earlier point. Uses a heap of points by their distance to the
/// inserted points.
class NearestFirst {
public:
    NearestFirst(const growing::DistinctPoints& points, const growing::Neighbourhoods& neighbourhoods,
                 std::span<const u32> slices)
        : points_(points),
          neighbourhoods_(neighbourhoods),
          slices_(slices),
          least_(points.size(), std::numeric_limits<double>::infinity()),
          inserted_(points.size(), false) {}

    void order(std::span<u32> slice) {
        heap_.clear();
        for (u32 point : slice)
            if (std::isfinite(least_[point])) heap_.push_back({least_[point], point});
        std::ranges::make_heap(heap_, later);
        members_.assign(slice.begin(), slice.end());
        std::size_t placed = 0;
        const auto place = [&](u32 point) {
            slice[placed++] = point;
            insert(point);
        };
        for (u32 start : members_) {
            if (!heap_.empty()) drain(place);
            if (!inserted_[start]) {
                place(start);
                drain(place);
            }
        }
    }

private:
    struct Entry {
        double squared;
        u32 point;
    };
    static bool later(const Entry& a, const Entry& b) {
        return a.squared != b.squared ? a.squared > b.squared : a.point > b.point;
    }

    template <class Place>
    void drain(Place&& place) {
        while (!heap_.empty()) {
            std::ranges::pop_heap(heap_, later);
            const u32 point = heap_.back().point;
            heap_.pop_back();
            if (!inserted_[point]) place(point);
        }
    }

    void insert(u32 point) {
        inserted_[point] = true;
        for (u32 other : neighbourhoods_.of(point)) {
            if (inserted_[other]) continue;
            const double squared = (points_.positions[other] - points_.positions[point]).squaredNorm();
            if (!(squared < least_[other])) continue;
            least_[other] = squared;
            if (slices_[other] != slices_[point]) continue;
            heap_.push_back({squared, other});
            std::ranges::push_heap(heap_, later);
        }
    }

    const growing::DistinctPoints& points_;
    const growing::Neighbourhoods& neighbourhoods_;
    std::span<const u32> slices_;
    /// Squared distance to the nearest inserted point that has this point among its nearest points.
    std::vector<double> least_;
    std::vector<bool> inserted_;
    std::vector<Entry> heap_;
    std::vector<u32> members_;
};

}  // namespace

Array<u32> slices_of(std::span<const double> coordinates, double first, double slice) {
    Array<u32> slices(coordinates.size());
    for (std::size_t i = 0; i < slices.size(); ++i)
        slices[i] = static_cast<u32>(std::floor((coordinates[i] - first) / slice + 0.5));
    return slices;
}

Array<u32> insertion_order(const growing::DistinctPoints& points, const growing::Neighbourhoods& neighbourhoods,
                           int axis, double slice, InPlane in_plane, Execution& execution) {
    std::vector<double> along(points.size());
    for (std::size_t i = 0; i < along.size(); ++i) along[i] = points.positions[i][axis];
    const double first = *std::ranges::min_element(along);
    const Array<u32> slices = slices_of(along, first, slice);
    Slices sorted = sort_by_slice(slices);
    const std::array<int, 2> others{axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
    NearestFirst nearest(points, neighbourhoods, slices);
    for (std::size_t i = 0; i + 1 < sorted.begins.size(); ++i) {
        execution.check_cancelled();
        const std::span members(sorted.points.data() + sorted.begins[i], sorted.begins[i + 1] - sorted.begins[i]);
        if (in_plane == InPlane::nearest)
            nearest.order(members);
        else
            std::ranges::sort(members, {}, [&](u32 point) {
                const Vec3& p = points.positions[point];
                return std::tuple(std::abs(along[point] - first - slices[point] * slice), p[others[0]], p[others[1]]);
            });
    }
    return std::move(sorted.points);
}

}  // namespace scanmill::clustering
