// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/thinning.hpp"

#include "scanmill/geometry/spatial/cell_grid.hpp"

namespace scanmill {

namespace {

/// Distances that differ by less than this share are equal: scans on a grid have many equal distances, and rounding
/// must not decide between them.
constexpr double equal = 1e-9;

/// The kept points by cells whose edge is the distance.
class Kept {
public:
    Kept(std::span<const Vec3> points, double distance)
        : points_(points),
          grid_(bounding_box(points), distance),
          squared_(distance * distance) {}

    const Array<u32>& rows() const { return rows_; }

    bool has_near(const Vec3& point) const {
        return grid_.any_near(point, [&](u32 cell) {
            for (u32 i = last_[cell]; i != none; i = previous_[i])
                if ((points_[rows_[i]] - point).squaredNorm() < squared_) return true;
            return false;
        });
    }
    void add(u32 row) {
        const u32 cell = grid_.enter(points_[row]);
        if (cell == last_.size()) last_.push_back(none);
        previous_.push_back(last_[cell]);
        last_[cell] = static_cast<u32>(rows_.size());
        rows_.push_back(row);
    }
    /// The index in rows() of the nearest kept point among those in the cells around.
    u32 nearest(const Vec3& point) const {
        u32 best = none;
        double least = std::numeric_limits<double>::infinity();
        grid_.any_near(point, [&](u32 cell) {
            for (u32 i = last_[cell]; i != none; i = previous_[i]) {
                const double squared = (points_[rows_[i]] - point).squaredNorm();
                if (squared < least * (1 - equal) || (squared <= least * (1 + equal) && i < best))
                    least = squared, best = i;
            }
            return false;
        });
        return best;
    }

private:
    static constexpr u32 none = ~u32(0);
    std::span<const Vec3> points_;
    CellGrid grid_;
    double squared_;
    Array<u32> rows_;
    Array<u32> last_;  ///< by cell: the index in rows_ of the point kept last
    Array<u32> previous_;  ///< by index in rows_: the one before in the same cell
};

Kept kept_of(std::span<const Vec3> points, double distance) {
    Kept kept(points, distance);
    for (u32 row = 0; row < points.size(); ++row)
        if (!kept.has_near(points[row])) kept.add(row);
    return kept;
}

}  // namespace

Array<u32> thinned_rows(std::span<const Vec3> points, double distance) {
    if (points.empty()) return {};
    return kept_of(points, distance).rows();
}

Array<Vec3> thinned_means(std::span<const Vec3> points, double distance) {
    if (points.empty()) return {};
    const Kept kept = kept_of(points, distance);
    // Differences from the kept point keep their digits, and turn with the points.
    Array<Vec3> sums(kept.rows().size(), Vec3::Zero());
    Array<u32> counts(kept.rows().size(), 0);
    for (const Vec3& point : points) {
        const u32 nearest = kept.nearest(point);
        sums[nearest] += point - points[kept.rows()[nearest]];
        ++counts[nearest];
    }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = points[kept.rows()[i]] + sums[i] / counts[i];
    return sums;
}

}  // namespace scanmill
