// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two sides of fixed edges, and the points that lie on them.
///
/// Near a fixed edge the surface consists of two half-planes that begin at the edge. They are estimated from the points
/// beside it: of all pairs of half-planes from the edge through a point, the pair that has most points near it. So they
/// need no normals, which mix the two sides at narrow edges.
///
/// An edge of a surface between two points on different sides of a fixed edge would cross the fixed edge or leave the
/// surface. The rule holds for any angle between the sides. It needs lines that are where the surface bends: beside
/// lines farther than a third of the spacing from it, points may be on the wrong side.

#include <span>
#include <vector>

#include "scanmill/geometry/growing/distinct_points.hpp"
#include "scanmill/geometry/growing/fixed_edges.hpp"

namespace scanmill::growing {

class EdgeSides {
public:
    /// No edges.
    EdgeSides() = default;
    /// `edges`: pairs of different points. `spacings`: for each edge, the local distance of the points beside it. Ends
    /// of fixed edges have no side.
    ///
    /// A point is *beside* an edge if it is at most 3 spacings from the edge's line and its foot is on the edge. Where
    /// the line continues beyond an end with a turn of less than 35 degrees, the foot may be up to a spacing beyond it.
    /// It lies on the nearer half-plane if it is within a third of the spacing of it. Edges with fewer than two points
    /// on a side, or with less than 15 degrees between the sides, give no sides.
    ///
    /// Ties: the earlier point along the points' order. Cost: a search per edge, and k³ for its k points, at most 48.
    EdgeSides(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, const FixedEdges& fixed,
              std::span<const std::array<u32, 2>> edges, std::span<const double> spacings);

    /// Whether the points are on different sides of a fixed edge. At least one foot is on the edge itself.
    bool apart(u32 a, u32 b) const;
    /// The unit normal, with arbitrary sign, of the half-plane of the nearest edge within 1.5 spacings; zero if there
    /// is none.
    Vec3 normal(u32 point) const { return normals_.empty() ? Vec3::Zero() : normals_[point]; }
    bool empty() const { return begin_.empty(); }

private:
    struct Label {
        u32 edge;
        bool second;  ///< on which of the two sides
        bool inside;  ///< whether the foot is on the edge, not on its continuation
    };
    std::span<const Label> of(u32 point) const {
        return std::span(labels_).subspan(begin_[point], begin_[point + 1] - begin_[point]);
    }

    /// Labels by point, then by edge.
    std::vector<u32> begin_;
    std::vector<Label> labels_;
    Array<Vec3> normals_;
};

}  // namespace scanmill::growing
