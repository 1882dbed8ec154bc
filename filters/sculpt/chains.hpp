// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Chains: flips that gain only together. A web of cells over a crease disappears only if all its cells are removed,
/// and removing the first of them may increase the bending.

#include <array>
#include <vector>

#include "sculpt/criteria.hpp"
#include "sculpt/step_queue.hpp"

namespace scanmill::sculpting {

inline constexpr std::size_t longest_chain = 3;

/// Two flips or more, each but the first at a facet that an earlier one uncovers.
class Chain {
public:
    /// The cells in the order of removal; empty if no chain exists.
    std::span<const u32> cells() const { return {cells_.data(), length_}; }
    /// The sum over all flips.
    double gain() const { return gain_; }

private:
    friend class Chains;
    std::array<u32, longest_chain> cells_;
    /// The facets of each that are open when it is removed.
    std::array<unsigned, longest_chain> open_;
    std::size_t length_ = 0;
    /// How many of the flips have been checked; `gain_` and `least_` are sums over these.
    std::size_t evaluated_ = 0;
    double gain_ = 0;
    /// The least gain required.
    double least_ = 0;
    /// Smoothing is allowed at one of the cells.
    bool may_smooth_ = false;
};

/// The chains that are worth taking: all their flips are allowed, smoothing is allowed at one cell at least (see
/// StepCriteria), and together they gain more than as many smoothing steps must.
class Chains {
public:
    Chains(const CarvedSolid& solid, const StepCriteria& criteria)
        : solid_(solid),
          criteria_(criteria),
          waiting_(solid.tets()) {}

    /// The best chain that begins with the cell; ties: the one with the lower cells. None unless the cell has two
    /// open facets. Pre: `open` are its open facets.
    Chain best_from(u32 cell, unsigned open) const;

    void append(const std::vector<WaitingStep>& first_cells) { waiting_.append(first_cells); }
    /// To be called if a gain at the cell has changed, or smoothing is now allowed there.
    void recheck(u32 cell) { changed_.push_back(cell); }
    /// The best chain of all; empty if there is none.
    Chain next();

private:
    Chain extended(const Chain& chain, u32 cell, unsigned open) const;
    /// Adds the gains of the flips; false if one of them is not allowed.
    bool evaluate(Chain& chain) const;
    bool is_better(const Chain& chain, const Chain& best) const;
    void search_from(const Chain& chain, Chain& best) const;
    /// Finds the first cells of the chains that may contain the changed cell.
    void find_first_cells(u32 changed);
    void recheck_changed();

    const CarvedSolid& solid_;
    const StepCriteria& criteria_;
    StepQueue waiting_;
    std::vector<u32> changed_, first_cells_;
};

}  // namespace scanmill::sculpting
