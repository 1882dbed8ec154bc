// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The boundary of a mesh as loops in which no vertex is repeated, and the triangles around a loop.

#include <span>
#include <unordered_map>
#include <vector>

#include "fill_holes/loop_filling.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The loops that fill_holes() describes. Pre: half_edges::opposites() accepts the mesh, and the mesh outlives this
/// object.
class MeshLoops {
public:
    explicit MeshLoops(const TriangleMesh& mesh);

    std::span<const u32> opposite() const { return opposite_; }
    /// For each loop, its half-edges along the boundary, beginning with its lowest half-edge. Loops ascend by this
    /// half-edge.
    const std::vector<std::vector<u32>>& loops() const { return loops_; }
    /// The half-edges on the boundary, ascending.
    std::span<const u32> half_edges() const { return outgoing_; }
    /// The next and the previous half-edge in the loop of `h`.
    u32 next(u32 h) const { return next_.at(h); }
    u32 before(u32 h) const { return before_.at(h); }
    u32 start(u32 h) const { return half_edges::start(mesh_, h); }

    /// The boundary half-edge that ends at the start of `out`, in the same fan. Calls visit(h) for every half-edge h of
    /// the fan that starts at this vertex, `out` first.
    template <class Visit>
    u32 incoming(u32 out, Visit&& visit) const {
        for (u32 h = out;;) {
            visit(h);
            const u32 in = half_edges::before(h);
            if (opposite_[in] == half_edges::boundary) return in;
            h = opposite_[in];
        }
    }
    /// Calls visit(h) as incoming() does, for all fans at the vertex that follow each other across the gaps of loops.
    template <class Visit>
    void around(u32 out, Visit&& visit) const {
        u32 h = out;
        do h = next(incoming(h, visit));
        while (h != out);
    }

private:
    void link_fans();
    void separate_loops();

    const TriangleMesh& mesh_;
    Array<u32> opposite_;
    std::vector<u32> outgoing_;
    std::unordered_map<u32, u32> next_, before_;
    std::vector<std::vector<u32>> loops_;
};

double length_of(const TriangleMesh& mesh, std::span<const u32> loop);

/// The surroundings of a loop, and for each of their vertices the vertex of the mesh.
struct Cutout {
    LoopSurroundings part;
    std::vector<u32> vertices;

    Cutout(const TriangleMesh& mesh, const MeshLoops& boundary, std::span<const u32> loop);
};

}  // namespace scanmill
