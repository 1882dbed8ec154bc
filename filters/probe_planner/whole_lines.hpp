// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes whole lines of the creases of a scan. Where the scan shows an edge blunt, the mesh has a narrow bevel there:
/// two creases with many short ones between them, and short branches.

#include "scanmill/data/features.hpp"

namespace scanmill::probing {

struct WholeLines {
    /// The features with whole creases. A joined crease has the place and the direction of its first part.
    FeatureGraph features;
    /// By line: its row before, or that of its first part.
    Array<u32> rows;
    std::size_t left_out = 0;  ///< creases
};

/// Leaves out creases that lie within `error` of a line that stays, and joins the others where only two ends meet:
/// 1. Cells. A crease and the shortest way round from one of its ends to the other are a cell if they are nearer to
/// each
///    other than 2 `error` everywhere, and the way is longer by less than 4 `error`: they are the sides of a bevel and
///    what joins them. A cell opens at a crease that is in no other cell: first at one beside a crease that was left
///    out, so that one side of a bevel stays whole; among these at the longest (ties: the higher row).
/// 2. Branches. Creases shorter than 2 `error` with a free end go, the shortest first (ties: the higher row).
/// Both repeat until nothing changes. Boundaries and closed creases stay as they are, and so do all lines if nothing is
/// left out.
///
/// Pre: the arrays of the features fit together. Cost: O(n log n) in the creases and those that the ways round pass;
/// sides of k vertices are compared in O(k²).
WholeLines whole_lines(const FeatureGraph& features, double error);

}  // namespace scanmill::probing
