// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Searches for alpha in the order in which cells enter the solid as alpha grows.

#include <optional>
#include <string>

#include "alpha_solid/alpha_solid.hpp"
#include "alpha_solid/components.hpp"
#include "alpha_solid/widest_path_sweep.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill::alpha {

/// The scan searches for a valid alpha-solid up to this multiple of alpha_cover. If there is none, it repairs one.
inline constexpr double max_scan = 4;

struct Selection {
    /// The alpha-solid is every cell except the first `outside` cells of the sweep. `labels` may differ from it,
    /// because cells were left out or added.
    std::size_t outside = 0;
    AlphaChoice choice = AlphaChoice::scan;
    Array<u8> labels;
    Array<Triangle> triangles;
    BoundaryDefects defects;
    /// Number of sets of boundary triangles that share no vertex.
    std::size_t components = 0;
};

/// A range of squared radii that give the same alpha-solid: `from` is included, `to` is not. `to` is infinite for the
/// whole tetrahedralisation.
struct AlphaRange {
    double from = 0, to = 0;
};

/// Writes a radius of the interval near `alpha` with as few digits as possible, at least 4. Pre: `least` is above 0 and
/// not above `largest`; `alpha` is outside the interval.
std::string text_within(const AlphaInterval& interval, double alpha);

class Selector {
public:
    Selector(const TetMesh& tets, const SweepResult& sweep, const AlphaSolidParams& params, Context& context);

    /// The alpha-solid at squared radius `value`; its boundary may have any defect.
    Selection given(double value) const;
    /// The smallest valid alpha-solid, or a repaired one if none is valid up to max_scan times alpha_cover. For
    /// `single` with coverage below 100 %, it is the solid for that share or the solid for all points: the one with the
    /// smaller alpha. The solid for all points may have the smaller alpha, because its components count as one when
    /// they touch. It may be repaired before they are joined across facets.
    Selection scan() const;
    /// A valid alpha-solid by bisection between alpha_cover and the hull.
    Selection bisect() const;

    /// Whether the solid is valid as defined in alpha_solid.hpp.
    bool is_valid(const Selection& selection) const;
    /// The radii nearest to the root of `value` that give a valid alpha-solid; ties: the larger radii. Pre: the
    /// alpha-solid at `value` is not valid. Cost: as scan(), over all radii from alpha_cover to the same distance above
    /// `value`.
    AlphaRange nearest_valid(double value) const;

    /// The solid that is valid if any number of components is allowed; empty if it has one component. Pre: one
    /// component was requested, with all points, and the alpha-solid at alpha_cover is not valid.
    std::optional<Selection> separate() const;

private:
    class Ascent;

    /// A copy of this selector that requests all points in one component.
    Selector for_all_points() const;
    Selection scan_for_share() const;
    Selection solid_without(std::size_t outside) const;
    Selection described(Array<u8> labels, std::size_t outside, AlphaChoice choice) const;
    Selection repaired(const Selection& start) const;

    const TetMesh& tets_;
    const SweepResult& sweep_;
    Context& context_;
    AlphaSearch search_;
    /// alpha_cover², and the number of points that must be covered.
    double cover_;
    std::size_t needed_;
    /// `single` with full coverage: only a solid of one component is valid.
    bool one_component_;
    /// `single` with coverage below 100 %: all components except the largest are left out.
    bool keeps_largest_;
};

}  // namespace scanmill::alpha
