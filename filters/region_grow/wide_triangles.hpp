// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The few triangles of a surface that are much larger than the others. With those at hand, a search for all triangles
/// near somewhere need reach no farther than the others are large.

#include <span>
#include <vector>

#include "region_grow/surface.hpp"

namespace scanmill::growing {

class WideTriangles {
public:
    /// Takes in what the surface got since the last call; the first call decides what is large: the largest 64, or one
    /// in 1024. Pre: between calls the list of triangles is only
    /// appended to.
    /// Cost: linear in the triangles once, then in the new ones.
    void update(const Surface& surface);

    /// Of those taken in that the surface still has. Calls action(Triangle).
    template <class Action>
    void each(const Surface& surface, const Action& action) const {
        for (const Triangle& t : wide_)
            if (surface.fans.left_of(t[0], t[1]) == t[2]) action(t);
    }
    /// No other triangle has a larger circle, as squared_circle() tells.
    double squared_circle_of_others() const { return bound_; }

private:
    std::vector<Triangle> wide_;
    double bound_ = 0;
    std::size_t seen_ = 0;
};

}  // namespace scanmill::growing
