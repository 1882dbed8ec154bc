// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The triangles that fill a hole best.

#include <vector>

#include "region_grow/intersections.hpp"
#include "region_grow/surface.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

/// What the triangles that fill a hole must keep to.
struct FillLimits {
    /// Each lies in a circle of this radius; infinite: they may be of any size.
    double largest_circle;
    /// Between the normals of triangles that share an edge: at least.
    double bend_cosine;
};

inline constexpr double any_bend = -2;

/// Whether there is a filling that keeps to the limits and repeats no edge, whatever it passes through.
bool can_be_filled(const Surface& surface, const std::vector<u32>& corners, const FillLimits& limits);

/// The triangles of least total area that fill the loop of `corners` (each once, counter-clockwise as the triangles
/// will be); none when no filling was found that keeps to the limits, repeats no edge of the surface, and passes
/// neither through it nor through itself. Of equal fillings the one that joins the first corners. Parts of the loop are
/// filled by themselves first, so a filling can be missed whose parts are not the best of theirs.
///
/// `near` is memory to be used again. Cost: corners³ / 6 triangles at most, of which those that would be cheaper than
/// others are compared with the surface near the loop.
std::vector<Triangle> cheapest_filling(const Surface& surface, NearTriangles& near, const std::vector<u32>& corners,
                                       const FillLimits& limits);

// Closing what growth left open where it should not have: loops of a few edges.

/// The pass of triangles that close a hole.
inline constexpr Pass closing_pass = 4;

/// Fills every loop of at most `most_edges` border edges with the triangles of least total area, unless one would fold
/// back on a joined triangle by more than 150 degrees (so a lone triangle keeps its rim), repeat an edge, or pass
/// through others. Where several fans meet in a vertex a loop goes on to the next one round it. How many loops were
/// filled. Cost: linear in the triangles, most_edges² per border edge, and most_edges³ per loop, which is solved once
/// whether it can be filled or not.
std::size_t close_small_holes(Surface& surface, std::size_t most_edges, const Context& context);

// Closing what is no hole by the filter's own rule, but where no single triangle could continue the surface: at tips,
// in creases and folds, where the front arrives from several sides and has no plane to decide in.

/// What closing did.
struct NarrowHoles {
    std::size_t closed = 0;
    /// Triangles taken off again because a loop could only be filled in place of them.
    std::size_t replaced = 0;
};

struct NarrowLimits {
    /// Of the mean search radius of a loop's places.
    double largest_circle;
    /// Loops of at most so many edges are filled whatever their size.
    std::size_t most_edges;
    /// Between the filling of a longer loop and what it joins, and between any two triangles round it, in radians: at
    /// most. 172 degrees or more: what closes a tip.
    double largest_bend;
};

/// Fills every loop that can be filled with triangles which each lie in a circle of `largest_circle` times the mean
/// search radius of its places. Then no place of the filling is farther than that from a point, so that the loop holds
/// no larger empty circle: it is surface, whatever the number of its edges, unless the surface ends there for its
/// bends.
///
/// The filling has the least area and no bend above 172 degrees; it passes neither through the surface nor through
/// itself. Where there is none, one triangle at a loop of at most 30 edges may give way, or two of at most 12: the
/// first, from the loop's lowest place on, in place of which there is one. Left open are loops of more than 100 edges
/// and those round which the surface faces away from what would close them, for it ends there: on average by more than
/// 120 degrees, or, when the loop is longer than twice that circle, by more than 78: a thin wall's end, a channel, a
/// scrap.
///
/// Pre: every place has one fan. Cost: linear in the places; edges³ per loop, up to 30 times as much where one triangle
/// may have to give way and 156 times where two, and what a filling costs to compare with the places in its reach.
NarrowHoles close_narrow_holes(Surface& surface, const NarrowLimits& limits, const Context& context);

}  // namespace scanmill::growing
