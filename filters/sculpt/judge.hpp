// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which steps are worth taking, and what each would gain.

#include <bit>
#include <optional>
#include <utility>

#include "sculpt/bending.hpp"

namespace scanmill::sculpting {

class Judge {
public:
    /// No flip bares a triangle whose circumradius is larger than those of the boundary as it is now.
    Judge(const CarvedSolid& solid, const SculptParams& params, unsigned threads);

    /// The gain of removing the cell to smooth the boundary: nothing unless the cell flips an edge, gains enough, bares
    /// no thin triangle, and is where that is allowed. Pre: `open` are its open facets.
    std::optional<double> smoothing(u32 cell, unsigned open) const {
        return std::popcount(open) == 2 && is_rough(cell, open) ? flip(cell, open) : std::nullopt;
    }
    /// Removing the cell flips an edge, bares no thin triangle and does not dig, whatever it gains.
    bool may_flip(u32 cell, unsigned open, Without without) const {
        return solid_.flips(cell, open, without) && !gains_.bares_thin_facet(cell, open) && !digs(cell, open);
    }
    /// Where smoothing is allowed: near an exposing step, or where the edge bends by more than 45°. Pre: `open` are
    /// two.
    bool is_rough(u32 cell, unsigned open) const { return is_near(cell) || gains_.is_sharp(cell, open); }
    /// What a flip must gain at least.
    double least_gain(u32 cell, unsigned open) const { return min_gain_ * gains_.weight_of_flip(cell, open); }
    /// The gain of an exposing step, with look-ahead together with the best smoothing step that it makes possible. Pre:
    /// the cell exposes.
    double exposing(u32 cell, unsigned open) const;

    /// Removing the cell bares a triangle whose circumradius is larger than all were when sculpting began: it digs
    /// where the points do not tell of a surface.
    bool digs(u32 cell, unsigned open) const { return gains_.bares_larger_facet(cell, open, largest_); }

    /// Smoothing is allowed at cells near an exposing step, whatever the bend.
    bool is_near(u32 cell) const { return is_near_[cell] == 1; }
    /// False when it was near already.
    bool set_near(u32 cell) { return std::exchange(is_near_[cell], u8(1)) == 0; }

    const Gains& gains() const { return gains_; }

private:
    std::optional<double> flip(u32 cell, unsigned open, Without without = {}) const;

    const CarvedSolid& solid_;
    Gains gains_;
    double min_gain_;
    double largest_;
    bool lookahead_;
    Array<u8> is_near_;
};

}  // namespace scanmill::sculpting
