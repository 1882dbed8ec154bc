// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes whole lines of the creases of a scan. Where the scan shows an edge blunt, the mesh has a narrow bevel there:
/// two creases with many short ones between them, and short branches.

#include "scanmill/data/features.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::probing {

struct WholeLines {
    /// The features with whole creases. A joined crease has the place and the direction of its first part.
    FeatureGraph features;
    /// By line: its row before, or that of its first part.
    Array<u32> rows;
    std::size_t left_out = 0;  ///< creases
};

/// Leaves out creases that lie beside a line that stays, or branch off it, and joins the others where only two ends
/// meet:
/// 1. Cells. A crease and the shortest way round from one of its ends to the other are a cell on two conditions.
///    They are nearer to each other than 2 `error` everywhere, and the way is longer by less than 4 `error`. Such cells
///    lie between the two sides of a bevel. A crease from a vertex to itself is a cell if it is shorter than 4 `error`.
///    A cell opens at a crease that is in no other cell. A crease on a side of the bevel, in one cell from the start,
///    goes before one across it. Then a crease beside one that was left out goes first, so that the other side stays
///    whole; then the longest (ties: the higher row).
/// 2. Branches. Creases shorter than 2 `error` with a free end go, the shortest first (ties: the higher row).
/// Both repeat until nothing changes. Boundaries and closed creases stay as they are, and so do all lines if nothing is
/// left out.
///
/// Pre:  the arrays of the features fit together; the vertices of creases are finite.
/// Cost: O(n log n) in the creases and those that the ways round pass, and linear in their vertices, for each round.
WholeLines whole_lines(const FeatureGraph& features, double error, const Context& context);

}  // namespace scanmill::probing
