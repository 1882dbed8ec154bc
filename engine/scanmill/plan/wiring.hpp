// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decides which value feeds which port within one variant.
///
/// `in` takes precedence. A port that `in` does not name takes the nearest earlier value of its kind, or else the
/// workflow input of that kind. Two equally near values are an error, whose message asks for `in`. An optional port
/// that shares its kind with an earlier port is wired only by `in`.
///
/// A port of several kinds is wired only by `in`. The port of the value that a filter draws takes the last geometric
/// value: the first output of the nearest earlier step whose first output the port takes, or else the first workflow
/// input that the port takes.

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// The steps of a variant before the step that is being wired.
struct WiringScope {
    const Plan& plan;
    const FilterLibrary& library;
    const std::vector<std::size_t>& earlier;  ///< indices into plan.steps
    const std::map<std::string, std::size_t>& steps_by_name;
    /// Names that cannot be used: of several steps, or of a step that could not be planned. Each has the error to
    /// report; empty if it was reported already.
    const std::map<std::string, std::string>& unusable_names;
    /// An earlier step could not be planned. It may be the source of a missing value, so none is reported as missing.
    bool uncertain;
};

/// The source that `reference` names. Reports a wrong reference and returns nothing.
std::optional<ValueSource> resolve(const Reference& reference, const WiringScope& scope, Diagnostics& diagnostics);

/// Wires the ports of the step. Reports ports that could not be wired and leaves them out.
std::vector<PlannedInput> wire(const StepSyntax& step, const FilterSpec& spec, const WiringScope& scope,
                               Diagnostics& diagnostics);

}  // namespace scanmill
