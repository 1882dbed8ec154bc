// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A surface of a few triangles made by hand, its places named by where they stand in a list.

#include <algorithm>

#include "region_grow/surface.hpp"

namespace scanmill::growing {

class Patch {
public:
    explicit Patch(const std::vector<Vec3>& positions)
        : samples_(distinct_samples(positions)),
          neighbourhoods_(samples_, 1),
          surface_(samples_, neighbourhoods_, principal_normals(samples_, neighbourhoods_, 1),
                   Array<double>(samples_.size()), Array<double>(samples_.size(), 1), false) {
        for (const Vec3& p : positions) place_.push_back(place_at(p));
        for (u32 name = 0; name < positions.size(); ++name) set_search_radius(name, 4);
    }
    void add(u32 a, u32 b, u32 c) { surface_.add({place_[a], place_[b], place_[c]}, 0); }
    void set_search_radius(u32 name, double radius) { surface_.search_radius[place_[name]] = radius; }
    Surface& surface() { return surface_; }
    const Surface& surface() const { return surface_; }
    u32 place(u32 name) const { return place_[name]; }
    u32 name_of(u32 place) const { return static_cast<u32>(std::ranges::find(place_, place) - place_.begin()); }

private:
    u32 place_at(const Vec3& p) const {
        return static_cast<u32>(std::ranges::find(samples_.positions, p) - samples_.positions.begin());
    }

    Samples samples_;
    Neighbourhoods neighbourhoods_;
    Surface surface_;
    std::vector<u32> place_;
};

}  // namespace scanmill::growing
