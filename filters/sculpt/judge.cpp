// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/judge.hpp"

#include <algorithm>

#include "scanmill/base/parallel.hpp"

namespace scanmill::sculpting {

namespace {

/// Of all triangles of the boundary.
double largest_squared_radius(const CarvedSolid& solid, const Gains& gains, unsigned threads) {
    constexpr std::size_t chunk = 1 << 14;
    const std::size_t cells = solid.tets().cells.size();
    Array<double> largest((cells + chunk - 1) / chunk);
    for_each_chunk(threads, cells, chunk, [&](std::size_t begin, std::size_t end) {
        double most = 0;
        for (u32 cell = static_cast<u32>(begin); cell < end; ++cell) {
            if (!solid.has(cell)) continue;
            const unsigned open = solid.open_facets(cell);
            for (int facet = 0; facet < 4; ++facet)
                if ((open >> facet & 1u) != 0) most = std::max(most, gains.squared_radius(cell, facet));
        }
        largest[begin / chunk] = most;
    });
    return *std::ranges::max_element(largest);
}

}  // namespace

Judge::Judge(const CarvedSolid& solid, const SculptParams& params, unsigned threads)
    : solid_(solid),
      gains_(solid, params.weight),
      min_gain_(params.min_gain.in_radians()),
      largest_(largest_squared_radius(solid, gains_, threads)),
      lookahead_(params.lookahead),
      is_near_(solid.tets().cells.size()) {
    std::ranges::fill(is_near_, u8(0));
}

std::optional<double> Judge::flip(u32 cell, unsigned open, Without without) const {
    if (!solid_.flips(cell, open, without)) return std::nullopt;
    const double gain = gains_.of(cell, open, without);
    if (!(gain > least_gain(cell, open))) return std::nullopt;
    if (gains_.bares_thin_facet(cell, open) || digs(cell, open)) return std::nullopt;
    return gain;
}

double Judge::exposing(u32 cell, unsigned open) const {
    const double alone = gains_.of(cell, open);
    if (!lookahead_) return alone;
    const Without gone(&cell, 1);
    double best = 0;
    for (u32 across : solid_.tets().neighbours[cell])
        if (solid_.has(across)) best = std::max(best, flip(across, solid_.open_facets(across, gone), gone).value_or(0));
    return alone + best;
}

}  // namespace scanmill::sculpting
