// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Expands a workflow to its variants by choosing one branch at every fork. A fork is a `one-of` or a `sweep`. A
/// variant is a list of steps with one value for every parameter.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

/// Values of workflow parameters given by `--set`, or by a batch's `set`.
using Settings = std::map<std::string, ValueExpression>;

/// The names in `settings` that are not parameters of the workflow.
std::vector<std::string> undeclared(const Settings& settings, const Workflow& workflow);

/// A `$name` in a step, and its value. Both point into the workflow or the settings.
struct ReplacedName {
    const NameUse* use;
    const WrittenValue* value;
};

/// A parameter of a step and the value that this variant takes for it.
struct ChosenArgument {
    const NamedExpression* parameter;
    const WrittenValue* written;  ///< the value as written in the step
    WrittenParameter value;       ///< the written value with every `$name` replaced
    std::vector<ReplacedName> replaced;
};

struct ExpandedStep {
    const StepSyntax* syntax;
    std::vector<ChosenArgument> arguments;  ///< omits values that could not be read
    std::vector<std::string> aliases;       ///< ids of the one-of steps whose alternative ends with this step
};

struct Variant {
    /// The chosen alternatives and swept values, joined by `+` and safe in file names:
    /// `tight-cocone+max-error=0.1pctdiag`. A workflow without forks has the variant `default`.
    std::string name;
    std::vector<ExpandedStep> steps;
};

/// Calls `visit` with every variant, in the order of the file; the branch of the first fork changes slowest. Reports
/// undeclared parameters and variants with equal names. Reports workflows of more than 10,000 variants, or of more than
/// 500,000 steps in all variants together. Beyond these limits it visits only enough variants to show every branch of
/// every fork once, so that errors in all branches are found.
///
/// Cost: time proportional to variants × steps, and the memory of one variant.
void expand(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics,
            const std::function<void(const Variant&)>& visit);

}  // namespace scanmill
