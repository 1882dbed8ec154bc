// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The header of a DMIS program: the statements before the first touch, which set units, sensor and safety distances.
///
/// A header of the user's may have placeholders, which the writer replaces: {radius}, {diameter}, {unit}, {approach},
/// {retract}, {search}, {clearance}. {unit} is MM, CM, M, INCH or FEET, as UNITS needs it; the others are lengths in
/// that unit. {approach} and {retract} are the distances from the edge to the ball's surface where an approach begins,
/// {search} is how far the ball searches beyond the edge, {clearance} the plan's clearance.

#include <string>
#include <string_view>

#include "scanmill/data/probes.hpp"

namespace scanmill::dmis {

/// Throws Error, in most cases with a line of the header, for an unknown placeholder; a character that is not printable
/// ASCII, except tabs and line ends; a header without UNITS, or with UNITS that differ from `unit`, unless it is
/// unknown; DMISMN, FILNAM or ENDFIL, which the writer adds; a last statement that is not complete. A plan in
/// micrometres is written in millimetres, so its header has UNITS/MM.
void require_header(std::string_view header, LengthUnit unit);

/// The plan's header in lines of at most 80 characters; the default header if the plan has none. `approach` is the
/// distance from the edge to the ball's surface where an approach begins. Lengths have so many decimals.
/// Pre: the plan's unit has a name in DMIS. Throws Error as require_header(), and for a line with a comment that is
/// longer than 80 characters once it is filled in.
std::string header_lines(const ProbePlan& plan, double approach, u32 decimals);

/// The frame's name in ASCII, without `$`, as short as a comment of one line needs it.
std::string comment_name(std::string_view name);

}  // namespace scanmill::dmis
