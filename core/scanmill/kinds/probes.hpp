// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The names of what a probe plan states, in every file format.

#include <string_view>

#include "scanmill/data/probes.hpp"

namespace scanmill {

/// "none", "concave", "too-narrow", "too-tilted" or "obstructed".
std::string_view name_of(ProbeReason reason);
/// "none", "edge", "elsewhere" or "missed".
std::string_view name_of(ProbeContact contact);
/// "clearance", "approach" or "retract".
std::string_view name_of(ProbeMoveType type);

}  // namespace scanmill
