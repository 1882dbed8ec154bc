// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A surface of a few triangles made by hand. Points are named by their index in the list of positions.

#include <algorithm>

#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

class Patch {
public:
    explicit Patch(const std::vector<Vec3>& positions)
        : points_(distinct_points_of(positions)),
          neighbourhoods_(points_, 1),
          surface_(points_, neighbourhoods_, principal_normals(points_, neighbourhoods_, 1),
                   Array<double>(points_.size()), Array<double>(points_.size(), 1), false) {
        for (const Vec3& p : positions) point_of_name_.push_back(point_at(p));
        for (u32 name = 0; name < positions.size(); ++name) set_search_radius(name, 4);
    }
    void add(u32 a, u32 b, u32 c) { surface_.add({point_of_name_[a], point_of_name_[b], point_of_name_[c]}, 0); }
    void set_search_radius(u32 name, double radius) { surface_.search_radius[point_of_name_[name]] = radius; }
    Surface& surface() { return surface_; }
    const Surface& surface() const { return surface_; }
    u32 point(u32 name) const { return point_of_name_[name]; }
    u32 name_of(u32 point) const {
        return static_cast<u32>(std::ranges::find(point_of_name_, point) - point_of_name_.begin());
    }

private:
    u32 point_at(const Vec3& p) const {
        return static_cast<u32>(std::ranges::find(points_.positions, p) - points_.positions.begin());
    }

    DistinctPoints points_;
    Neighbourhoods neighbourhoods_;
    Surface surface_;
    std::vector<u32> point_of_name_;
};

}  // namespace scanmill::growing
