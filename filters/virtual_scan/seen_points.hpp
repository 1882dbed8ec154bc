// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Remembers points and tells whether one lies near a new one: which parts earlier views have already seen.

#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill::scan {

class SeenPoints {
public:
    /// `radius` above 0; `origin` near the points.
    SeenPoints(const Vec3& origin, double radius) : origin_(origin), radius_(radius) {}

    /// Whether a remembered point is nearer than the radius.
    bool near(const Vec3& point) const;
    void add(std::span<const Vec3> points);

private:
    using Cell = std::array<std::int64_t, 3>;
    Cell cell_of(const Vec3& point) const;
    std::size_t slot_of(const Cell& cell) const;

    Vec3 origin_;
    double radius_;
    std::vector<Vec3> points_;
    /// The points of cell slot s are first_[s], next_[first_[s]] …; cells may share a slot, distances tell them apart.
    std::vector<u32> first_, next_;
};

}  // namespace scanmill::scan
