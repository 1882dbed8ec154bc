// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Computes how much the bending of a boundary changes if a cell is removed. Decides which removals are worth taking.
///
/// The bending of an edge is the angle between the normals of its two triangles: 0 if they are coplanar.

#include <bit>
#include <optional>
#include <utility>

#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"
#include "sculpt/carved_solid.hpp"
#include "sculpt/sculpt.hpp"

namespace scanmill::sculpting {

/// Whether the sorted corners of cell `a` are lower than those of `b`. This total order does not depend on indices.
bool is_lower_cell(const TetMesh& tets, u32 a, u32 b);

/// The sum of the bending of all edges, in radians. Pre: the links of a closed 2-manifold, which are sorted here. Bytes
/// do not depend on the number of threads.
double total_bending(BoundaryLinks& links, std::span<const Vec3> positions, unsigned threads);

/// Gains of removals. All numbers are computed from corners sorted by position: bytes do not depend on indices.
class Gains {
public:
    Gains(const CarvedSolid& solid, SculptWeight weight) : solid_(solid), tets_(solid.tets()), weight_(weight) {}

    /// The gain: the bending at the cell's edges before its removal minus that after it. Pre: the cell exposes or
    /// flips, and `open` are its open facets.
    double of(u32 cell, unsigned open, Without without = {}) const;

    /// Whether the bending of the common edge of a cell's two open facets is above 45°.
    bool is_sharp(u32 cell, unsigned open) const;
    /// The unit of the least gain of a flip: 1, or for SculptWeight::length the length of the common edge.
    double weight_of_flip(u32 cell, unsigned open) const;
    /// Whether removing the cell uncovers a facet with an angle below 0.1°.
    bool uncovers_thin_facet(u32 cell, unsigned open) const;
    /// Whether removing the cell uncovers a facet whose squared circumradius is above `most`.
    bool uncovers_larger_facet(u32 cell, unsigned open, double most) const;
    /// Squared circumradius of the facet.
    double squared_radius(u32 cell, int facet) const;
    double volume(u32 cell) const;

private:
    /// Outward normal of a facet; its length is twice the facet's area.
    Vec3 normal(u32 cell, int facet) const;
    /// Normal of the boundary triangle beyond the edge that the facets `across` and `kept` share. This triangle is not
    /// a facet of the cell.
    Vec3 outer_normal(u32 cell, int across, int kept, Without without) const;

    const CarvedSolid& solid_;
    const TetMesh& tets_;
    SculptWeight weight_;
};

/// Decides which steps are allowed, and computes what each would gain.
class StepCriteria {
public:
    /// Stores the largest circumradius of the present boundary. Flips may not uncover a triangle with a larger one.
    StepCriteria(const CarvedSolid& solid, const SculptParams& params, unsigned threads);

    /// Returns the gain of removing the cell to smooth the boundary. Empty unless the cell flips an edge, gains enough,
    /// uncovers neither a thin nor a too large triangle, and smoothing is allowed there. Pre: `open` are its open
    /// facets.
    std::optional<double> smoothing(u32 cell, unsigned open) const {
        return std::popcount(open) == 2 && may_smooth(cell, open) ? flip(cell, open) : std::nullopt;
    }
    /// Whether removing the cell flips an edge and uncovers neither a thin nor a too large triangle, whatever it gains.
    bool may_flip(u32 cell, unsigned open, Without without) const {
        return solid_.flips(cell, open, without) && !gains_.uncovers_thin_facet(cell, open) &&
               !uncovers_too_large(cell, open);
    }
    /// Whether smoothing is allowed: near an exposing step, and at edges whose bending is above 45°. Pre: two facets
    /// are open.
    bool may_smooth(u32 cell, unsigned open) const { return is_near_exposed(cell) || gains_.is_sharp(cell, open); }
    /// The least gain of a flip.
    double least_gain(u32 cell, unsigned open) const { return min_gain_ * gains_.weight_of_flip(cell, open); }
    /// The gain of an exposing step. With look-ahead, it includes the gain of the best smoothing step that the exposing
    /// step makes possible. Pre: the cell exposes.
    double exposing(u32 cell, unsigned open) const;

    /// Whether removing the cell uncovers a triangle whose circumradius is larger than all were when sculpting began.
    bool uncovers_too_large(u32 cell, unsigned open) const {
        return gains_.uncovers_larger_facet(cell, open, largest_);
    }

    /// Whether the cell is near an exposing step. Smoothing is allowed there, however small the dihedral deviation at
    /// the edge is.
    bool is_near_exposed(u32 cell) const { return is_near_exposed_[cell] == 1; }
    /// Marks the cell. False if it was marked already.
    bool mark_near_exposed(u32 cell) { return std::exchange(is_near_exposed_[cell], u8(1)) == 0; }

    const Gains& gains() const { return gains_; }

private:
    std::optional<double> flip(u32 cell, unsigned open, Without without = {}) const;

    const CarvedSolid& solid_;
    Gains gains_;
    double min_gain_;
    double largest_;
    bool lookahead_;
    Array<u8> is_near_exposed_;
};

}  // namespace scanmill::sculpting
