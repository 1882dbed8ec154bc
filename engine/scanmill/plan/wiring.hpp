// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which value feeds which port, within one variant.
///
/// `in` decides where it speaks. Elsewhere a port takes the nearest earlier value of its kind, or the workflow input of
/// that kind; where there are two equally near, the choice is the user's. An optional port that shares its kind with a
/// port declared before it is wired by `in` alone.

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// The steps of a variant before the one that is being wired.
struct WiringScope {
    const Plan& plan;
    const FilterLibrary& library;
    const std::vector<std::size_t>& earlier;  ///< indices into plan.steps
    const std::map<std::string, std::size_t>& steps_by_name;
    /// Names that stand for more than one step and so for none, and names of steps that could not be planned.
    const std::map<std::string, std::string>& unusable_names;
    /// An earlier step could not be planned: a missing value may be its, so do not complain of it.
    bool uncertain;
};

/// The source that `reference` names; reports and returns nothing when there is none.
std::optional<ValueSource> resolve(const Reference& reference, const WiringScope& scope, Diagnostics& diagnostics);

/// All ports of the step. Ports that could not be wired are reported and left out.
std::vector<PlannedInput> wire(const StepSyntax& step, const FilterSpec& spec, const WiringScope& scope,
                               Diagnostics& diagnostics);

}  // namespace scanmill
