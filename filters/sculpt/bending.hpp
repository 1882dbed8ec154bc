// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How much a boundary bends at its edges, and by how much less when a cell is removed.

#include "scanmill/geometry/tets/solid_boundary.hpp"
#include "sculpt/carved_solid.hpp"
#include "sculpt/sculpt.hpp"

namespace scanmill::sculpting {

/// By x, then y, then z.
inline bool is_lower(const Vec3& a, const Vec3& b) {
    if (a.x() != b.x()) return a.x() < b.x();
    if (a.y() != b.y()) return a.y() < b.y();
    return a.z() < b.z();
}

/// The sum of the bends over all edges, in radians. Pre: the links of a closed 2-manifold; sorts them. The same bits
/// for any number of threads.
double total_bending(BoundaryLinks& links, std::span<const Vec3> positions, unsigned threads);

/// Gains of removals. All numbers are computed from corners sorted by place: the same bits whatever their indices.
class Gains {
public:
    Gains(const CarvedSolid& solid, SculptWeight weight);

    /// The bending at the edges of the cell before its removal less that after it. Pre: the cell exposes or flips, and
    /// `open` are its open facets.
    double of(u32 cell, unsigned open, Without without = {}) const;

    /// The bend at the common edge of a cell's two open facets is above 45°.
    bool is_sharp(u32 cell, unsigned open) const;
    /// What a gain is measured by: 1, or for SculptWeight::length the length of the common edge.
    double weight_of_flip(u32 cell, unsigned open) const;
    /// Removing the cell bares a facet with an angle below 0.1°.
    bool bares_thin_facet(u32 cell, unsigned open) const;
    /// Removing the cell bares a facet whose squared circumradius is above `most`, a result of squared_radius().
    bool bares_larger_facet(u32 cell, unsigned open, double most) const;
    /// Squared circumradius of the facet, in the scan's unit over a power of two.
    double squared_radius(u32 cell, int facet) const;
    double volume(u32 cell) const;

private:
    Vec3 place(u32 vertex) const { return scale_ * tets_.positions[vertex]; }
    /// Outward, as long as twice the area.
    Vec3 normal(u32 cell, int facet) const;
    /// That of the boundary triangle beyond the edge that is not the cell's own.
    Vec3 outer_normal(u32 cell, int across, int kept, Without without) const;

    const CarvedSolid& solid_;
    const TetMesh& tets_;
    SculptWeight weight_;
    /// A power of two that brings the scan to about size 1, so that no product overflows.
    double scale_;
};

/// The cell whose sorted corners are lower; a total order that does not depend on indices.
bool is_lower_cell(const TetMesh& tets, u32 a, u32 b);

}  // namespace scanmill::sculpting
