// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The values that a step's parameters get: what is written there, what a name there stands for, or the default.

#include <string>

#include "scanmill/engine/diagnostics.hpp"
#include "scanmill/engine/expand.hpp"
#include "scanmill/filter/spec.hpp"

namespace scanmill {

/// Where values come from, and who is told what is wrong with them.
struct ParameterSources {
    std::string workflow;
    const Settings& settings;
    Diagnostics& diagnostics;
    /// Of the batch that has the settings; nullptr when they are the command line's.
    Diagnostics* settings_diagnostics;
};

/// In the order of the declaration; relative paths count from the folder of the file that they are written in. What
/// is wrong is told, and the default taken instead.
ParameterSet step_parameters(const ExpandedStep& step, const FilterSpec& spec, const ParameterSources& sources);

}  // namespace scanmill
