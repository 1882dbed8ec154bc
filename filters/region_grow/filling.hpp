// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The triangles that fill a hole best.

#include <vector>

#include "region_grow/crossings.hpp"

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

}  // namespace scanmill::growing
