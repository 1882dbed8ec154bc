// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a new triangle would pass through what is there, decided in space.
///
/// Growth decides in the plane that the surface faces along, which is cheap and right where the surface is near a
/// plane. Where it is not, at tips and folds, only space tells.

#include <span>
#include <vector>

#include "region_grow/wide_triangles.hpp"

namespace scanmill::growing {

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
