// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One column out of several of one name.

#include <span>

#include "scanmill/data/columns.hpp"

namespace scanmill::merging {

/// The rows of all parts, end to end. Pre: at least one part; all are lists of one type, or all have the same number of
/// components. Of different types float64 results; 64-bit integers beyond 2^53 then round.
Column joined(std::span<const Column> parts);

}  // namespace scanmill::merging
