// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/judge.hpp"

#include <algorithm>

namespace scanmill::sculpting {

Judge::Judge(const CarvedSolid& solid, const SculptParams& params)
    : solid_(solid),
      gains_(solid, params.weight),
      min_gain_(params.min_gain.in_radians()),
      lookahead_(params.lookahead),
      is_near_(solid.tets().cells.size()) {
    std::ranges::fill(is_near_, u8(0));
}

std::optional<double> Judge::flip(u32 cell, unsigned open, u32 without) const {
    if (!solid_.flips(cell, open, without)) return std::nullopt;
    const double gain = gains_.of(cell, open, without);
    if (!(gain > min_gain_ * gains_.weight_of_flip(cell, open))) return std::nullopt;
    if (gains_.bares_thin_facet(cell, open)) return std::nullopt;
    return gain;
}

double Judge::exposing(u32 cell, unsigned open) const {
    const double alone = gains_.of(cell, open);
    if (!lookahead_) return alone;
    double best = 0;
    for (u32 across : solid_.tets().neighbours[cell])
        if (solid_.has(across)) best = std::max(best, flip(across, solid_.open_facets(across, cell), cell).value_or(0));
    return alone + best;
}

}  // namespace scanmill::sculpting
