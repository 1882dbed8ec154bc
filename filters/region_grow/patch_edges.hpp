// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Border edges that are no end of the points but a sharp edge: beyond them the surface goes on in another patch.

#include "region_grow/suitable_point.hpp"

namespace scanmill::growing {

/// Border edges at which points of the surface could have made a triangle but for the angle to the triangle there, with
/// none on the free side that bends less: where nothing but the rule of the largest angle between facets ended the
/// patch. In the order of the triangles. Cost: linear in the border.
std::vector<Edge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits);

}  // namespace scanmill::growing
