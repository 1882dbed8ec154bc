// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Closing what is no hole by the filter's own rule, but where no single triangle could continue the surface: at tips,
/// in creases and folds, where the front arrives from several sides and has no plane to decide in.

#include "region_grow/surface.hpp"

namespace scanmill::growing {

/// What closing did.
struct NarrowHoles {
    std::size_t closed = 0;
    /// Triangles taken off again because a loop could only be filled in place of them.
    std::size_t replaced = 0;
};

/// Fills every loop that can be filled with triangles which each lie in a circle of `largest_circle` times the mean
/// search radius of its places. Then no place of the filling is farther than that from a point, so that the loop holds
/// no larger empty circle: it is surface, whatever the number of its edges. Loops of at most `most_edges` edges are
/// filled whatever their size.
///
/// The filling has the least area and no bend above 172 degrees; it passes neither through the surface nor through
/// itself. Where there is none, one triangle at a loop of at most 30 edges may give way, or two of at most 12: the
/// first, from the loop's lowest place on, in place of which there is one. Left open are loops of more than 100 edges
/// and those round which the surface faces away from what would close them, for it ends there: on average by more than
/// 120 degrees, or, when the loop is longer than twice that circle, by more than 78: a thin wall's end, a channel, a
/// scrap.
///
/// Pre: every place has one fan. Cost: linear in the places, and edges³ per loop, edges times as much where triangles
/// have to give way.
NarrowHoles close_narrow_holes(Surface& surface, double largest_circle, std::size_t most_edges);

}  // namespace scanmill::growing
