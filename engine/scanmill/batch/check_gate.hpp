// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks the gate of a batch against the metrics that its steps, measurements and outputs will have.

#include <span>

#include "scanmill/batch/batch.hpp"

namespace scanmill {

/// Reports every rule for a metric that no step, measurement or output of the batch has. Reports every rule whose text
/// does not fit the unit and the better direction of its metric. Pre: the batch has a gate, and its parts are planned
/// without errors.
void check_gate(const Batch& batch, std::span<const BatchPart> parts, const FilterLibrary& library,
                Diagnostics& diagnostics);

}  // namespace scanmill
