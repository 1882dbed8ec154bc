// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a new triangle would intersect the surface, in space.
///
/// Growth decides in the tangent plane, which is cheap, and right where the surface is nearly flat. At tips and folds
/// only a test in space decides.

#include <algorithm>
#include <span>
#include <vector>

#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

/// The squared radius of the smallest circle that encloses a triangle of these squared side lengths and this area: the
/// circumcircle, or the circle over the longest side. No point of the triangle is farther than that from a corner.
inline double squared_enclosing_radius(double a, double b, double c, double twice_area) {
    const double longest = std::max({a, b, c});
    if (2 * longest >= a + b + c) return longest / 4;
    return a * b * c / (4 * twice_area * twice_area);
}

/// The surface's triangles in some region, gathered for several intersection tests.
class NearTriangles {
public:
    /// Gathers all triangles that may intersect a triangulation of these corners. Pre: since the first call the
    /// surface's list of triangles was only appended to; its fans may have lost triangles and got them back.
    void gather_around(const Surface& surface, std::span<const u32> corners);
    /// Gathers triangles at the triangle's corners and their nearest neighbours that may intersect the triangle.
    /// With `near`, also those at these points.
    void gather_near(const Surface& surface, const Triangle& triangle, std::span<const u32> near = {});
    /// Whether the triangle intersects one of the gathered ones other than itself. Pre: it lies in the gathered region.
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
    /// Adds the triangles at the point that reach into the box. Each triangle is added once per gathering.
    void gather_at(const Surface& surface, u32 point, const Box& region);
    bool is_visited(u32 point) const { return visited_[point] == gathering_; }
    /// Adds new triangles of the surface to `large_`. The first call decides what is large: the largest 64, or one in
    /// 1024. Cost: linear in the triangles once, then in the new ones.
    void update_large(const Surface& surface);

    std::vector<Boxed> triangles_;
    /// Per point the number of the last gathering that visited it.
    std::vector<u32> visited_;
    u32 gathering_ = 0;
    /// The few triangles that are much larger than all others. As they are tested one by one, a search for the others
    /// needs a radius of `others_squared_radius_` only: none of the others has a larger enclosing circle.
    std::vector<Triangle> large_;
    double others_squared_radius_ = 0;
    std::size_t seen_ = 0;
    std::vector<u32> points_;
    NeighbourBuffer buffer_;
};

}  // namespace scanmill::growing
