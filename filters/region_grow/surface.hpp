// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The triangles round every vertex, in a cache line each.
///
/// Triangle (v, a, b), counter-clockwise, is stored at v as the pair a → b: an edge of v's link. The directed edge v →
/// x has a triangle on its left when a pair begins with x, x → v when a pair ends with it. So all there is to know of
/// an edge stands at either of its ends.

#include <array>
#include <vector>

#include "region_grow/distinct_points.hpp"
#include "region_grow/normals.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::growing {

inline constexpr u32 nobody = ~u32(0);

class Fans {
public:
    struct Pair {
        u32 first, last;
    };

    explicit Fans(std::size_t vertices) : blocks_(vertices) {
        for (Block& block : blocks_) block = {{}, 0, nobody};
    }

    /// Calls action(Pair) for every triangle at the vertex until it returns true; whether it did.
    template <class Action>
    bool any(u32 vertex, Action&& action) const {
        for (u32 index = vertex; index != nobody; index = blocks_[index].next)
            for (u32 i = 0; i < blocks_[index].count; ++i)
                if (action(blocks_[index].pairs[i])) return true;
        return false;
    }
    bool empty(u32 vertex) const { return blocks_[vertex].count == 0; }

    /// The third corner of the triangle left of from → to; nobody without one.
    u32 left_of(u32 from, u32 to) const {
        u32 third = nobody;
        any(from, [&](const Pair& pair) { return pair.first == to && (third = pair.last, true); });
        return third;
    }
    /// Left of to → from, asked at `from`.
    u32 right_of(u32 from, u32 to) const {
        u32 third = nobody;
        any(from, [&](const Pair& pair) { return pair.last == to && (third = pair.first, true); });
        return third;
    }
    /// Whether the triangles go all the way round, once. Pre: not empty.
    bool closed(u32 vertex) const {
        const u32 begin = blocks_[vertex].pairs[0].first;
        u32 steps = 0, end = begin;
        do {
            end = left_of(vertex, end);
            ++steps;
        } while (end != begin && end != nobody);
        return end == begin && steps == count(vertex);
    }
    u32 count(u32 vertex) const {
        u32 sum = 0;
        for (u32 index = vertex; index != nobody; index = blocks_[index].next) sum += blocks_[index].count;
        return sum;
    }
    void add(const Triangle& triangle) {
        for (std::size_t i = 0; i < 3; ++i) add(triangle[i], {triangle[(i + 1) % 3], triangle[(i + 2) % 3]});
    }
    /// Pre: it was added.
    void remove(const Triangle& triangle) {
        for (std::size_t i = 0; i < 3; ++i) remove(triangle[i], {triangle[(i + 1) % 3], triangle[(i + 2) % 3]});
    }

private:
    static constexpr u32 capacity = 7;
    struct Block {
        std::array<Pair, capacity> pairs;
        u32 count;
        u32 next;
    };

    void add(u32 vertex, Pair pair) {
        u32 index = vertex;
        while (blocks_[index].count == capacity) {
            if (blocks_[index].next == nobody) {
                blocks_.push_back({{}, 0, nobody});
                blocks_[index].next = static_cast<u32>(blocks_.size() - 1);
            }
            index = blocks_[index].next;
        }
        blocks_[index].pairs[blocks_[index].count++] = pair;
    }

    void remove(u32 vertex, Pair pair) {
        u32 last = vertex;
        while (blocks_[last].next != nobody && blocks_[blocks_[last].next].count > 0) last = blocks_[last].next;
        const Pair moved = blocks_[last].pairs[--blocks_[last].count];
        if (moved.first == pair.first) return;
        for (u32 index = vertex;; index = blocks_[index].next)
            for (u32 i = 0; i < blocks_[index].count; ++i)
                if (blocks_[index].pairs[i].first == pair.first) {
                    blocks_[index].pairs[i] = moved;
                    return;
                }
    }

    /// One per vertex, then those that vertices of more triangles go on in.
    Array<Block> blocks_;
};

// The surface while it grows: its triangles, what every place is to it, and which way it faces there.

enum class PlaceState : u8 { unused, front, interior };

/// Which limits a triangle was formed under: 0 the given ones, 1 to 3 relaxed ones, 4 none (it closed a
/// small hole).
using Pass = u8;

/// Of 150 degrees: a triangle that bends back by more lies on its neighbour.
inline constexpr double least_bend_cosine = -0.8660254037844387;

struct Surface {
    Surface(const Samples& from, const Neighbourhoods& near, PointNormals facing, Array<double> search_radius,
            Array<double> usual_radius, bool oriented);

    const Samples& samples;
    const Neighbourhoods& neighbourhoods;
    const Array<Vec3>& positions;
    /// Of places on the surface they point to its upside; of others so when `oriented`.
    Array<Vec3> normals;
    Array<float> roughness;
    /// Per place.
    Array<double> search_radius;
    /// What it would be by the density alone: triangles that are small beside it are as the points lie there.
    Array<double> usual_radius;
    /// Normals came with the cloud: a triangle must agree with their sign.
    bool oriented;
    /// The power of two above the longest side of the box. Exact predicates take the point that lies this far along a
    /// unit normal: a shorter one would lose digits in the sum of point and normal.
    double axis_length;

    Fans fans;
    Array<PlaceState> states;
    Array<Triangle> triangles;
    Array<Pass> passes;

    bool is_used(u32 place) const { return states[place] != PlaceState::unused; }
    /// By given normals: they are of two sides of something.
    bool face_apart(u32 a, u32 b) const { return oriented && normals[a].dot(normals[b]) <= 0; }
    /// Whether from → to bounds the surface: a triangle on its left and none on its right.
    bool is_border(u32 from, u32 to) const {
        return fans.left_of(from, to) != nobody && fans.right_of(from, to) == nobody;
    }
    /// Where the border goes on from the vertex, surface on its left. Pre: it is on the border, with one fan.
    u32 next_on_border(u32 vertex) const;
    /// The unit normal of the triangle left of a → b whose third corner is c.
    Vec3 facet_normal(u32 a, u32 b, u32 c) const;

    /// Adds a → b → c. Pre: none of its three directed edges has a triangle.
    void add(const Triangle& triangle, Pass pass);
    /// Forgets triangles that the fans have no more, one for each. Of equal ones the oldest goes.
    void drop(std::vector<Triangle> taken_off);
};

// Vertices where the border passes more than once: several fans of triangles that meet in nothing but the vertex.

/// Removes triangles until the triangles of every vertex form one fan, open or closed: of several the one of most
/// triangles stays, of equal ones that of the lowest vertex. How many were removed. Cost: linear.
std::size_t remove_pinches(Surface& surface);

}  // namespace scanmill::growing
