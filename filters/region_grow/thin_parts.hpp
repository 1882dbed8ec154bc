// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Loops that may be no ends of the surface: they lie where two sides of something are too near each other for points
/// so far apart to tell them from one.

#include "region_grow/components.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

/// Of bins: sheets nearer than this are not told apart for certain, see README.md.
inline constexpr double thin_in_bins = 3;

struct ThinParts {
    /// Loops with a place that has another side nearer than `thin_in_bins` bins.
    std::size_t loops = 0;
    /// The least such distance, and the bin there.
    double least = 0, bin = 0;
};

/// The other side: a place of the surface that faces the other way, by more than 120 degrees, and lies across the
/// surface from here rather than beside; past a sharp fold it may be nearer over the surface. Which way a piece faces
/// beside another is not known, so there facing the same way counts as well. The bin is what the search radius follows
/// from. Of equally near ones the one with the smaller bin is told. Where given normals tell the sides, no loop is
/// counted.
///
/// Pre: every place has one fan; search radii follow from bins. Cost: a search round every place on a border.
ThinParts find_thin_parts(const Surface& surface, const Pieces& pieces, const Context& context);

/// Places on the border beside one on the border whose normal is opposed, in their plane: the surface ends there only
/// because the given normals say so; none where they are on one side. Pre: the normals' signs count. Cost: linear.
std::size_t places_at_seams(const Surface& surface);

}  // namespace scanmill::growing
