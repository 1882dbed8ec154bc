// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The list of steps: filters with their parameters, wiring and expectations, and forks of them.

#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

/// The steps in `list`; what is wrong is reported. A step that cannot be read stands as one without a filter, so that
/// whoever goes on knows that something is missing there.
std::vector<StepItem> parse_steps(const YamlNode& list, Diagnostics& diagnostics);

}  // namespace scanmill
