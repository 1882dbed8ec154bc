// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks the gate of a batch against the metrics that its steps, measurements and outputs will have.

#include <span>

#include "scanmill/batch/batch.hpp"

namespace scanmill {

/// Reports every rule for a metric that nothing has or that is only measured where nothing is measured, and every rule
/// whose text does not fit its metric's unit and better direction. Pre: the batch has a gate, and its parts are planned
/// without errors.
void check_gate(const Batch& batch, std::span<const BatchPart> parts, const FilterLibrary& library,
                Diagnostics& diagnostics);

}  // namespace scanmill
