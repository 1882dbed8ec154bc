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

/// Two flips or more. Each flip except the first is at a facet that an earlier flip uncovers.
class Chain {
public:
    /// The cells in the order of removal; empty if no chain exists.
    std::span<const u32> cells() const { return {cells_.data(), length_}; }
    /// Sum of the gains of all flips.
    double gain() const { return gain_; }

private:
    friend class Chains;
    std::array<u32, longest_chain> cells_;
    /// Per cell: the facets that are open when it is removed.
    std::array<unsigned, longest_chain> open_;
    std::size_t length_ = 0;
    /// Number of flips that have been checked; `gain_` and `least_` are sums over these.
    std::size_t evaluated_ = 0;
    double gain_ = 0;
    /// Sum of the least gains that the flips require.
    double least_ = 0;
    /// Whether smoothing is allowed at one of the cells.
    bool may_smooth_ = false;
};

/// Finds chains that are worth taking. All flips of such a chain are allowed, and smoothing is allowed at one of its
/// cells at least (see StepCriteria). Together its flips gain more than as many smoothing steps must.
class Chains {
public:
    Chains(const CarvedSolid& solid, const StepCriteria& criteria)
        : solid_(solid),
          criteria_(criteria),
          waiting_(solid.tets()) {}

    /// Returns the best chain that begins with the cell; ties: the one with the lower cells. Empty unless the cell has
    /// two open facets. Pre: `open` are its open facets.
    Chain best_from(u32 cell, unsigned open) const;

    void append(const std::vector<WaitingStep>& first_cells) { waiting_.append(first_cells); }
    /// Call this if a gain at the cell has changed, or if smoothing is now allowed there.
    void recheck(u32 cell) { changed_.push_back(cell); }
    /// Returns the best of all chains; empty if there is none.
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
