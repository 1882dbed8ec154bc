// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The growth itself: triangles are added at the front's edges until none can be.
///
/// Edges wait in lines: those that are plain to continue go first, then those where the surface bends or points were
/// turned down, then those whose neighbour lists were too short. What cannot be continued is parked and retried under
/// relaxed limits. Adding a triangle cancels opposite directed edges; the thesis's loops, split and merged, are what is
/// left of the directed edges.

#include <deque>
#include <optional>

#include "region_grow/suitable_point.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

class Growth {
public:
    /// `limits`: the given ones, then the relaxed ones in order.
    Growth(Surface& surface, Score score, std::vector<Limits> limits, Context& context);

    /// Forms the seed triangle at the place and grows from it to the end; false when there is none.
    bool start(u32 place);

private:
    struct DirectedEdge {
        u32 from, to;
    };
    /// An edge that found no point under limits_[0] … limits_[tried - 1]. Growth elsewhere only takes points away from
    /// it, so the same limits need no second look.
    struct ParkedEdge {
        DirectedEdge edge;
        std::size_t tried;
    };

    bool form_seed(u32 place);
    bool is_covered(u32 place, const Vec3& normal) const;
    void add(const Triangle& triangle, Pass pass);
    void grow(const Limits& limits);
    /// What the edge would take; now and then asks whether to go on at all.
    SuitablePoint look(DirectedEdge edge, const Limits& limits, bool far, bool in_space);
    /// Looks at one edge; adds a triangle when it may be added in this line.
    void continue_at(DirectedEdge edge, std::size_t line, const Limits& limits);
    /// Tries the parked edges, and those parked meanwhile, up to limits_[round].
    void retry(std::size_t round);

    static constexpr std::size_t lines = 3;
    Surface& surface_;
    PointChooser chooser_;
    std::vector<Limits> limits_;
    Context& context_;
    std::array<std::deque<DirectedEdge>, lines> waiting_;
    std::vector<ParkedEdge> parked_;
    std::size_t next_report_ = 0, looks_ = 0;
};

// Where pieces of the surface begin, and which way each begins to face.

/// Grows one piece after the other until no unused place starts one: first from `start`, or else from the flattest
/// place (least roughness, then lowest number), then from the unused ones in that same order. False when `start` starts
/// nothing.
///
/// Before a further piece is begun, the unused places near the surface are turned to face as it does, and those near
/// them likewise: normals are carried over edges as over a mirror (n' is turned like n less twice its part along the
/// way from one to the other), so that they go right round corners. `groups` tells per place which pieces' facing
/// depends on each other in this way.
bool grow_all_pieces(Surface& surface, Growth& growth, std::optional<u32> start, Array<u32>& groups);

}  // namespace scanmill::growing
