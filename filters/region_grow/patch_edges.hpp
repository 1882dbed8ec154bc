// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Border edges that are no end of the points but a sharp edge: beyond them the surface goes on in another patch.

#include "region_grow/suitable_point.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

struct PatchEdge {
    u32 from, to;
    /// The place of the other patch that the edge would have taken first.
    u32 beyond;
};

/// Border edges for which a place on the front, no neighbour of theirs, keeps to all limits but the one of the angle to
/// the triangle there: where nothing else ended the patch. In the order of the triangles, facing as they were grown.
/// Cost: linear in the border.
std::vector<PatchEdge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits,
                                        const Context& context);

}  // namespace scanmill::growing
