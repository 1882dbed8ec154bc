// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The growth: triangles are added at boundary edges until no edge can be continued.
///
/// Edges wait in three queues. The first holds certain edges. The second holds edges where the surface has a large
/// dihedral deviation or candidates were rejected. The third holds edges whose neighbour lists were too short. Edges
/// without a suitable point are parked and retried under relaxed limits. A triangle cancels opposite half-edges. The
/// half-edges that remain are the loops of the thesis, split and merged.

#include <array>
#include <deque>
#include <optional>

#include "region_grow/suitable_point.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

class Growth {
public:
    /// `limits`: the given limits, then the relaxed ones in order.
    Growth(Surface& surface, Score score, std::vector<Limits> limits, Context& context);

    /// Forms the seed triangle at the point and grows from it to the end. False if there is no seed triangle.
    bool start(u32 point);

private:
    struct HalfEdge {
        u32 from, to;
    };
    /// An edge without a suitable point under limits_[0] … limits_[tried - 1]. Growth elsewhere only removes
    /// candidates, so these limits need not be tried again.
    struct ParkedEdge {
        HalfEdge edge;
        std::size_t tried;
    };

    bool form_seed(u32 point);
    /// Whether the point lies over a triangle of the surface that faces along the normal.
    bool is_covered(u32 point, const Vec3& normal) const;
    void add(const Triangle& triangle, Pass pass);
    /// Continues edges until the queues are empty.
    void grow(const Limits& limits);
    /// The edge's suitable point. Checks for cancellation now and then.
    SuitablePoint choose(HalfEdge edge, const Limits& limits, bool wide, bool in_space);
    /// Continues one edge: adds a triangle, moves the edge to a later queue, or parks it.
    void extend(HalfEdge edge, std::size_t queue, const Limits& limits);
    /// Retries the parked edges, also those parked meanwhile, with limits up to limits_[round].
    void retry(std::size_t round);

    static constexpr std::size_t queue_count = 3;
    Surface& surface_;
    PointChooser chooser_;
    std::vector<Limits> limits_;
    Context& context_;
    std::array<std::deque<HalfEdge>, queue_count> queues_;
    std::vector<ParkedEdge> parked_;
    std::size_t next_report_ = 0, choices_ = 0;
};

/// Grows component after component until no unused point starts one. The first component starts at `start`, or by
/// default at the point with the least surface variation (ties: the lowest number). Further components start at the
/// unused points in that order. False if nothing can start at `start`.
///
/// Before each further component, the orientation of the surface is propagated to unused points near it, and from these
/// to unused points near them. Along an edge, a normal is propagated by reflection: n' gets the sign of n minus twice
/// its component along the edge. This is right around corners, too. `groups` returns a number per point. It is equal
/// for points whose orientations depend on each other in this way, or invalid_index.
bool grow_all_components(Surface& surface, Growth& growth, std::optional<u32> start, Array<u32>& groups);

}  // namespace scanmill::growing
