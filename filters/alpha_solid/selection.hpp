// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which alpha-solid: the search through the order in which cells enter as alpha grows.

#include <optional>

#include "alpha_solid/alpha_solid.hpp"
#include "alpha_solid/flood.hpp"
#include "alpha_solid/labels.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill::alpha {

/// How far beyond alpha_cover the scan goes on looking for a valid alpha-solid before it settles for a repaired one.
inline constexpr double max_scan = 4;

struct Selection {
    /// The alpha-solid is every cell but the flood's first `outside`; `labels` may differ from it by cells left out or
    /// added.
    std::size_t outside = 0;
    AlphaChoice choice = AlphaChoice::scan;
    Array<u8> labels;
    Array<Triangle> triangles;
    BoundaryDefects defects;
    /// Sets of boundary triangles that share no vertex.
    std::size_t components = 0;
};

/// The alpha-solid is the same for every squared radius from `from` up to, but not at, `to`; infinite for the whole
/// tetrahedralisation.
struct AlphaRange {
    double from = 0, to = 0;
};

class Selector {
public:
    Selector(const TetMesh& tets, const Flood& flood, const AlphaSolidParams& params, Context& context);

    /// The alpha-solid at squared radius `value`, whatever its boundary.
    Selection given(double value) const;
    /// The least valid alpha-solid, or a repaired one when none is valid up to four times alpha_cover. Of `single` with
    /// a share of the points and with all of them, whichever has the smaller alpha: pieces that touch are one sooner
    /// than they are joined across facets, and may be repaired then.
    Selection scan() const;
    /// A valid alpha-solid by bisection between alpha_cover and the hull.
    Selection bisect() const;

    /// As defined by alpha_solid(): does the solid hold enough points, with a manifold boundary and in one piece where
    /// that was asked for?
    bool is_valid(const Selection& selection) const;
    /// Of all valid alpha-solids the one whose radii come nearest to the root of `value`; of two equally near the
    /// larger. Pre: the one at `value` is not valid. Cost: as scan(), over all radii from alpha_cover to that distance
    /// above `value`.
    AlphaRange nearest_valid(double value) const;

    /// The alpha-solid that is valid when any number of pieces is, if that are several. Pre: one piece was asked for,
    /// with all points, and the alpha-solid at alpha_cover is not valid.
    std::optional<Selection> apart() const;

private:
    class Growth;

    /// Asks for all points in one piece.
    Selector for_all_points() const;
    Selection scan_for_share() const;
    Selection solid_without(std::size_t outside) const;
    Selection described(Array<u8> labels, std::size_t outside, AlphaChoice choice) const;
    Selection repaired(const Selection& start) const;

    const TetMesh& tets_;
    const Flood& flood_;
    Context& context_;
    AlphaSearch search_;
    /// alpha_cover² and the number of points that it covers.
    double cover_;
    std::size_t needed_;
    /// `single` with full coverage: only a solid in one piece is valid.
    bool one_piece_;
    /// `single` with less: pieces but the largest are left out.
    bool keeps_largest_;
};

}  // namespace scanmill::alpha
