// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a new triangle would intersect the surface, in space.
///
/// Growth tests intersections in the tangent plane. That is fast, and correct where the surface is nearly flat. At tips
/// and folds a test in space is necessary.

#include <algorithm>
#include <span>
#include <vector>

#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

/// The squared radius of the smallest circle that encloses a triangle with squared side lengths a, b, c and the given
/// area. The circle is the circumcircle or the circle over the longest side. No point of the triangle is farther than
/// this radius from a corner.
inline double squared_enclosing_radius(double a, double b, double c, double twice_area) {
    const double longest = std::max({a, b, c});
    if (2 * longest >= a + b + c) return longest / 4;
    return a * b * c / (4 * twice_area * twice_area);
}

/// The surface's triangles in some region, gathered for several intersection tests.
class NearTriangles {
public:
    /// Gathers all triangles that may intersect a triangulation of these corners. Pre: after the first call, triangles
    /// were only appended to the surface's list; triangles may have been removed from its fans and added again.
    void gather_around(const Surface& surface, std::span<const u32> corners);
    /// Gathers triangles that may intersect `triangle`: those at its corners, at the nearest neighbours of its corners,
    /// and at the points `near`.
    void gather_near(const Surface& surface, const Triangle& triangle, std::span<const u32> near = {});
    /// Whether the triangle intersects a gathered triangle other than itself. Pre: it lies in the gathered region.
    bool intersect(const Surface& surface, const Triangle& triangle) const;

private:
    struct Box {
        Vec3 low, high;
        bool overlaps(const Box& other) const {
            return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
        }
    };
    struct Boxed {
        Triangle corners;
        Box box;
    };
    static Box box_of(const Surface& surface, std::span<const u32> corners);
    void clear(const Surface& surface);
    /// Adds the triangles at the point whose boxes overlap the region. Each triangle is added once per gathering.
    void gather_at(const Surface& surface, u32 point, const Box& region);
    bool is_visited(u32 point) const { return visited_[point] == gathering_; }
    /// Adds new triangles of the surface to `large_`. The first call sets the limit: the largest 64 triangles are
    /// large, or one in 1024 if that is more. Cost: linear in all triangles for the first call, then in the new ones.
    void update_large(const Surface& surface);

    std::vector<Boxed> triangles_;
    /// For each point, the number of the last gathering that visited it.
    std::vector<u32> visited_;
    u32 gathering_ = 0;
    /// The few triangles that are much larger than all others; they are tested one by one. No other triangle has a
    /// larger enclosing circle than `others_squared_radius_`, so a search for the others needs this radius only.
    std::vector<Triangle> large_;
    double others_squared_radius_ = 0;
    std::size_t seen_ = 0;
    std::vector<u32> points_;
    NeighbourBuffer buffer_;
};

}  // namespace scanmill::growing
