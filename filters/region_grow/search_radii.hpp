// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How far a triangle may reach, where nobody said it: from how dense the places are round each.

#include "region_grow/neighbourhoods.hpp"

namespace scanmill::growing {

/// Per place 2 √3 B, B being the bin that points thinned to the density there would have had.
///
/// Thinning keeps one point in every cube of edge B, and a surface meets about 1.5 cubes per B², so its 12th neighbour
/// is at about 1.6 B: the distance tells B. At the surface's rim, where half of the neighbours are missing, it would
/// be 1.4 times too large; so it counts at most 1.15 times the median of the neighbours'. Cost: linear.
Array<double> density_radii(const Samples& samples, const Neighbourhoods& neighbourhoods, unsigned threads);

}  // namespace scanmill::growing
