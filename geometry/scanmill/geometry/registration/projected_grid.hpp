// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The points of a view sorted by square cells across the direction to its scanner. A view has few points behind each
/// other, so the cells hold few points.

#include <algorithm>
#include <cmath>
#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

class ProjectedGrid {
public:
    /// A point across the direction and along it, towards the scanner.
    struct Ray {
        double x, y, height;
        u32 row;
    };

    /// Pre: finite points; `direction` is a unit vector; edge > 0. Cells are enlarged for points that would have very
    /// many empty ones. Cost: O(n).
    ProjectedGrid(std::span<const Vec3> points, const Vec3& direction, double edge);

    Ray ray_of(const Vec3& position) const {
        return {x_axis_.dot(position), y_axis_.dot(position), direction_.dot(position), 0};
    }
    const Vec3& direction() const { return direction_; }
    double edge() const { return edge_; }

    /// Calls action(ray) for all points in the cells that come within `distance` of `at` across the direction, until it
    /// returns true. Returns whether it did. The order depends only on the points.
    template <class Action>
    bool any_within(const Ray& at, double distance, Action&& action) const {
        const double first_column = std::max(0.0, std::floor((at.x - distance - low_x_) / edge_)),
                     last_column = std::min(columns_ - 1, std::floor((at.x + distance - low_x_) / edge_)),
                     first_row = std::max(0.0, std::floor((at.y - distance - low_y_) / edge_)),
                     last_row = std::min(rows_ - 1, std::floor((at.y + distance - low_y_) / edge_));
        if (!(first_column <= last_column && first_row <= last_row)) return false;
        for (double row = first_row; row <= last_row; ++row) {
            const u32 end = begin_[static_cast<std::size_t>(row * columns_ + last_column) + 1];
            for (u32 i = begin_[static_cast<std::size_t>(row * columns_ + first_column)]; i < end; ++i)
                if (action(rays_[i])) return true;
        }
        return false;
    }

    struct Nearest {
        static constexpr u32 none = ~u32(0);
        u32 row = none;  ///< `none` if no point is within the limit
        double distance = 0;
        /// The distance of the second nearest point, or a distance within which there is no second one.
        double second = 0;
    };
    /// The point nearest to `position`, if it is within `limit`. `guess` is any distance; the search is fastest if the
    /// nearest point is a little nearer. Ties: the lower row.
    Nearest nearest(const Vec3& position, double guess, double limit) const;

private:
    Vec3 direction_, x_axis_, y_axis_;
    double edge_, low_x_ = 0, low_y_ = 0;
    double columns_ = 1, rows_ = 1;  ///< whole numbers
    Array<u32> begin_;
    Array<Ray> rays_;  ///< by cell; in a cell by row
};

}  // namespace scanmill
