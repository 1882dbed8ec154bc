// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Expands a workflow with forks (`one-of`, `sweep`) to its variants: lists of steps with one value for every
/// parameter.

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
    const WrittenValue* written;  ///< as in the step
    WrittenParameter value;       ///< with every `$name` replaced
    std::vector<ReplacedName> replaced;
};

struct ExpandedStep {
    const StepSyntax* syntax;
    std::vector<ChosenArgument> arguments;  ///< without values that could not be read
    std::vector<std::string> aliases;       ///< ids of the one-of steps whose alternative ends with this step
};

struct Variant {
    /// Its alternatives and swept values joined by `+`, safe in file names: `tight-cocone+max-error=0.1pctdiag`;
    /// `default` when the workflow has no forks.
    std::string name;
    std::vector<ExpandedStep> steps;
};

/// Calls `visit` with every variant in the order of the file, the first fork slowest. Reports undeclared parameters,
/// variants of equal names, and workflows of more than 10,000 variants or 500,000 steps in all variants together.
/// Beyond these limits it visits only as many variants as show every branch of every fork once, so that errors in them
/// are found too. Costs variants × steps, and the memory of one variant.
void expand(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics,
            const std::function<void(const Variant&)>& visit);

}  // namespace scanmill
