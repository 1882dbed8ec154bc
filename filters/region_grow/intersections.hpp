// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How large a triangle is: no place in it is farther from its nearest corner than the radius told here.

#include <algorithm>
#include <span>
#include <vector>

#include "region_grow/surface.hpp"

namespace scanmill::growing {

/// The squared radius of the smallest circle that holds the triangle of these squared sides and area: the circle
/// through the corners, or the one over the longest side.
inline double squared_circle(double a, double b, double c, double twice_area) {
    const double longest = std::max({a, b, c});
    if (2 * longest >= a + b + c) return longest / 4;
    return a * b * c / (4 * twice_area * twice_area);
}

// The few triangles of a surface that are much larger than the others. With those at hand, a search for all triangles
// near somewhere need reach no farther than the others are large.

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

// Whether a new triangle would pass through what is there, decided in space.
//
// Growth decides in the plane that the surface faces along, which is cheap and right where the surface is near a
// plane. Where it is not, at tips and folds, only space tells.

/// Whether the triangles have a point in common beyond their common corners and edge: a corner of one on the other, and
/// one folded flat onto the other, count. Exact for the coordinates as they are. Triangles without area meet nothing.
bool meet(std::span<const Vec3> positions, const Triangle& one, const Triangle& other);

/// The surface's triangles round somewhere, gathered once.
class NearTriangles {
public:
    /// All that may meet a filling between these corners. Pre: since the first call the surface's list of triangles was
    /// only appended to; its fans may have lost some, and got them back.
    void gather_round(const Surface& surface, std::span<const u32> corners);
    /// Those at the triangle's corners and at the nearest places of each, as far as they may meet the triangle.
    void gather_near(const Surface& surface, const Triangle& triangle);
    /// Whether the triangle meets one of those gathered, another than itself. Pre: it lies within what was asked for.
    bool meet(const Surface& surface, const Triangle& triangle) const;

private:
    struct Box {
        Vec3 low, high;
        bool meets(const Box& other) const {
            return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
        }
    };
    struct Boxed {
        Triangle corners;
        Box box;
    };
    static Box box_of(const Surface& surface, std::span<const u32> corners);
    void begin(const Surface& surface);
    /// The triangles at the place that reach into the box, each once whatever places are asked.
    void gather_at(const Surface& surface, u32 place, const Box& where);
    bool is_asked(u32 place) const { return asked_[place] == gathering_; }

    std::vector<Boxed> triangles_;
    /// Per place which gathering asked it last.
    std::vector<u32> asked_;
    u32 gathering_ = 0;
    WideTriangles wide_;
    std::vector<u32> places_;
    NeighbourBuffer buffer_;
};

}  // namespace scanmill::growing
