// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A graph of views: relative poses of pairs, tested against each other and combined to one pose per view.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/geometry/registration/rigid_motion.hpp"

namespace scanmill {

struct GraphEdge {
    u32 from, to;  ///< views, from < to
    RigidMotion motion;  ///< from the frame of `from` to the frame of `to`
    double score;
    /// Counts only if a consistent triple confirms it.
    bool is_doubtful = false;
};

/// The centre and the radius of a view, for displacement().
struct ViewExtent {
    Vec3 centre = Vec3::Zero();
    double radius = 0;
};

struct CheckedEdges {
    /// For each edge of the input: whether it is kept.
    std::vector<bool> is_kept;
    /// Numbers in the input, before any edge is dropped.
    std::size_t triples = 0, inconsistent = 0;
    std::size_t dropped = 0;  ///< edges with more inconsistent than consistent triples
    std::size_t unconfirmed = 0;  ///< doubtful edges without a consistent triple
};

/// Composes the motions of each three edges that form a triangle. The triple is consistent if the composition differs
/// by less than `tolerance` from the third edge. While an edge has more inconsistent than consistent triples, the one
/// with the largest number of inconsistent triples is dropped (ties: the lower index). Then doubtful edges without a
/// consistent triple are dropped.
/// Pre: at most one edge per pair. Cost: O(edges × views).
CheckedEdges checked_by_triples(std::span<const GraphEdge> edges, std::span<const ViewExtent> views, double tolerance);

struct SpanningTree {
    /// By view: from its frame to the frame of the lowest view of the tree; absent outside the tree.
    std::vector<std::optional<RigidMotion>> poses;
    std::vector<std::size_t> edges;  ///< indices of the edges in the tree, the largest score first
};

/// The largest connected component of a maximum spanning forest by score.
/// Ties: of equal scores, the edge with the lower views; of components with equally many views, the larger sum of the
/// scores of all its edges, then the one with the lowest view.
SpanningTree largest_tree(std::span<const GraphEdge> edges, std::size_t views);

}  // namespace scanmill
