// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The search for alpha, through the order in which cells enter the solid as alpha grows.

#include <optional>
#include <string>

#include "alpha_solid/alpha_solid.hpp"
#include "alpha_solid/components.hpp"
#include "alpha_solid/widest_path_sweep.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill::alpha {

/// Up to this multiple of alpha_cover the scan searches for a valid alpha-solid; if there is none, it repairs one.
inline constexpr double max_scan = 4;

struct Selection {
    /// The alpha-solid is every cell but the sweep's first `outside`; `labels` may differ from it by cells left out or
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

/// A radius of the interval near `alpha`, written with as few digits (at least 4) as still give one of it. Pre: least
/// is above 0 and not above largest; alpha is outside of them.
std::string text_within(const AlphaInterval& interval, double alpha);

class Selector {
public:
    Selector(const TetMesh& tets, const SweepResult& sweep, const AlphaSolidParams& params, Context& context);

    /// The alpha-solid at squared radius `value`, whatever its boundary.
    Selection given(double value) const;
    /// The least valid alpha-solid, or a repaired one when none is valid up to max_scan times alpha_cover. For `single`
    /// with a share of the points, the solid for the share or that for all points, whichever has the smaller alpha:
    /// components that touch count as one before they are joined across facets, and may be repaired then.
    Selection scan() const;
    /// A valid alpha-solid by bisection between alpha_cover and the hull.
    Selection bisect() const;

    /// As defined by alpha_solid(): the solid has enough points, a manifold boundary, and is one component where that
    /// was requested.
    bool is_valid(const Selection& selection) const;
    /// The valid alpha-solid whose radii are nearest to the root of `value`; ties: the larger one. Pre: the
    /// one at `value` is not valid. Cost: as scan(), over all radii from alpha_cover to that distance above `value`.
    AlphaRange nearest_valid(double value) const;

    /// The solid that is valid when any number of components is allowed, if it has several. Pre: one component was
    /// requested, with all points, and the alpha-solid at alpha_cover is not valid.
    std::optional<Selection> separate() const;

private:
    class Ascent;

    /// Requests all points in one component.
    Selector for_all_points() const;
    Selection scan_for_share() const;
    Selection solid_without(std::size_t outside) const;
    Selection described(Array<u8> labels, std::size_t outside, AlphaChoice choice) const;
    Selection repaired(const Selection& start) const;

    const TetMesh& tets_;
    const SweepResult& sweep_;
    Context& context_;
    AlphaSearch search_;
    /// alpha_cover² and the number of points that it covers.
    double cover_;
    std::size_t needed_;
    /// `single` with full coverage: only a solid of one component is valid.
    bool one_component_;
    /// `single` with less: components but the largest are left out.
    bool keeps_largest_;
};

}  // namespace scanmill::alpha
