// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Chains: flips that gain only together. A web over a crease goes when all its cells go, and the first of them may
/// cost more bending than it takes away.

#include <array>
#include <vector>

#include "sculpt/judge.hpp"
#include "sculpt/step_queue.hpp"

namespace scanmill::sculpting {

inline constexpr std::size_t longest_chain = 3;

/// Two flips or more, every one but the first at a facet that an earlier one bares.
class Chain {
public:
    /// In the order of removal. There is no chain when there are none.
    std::span<const u32> cells() const { return {cells_.data(), length_}; }
    /// Of all flips together.
    double gain() const { return gain_; }

private:
    friend class Chains;
    std::array<u32, longest_chain> cells_;
    /// The facets of each that are open when it goes.
    std::array<unsigned, longest_chain> open_;
    std::size_t length_ = 0;
    /// How many of the flips are known to be possible and counted in what follows.
    std::size_t counted_ = 0;
    double gain_ = 0;
    /// The least that the flips must gain.
    double least_ = 0;
    /// Flips are allowed at one of the cells.
    bool is_rough_ = false;
};

/// The chains that are worth taking: none makes a thin triangle or digs, at one flip at least smoothing is allowed (see
/// Judge), and together they gain more than as many smoothing steps must.
class Chains {
public:
    Chains(const CarvedSolid& solid, const Judge& judge) : solid_(solid), judge_(judge), waiting_(solid.tets()) {}

    /// The best that begins with the cell; of equal ones that whose cells are lower. None unless they are two. Pre:
    /// `open` are its open facets.
    Chain best_from(u32 cell, unsigned open) const;

    void append(const std::vector<WaitingStep>& first_cells) { waiting_.append(first_cells); }
    /// A gain at the cell is another now, or smoothing is allowed there.
    void look_again_at(u32 cell) { changed_.push_back(cell); }
    /// The best of all; one of no cells when there is none.
    Chain next();

private:
    Chain longer(const Chain& chain, u32 cell, unsigned open) const;
    /// Sums up the flips; false when one of them is not possible.
    bool count(Chain& chain) const;
    bool is_better(const Chain& chain, const Chain& best) const;
    void extend(Chain& best, const Chain& chain) const;
    /// Those of the chains that the cell can be part of.
    void find_first_cells(u32 changed);
    void look_again();

    const CarvedSolid& solid_;
    const Judge& judge_;
    StepQueue waiting_;
    std::vector<u32> changed_, first_cells_;
};

}  // namespace scanmill::sculpting
