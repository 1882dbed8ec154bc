// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The parts that earlier views have already seen: a set of points that answers whether one is near a new point.

#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill::scan {

class SeenPoints {
public:
    /// `radius` above 0; `origin` near the points.
    SeenPoints(const Vec3& origin, double radius) : origin_(origin), radius_(radius) {}

    /// Whether a point of the set is nearer than the radius.
    bool near(const Vec3& point) const;
    void add(std::span<const Vec3> points);

private:
    using Cell = std::array<std::int64_t, 3>;
    Cell cell_of(const Vec3& point) const;
    std::size_t slot_of(const Cell& cell) const;

    Vec3 origin_;
    double radius_;
    std::vector<Vec3> points_;
    /// The points of cell slot s are first_[s], next_[first_[s]] …; cells may share a slot, distances distinguish them.
    std::vector<u32> first_, next_;
};

}  // namespace scanmill::scan
