// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plans the order of the touches, and the moves between them.

#include "probe_planner/machine.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::probing {

/// Touches of one line, in the order along the line. `rows` are rows of the plan.
struct TouchLine {
    bool closed;
    std::vector<u32> rows;
};

/// Returns the rows of the touches in the order in which they are made: a tour over the lines from `home`. The tour
/// enters an open line at one of its ends, and a closed line at any touch and in either direction.
///
/// The tour begins greedily: the line with the nearest end is always next. Then rounds of changes shorten the tour. One
/// change reverses a part of the tour. The other begins a closed line at the touch nearest to where the probe comes
/// from. The rounds end if no change saves more than 1e-9 of `diagonal`, at the latest after ten. A link costs the
/// straight distance between the starts of its touches. Ties: the lower line, then the lower touch. Throws Cancelled.
/// Cost: O(lines² + lines · touches).
std::vector<u32> tour_over(const std::vector<TouchLine>& lines, const std::vector<ProbeTouch>& touches,
                           const Vec3& home, double diagonal, const Context& context);

/// Sets the order of the plan's touches and its moves; returns the length of all moves. A move between two starts is
/// straight if that is free. Otherwise it goes up to the clearance plane, across and down. Pre: is_lift_free() for
/// every start.
double add_moves(ProbePlan& plan, const std::vector<u32>& tour, const Machine& machine, const Context& context);

}  // namespace scanmill::probing
