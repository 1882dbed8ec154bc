// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The order in which the touches are made, and the moves between them.

#include "probe_planner/machine.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::probing {

/// Touches of one line, in its order: rows of the plan.
struct TouchLine {
    bool closed;
    std::vector<u32> rows;
};

/// Rows of touches in the order in which they are made: a tour over the lines from `home`. An open line is entered at
/// one of its ends, a closed one at any touch, and either way.
///
/// It begins greedily with the nearest end of a line each time, and is shortened by reversing parts of the tour and by
/// beginning closed lines at the touch nearest to where the probe comes from, until no such change saves more than 1e-9
/// of `diagonal`, at most ten rounds. A link costs the straight distance of the starts. Ties: the lower line, then the
/// lower touch. Throws Cancelled. Cost: O(lines² + lines · touches).
std::vector<u32> tour_over(const std::vector<TouchLine>& lines, const std::vector<ProbeTouch>& touches,
                           const Vec3& home, double diagonal, const Context& context);

/// Sets order, moves and path of the plan; returns the length of all moves. A move between two starts is straight if it
/// is free, else it goes up to the clearance plane, across and down. Pre: is_lift_free() for every start.
double add_moves(ProbePlan& plan, const std::vector<u32>& tour, const Machine& machine, const Context& context);

}  // namespace scanmill::probing
