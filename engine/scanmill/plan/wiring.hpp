// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decides which value feeds which port within one variant.
///
/// `in` takes precedence. Without it, a port takes the nearest earlier value of its kind, or the workflow input of that
/// kind; two equally near values are an error that asks for `in`. An optional port that shares its kind with an earlier
/// port is wired by `in` alone.

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// The steps of a variant before the step that is being wired.
struct WiringScope {
    const Plan& plan;
    const FilterLibrary& library;
    const std::vector<std::size_t>& earlier;  ///< indices into plan.steps
    const std::map<std::string, std::size_t>& steps_by_name;
    /// Names of several steps, and of steps that could not be planned; each with its error, empty if already reported.
    const std::map<std::string, std::string>& unusable_names;
    /// An earlier step could not be planned and may be the source of a missing value, which is then not reported.
    bool uncertain;
};

/// The source that `reference` names; nothing after an error.
std::optional<ValueSource> resolve(const Reference& reference, const WiringScope& scope, Diagnostics& diagnostics);

/// All ports of the step, without those that could not be wired, which are reported.
std::vector<PlannedInput> wire(const StepSyntax& step, const FilterSpec& spec, const WiringScope& scope,
                               Diagnostics& diagnostics);

}  // namespace scanmill
